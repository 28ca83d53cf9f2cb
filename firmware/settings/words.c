#include "settings/words.h"

#include <string.h>

unsigned words_count(const char *words)
{
    unsigned n = 1;
    for (; *words; words++)
        n += *words == '|';
    return n;
}

void words_put(const char *words, unsigned place, struct text *t)
{
    for (; *words && place; words++)
        if (*words == '|')
            place--;
    for (; *words && *words != '|'; words++)
        text_char(t, *words);
}

bool words_find(const char *words, const char *word, uint8_t *place)
{
    uint8_t at = 0;
    size_t n = strlen(word);
    while (n) {
        const char *end = strchr(words, '|');
        size_t width = end ? (size_t)(end - words) : strlen(words);
        if (width == n && memcmp(words, word, n) == 0) {
            *place = at;
            return true;
        }
        if (!end)
            return false;
        words = end + 1;
        at++;
    }
    return false;
}
