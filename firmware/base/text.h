/* Text in and out. The code does not use printf and scanf of the C library, because they take eight kilobytes on the
 * target and each library writes numbers its own way. The digits are those of glibc's %g.
 *
 * struct text writes into a caller's buffer, which is always terminated. A text that does not fit is cut, and `cut` is set.
 */
#ifndef REFLUX_BASE_TEXT_H
#define REFLUX_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

struct text {
    char *start;
    size_t n, size; /* n: characters so far, without the terminating zero */
    bool cut;
};

struct text text_on(char *buffer, size_t size); /* size >= 1 */
void text_str(struct text *t, const char *s);
void text_char(struct text *t, char c);
void text_u32(struct text *t, uint32_t x);
void text_hex(struct text *t, uint32_t x, unsigned digits);
/* Writes x rounded to 6 digits, or to as many more, up to 9, as it takes to read back as the same float. Zeros at the end are left
 * away. Writes `none` where x is not finite. */
void text_float(struct text *t, float x);
/* Writes four significant digits, for people. They do not always read back as the same float. */
void text_float4(struct text *t, float x);
/* Writes nine significant digits, with a single conversion. They read back as the same float. */
void text_float9(struct text *t, float x);
/* Writes milliseconds as seconds with three decimals: 1230.500 */
void text_seconds(struct text *t, uint64_t ms);
/* Writes a name and its value with a blank before each; `-` for an empty text. */
void text_named_str(struct text *t, const char *name, const char *value);
void text_named_u32(struct text *t, const char *name, uint32_t value);
void text_named_float(struct text *t, const char *name, float value);

/* Reads a decimal number and nothing else: [+-]digits[.digits][e[+-]digits], at most 40 characters. It takes no hex, inf,
 * nan or blanks, and rounds correctly. ERR_PARSE; ERR_RANGE where the number exceeds a float. */
MUST_CHECK enum err text_parse_float(const char *s, float *x);
/* Reads digits only. ERR_PARSE; ERR_RANGE above 2^32 - 1. */
MUST_CHECK enum err text_parse_u32(const char *s, uint32_t *x);

#endif
