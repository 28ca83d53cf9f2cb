/* Finds the access key in a console line: `unlock KEY`, `key NEW`, `set console.key NEW`. All code that shows or keeps lines calls
 * this first. */
#ifndef REFLUX_BASE_SECRET_H
#define REFLUX_BASE_SECRET_H

#include <stddef.h>

#ifndef SECRET_CAPITALS
#define SECRET_CAPITALS 1 /* commands may have capital letters */
#endif

/* Returns the index of the first character that nobody may read; the length of the line where it holds no key. */
size_t secret_from(const char *line);

#endif
