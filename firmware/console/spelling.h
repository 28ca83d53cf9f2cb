/* Words as people type them: capital letters, other names of commands, and how far a word is from one that is known. */
#ifndef REFLUX_CONSOLE_SPELLING_H
#define REFLUX_CONSOLE_SPELLING_H

#include <stdbool.h>
#include <string.h>

#include "exchange/config.h"

#if CONFIG_PEOPLE

/* Returns whether the words are the same, whatever the case of their letters. */
bool same_letters(const char *a, const char *b);
/* Returns the command that another name stands for: `help` for `?`; the name itself where it is no other name. */
const char *usual_name(const char *name);
/* Returns how far a typed word is from a known one, whatever their case: the letters between the beginning and the end that they have in
 * common, of the word that has more there. Two swapped letters count 1, and so does a beginning of two letters or more. */
unsigned spelling_edits(const char *typed, const char *known);

#else
static inline bool same_letters(const char *a, const char *b)
{
    return strcmp(a, b) == 0;
}
static inline const char *usual_name(const char *name)
{
    return name;
}
#endif

#endif
