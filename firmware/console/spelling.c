#include "console/spelling.h"

static char lower_letter(char x)
{
    return (char)(x >= 'A' && x <= 'Z' ? x - 'A' + 'a' : x);
}

bool same_letters(const char *a, const char *b)
{
    while (*a && lower_letter(*a) == lower_letter(*b)) {
        a++;
        b++;
    }
    return *a == *b;
}

const char *usual_name(const char *name)
{
    static const char *const names[][2] = {{"?", "help"}, {"quit", "exit"}};
    for (unsigned i = 0; i < sizeof names / sizeof names[0]; i++)
        if (same_letters(name, names[i][0]))
            return names[i][1];
    return name;
}

unsigned spelling_edits(const char *typed, const char *known)
{
    size_t m = strlen(typed), n = strlen(known), begin = 0, end = 0;
    while (begin < m && lower_letter(typed[begin]) == lower_letter(known[begin]))
        begin++;
    if (begin == m && m >= 2 && n > m)
        return 1;
    while (end < m - begin && end < n - begin &&
           lower_letter(typed[m - 1u - end]) == lower_letter(known[n - 1u - end]))
        end++;
    m -= begin + end;
    n -= begin + end;
    typed += begin;
    known += begin;
    if (m == 2 && n == 2 && lower_letter(typed[0]) == lower_letter(known[1]) &&
        lower_letter(typed[1]) == lower_letter(known[0]))
        return 1;
    return (unsigned)(m > n ? m : n);
}
