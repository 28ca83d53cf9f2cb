/* Text in and out. Nothing of the C library's printf and scanf is used: eight kilobytes on the target, and each
 * library writes numbers its own way. These are the digits of glibc's %g.
 *
 * struct text writes into a caller's buffer, always terminated; what does not fit is cut and `cut` set.
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
/* Shortest text of at most 9 significant digits; reads back as the same float. */
void text_float(struct text *t, float x);
/* Four digits, for people: does not read back as the same float. */
void text_float4(struct text *t, float x);
/* Nine digits, always: one conversion, reads back as the same float. */
void text_float9(struct text *t, float x);
/* Milliseconds as seconds with three decimals: 1230.500 */
void text_seconds(struct text *t, uint64_t ms);
/* A name and its value with a blank before each; `-` for an empty text. */
void text_named_str(struct text *t, const char *name, const char *value);
void text_named_u32(struct text *t, const char *name, uint32_t value);
void text_named_float(struct text *t, const char *name, float value);

/* A decimal number and nothing else: [+-]digits[.digits][e[+-]digits], at most 40 characters. No hex, inf,
 * nan, blanks. Correctly rounded. ERR_PARSE, or ERR_RANGE where it exceeds a float. */
MUST_CHECK enum err text_parse_float(const char *s, float *x);
/* Digits only. ERR_PARSE, ERR_RANGE above 2^32 - 1. */
MUST_CHECK enum err text_parse_u32(const char *s, uint32_t *x);

#endif
