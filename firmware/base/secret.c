#include "base/secret.h"

#include <string.h>

/* Returns the text after the words; NULL where `at` does not begin with them, in small or capital letters. */
static const char *after(const char *at, const char *words)
{
    if (!SECRET_CAPITALS) {
        size_t n = strlen(words);
        return strncmp(at, words, n) == 0 ? at + n : NULL;
    }
    while (*words) /* the bit of a blank makes a capital letter a small one */
        if (!*at || (*at++ | ' ') != *words++)
            return NULL;
    return at;
}

size_t secret_from(const char *line)
{
    static const char parameter[] = "console.key ";
    const char *begin = line, *from;
    while (*begin == ' ')
        begin++;
    from = after(begin, "unlock ");
    if (!from)
        from = after(begin, "key ");
    if (!from && (begin = strstr(begin, parameter)) != NULL)
        from = begin + sizeof parameter - 1;
    return from ? (size_t)(from - line) : strlen(line);
}
