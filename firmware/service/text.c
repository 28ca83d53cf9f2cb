#include "service/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/channel.h"

/* The target's C library hands floats to printf in a way of its own (float only, no double). Elsewhere the
 * language's promotion applies, on the host alone. */
#ifndef printf_float
#define printf_float(x) (x)
#pragma GCC diagnostic ignored "-Wdouble-promotion"
#endif

struct text text_on(char *buffer, size_t size)
{
    buffer[0] = '\0';
    return (struct text){.start = buffer, .n = 0, .size = size, .cut = false};
}

void text_char(struct text *t, char c)
{
    if (t->n + 1 >= t->size) {
        t->cut = true;
        return;
    }
    t->start[t->n++] = c;
    t->start[t->n] = '\0';
}

void text_str(struct text *t, const char *s)
{
    while (*s)
        text_char(t, *s++);
}

void text_u32(struct text *t, uint32_t x)
{
    char digits[11];
    unsigned n = 0;
    do {
        digits[n++] = (char)('0' + x % 10u);
        x /= 10u;
    } while (x);
    while (n)
        text_char(t, digits[--n]);
}

void text_hex(struct text *t, uint32_t x, unsigned digits)
{
    while (digits) {
        digits--;
        text_char(t, "0123456789abcdef"[(x >> (4u * digits)) & 15u]);
    }
}

void text_seconds(struct text *t, uint64_t ms)
{
    char digits[21];
    unsigned n = 0;
    uint64_t whole = ms / 1000u;
    unsigned rest = (unsigned)(ms % 1000u);
    do {
        digits[n++] = (char)('0' + (char)(whole % 10u));
        whole /= 10u;
    } while (whole);
    while (n)
        text_char(t, digits[--n]);
    text_char(t, '.');
    text_char(t, (char)('0' + rest / 100u));
    text_char(t, (char)('0' + rest / 10u % 10u));
    text_char(t, (char)('0' + rest % 10u));
}

void text_float(struct text *t, float x)
{
    char buffer[24];
    /* Six digits are enough for most numbers people type; nine always are. */
    for (int digits = 6; digits <= 9; digits++) {
        float back;
        (void)snprintf(buffer, sizeof buffer, "%.*g", digits, printf_float(x));
        if (text_parse_float(buffer, &back) == ERR_OK && back == x)
            break;
    }
    text_str(t, buffer);
}

void text_float9(struct text *t, float x)
{
    char buffer[24];
    (void)snprintf(buffer, sizeof buffer, "%.9g", printf_float(x));
    text_str(t, buffer);
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static const char *skip_digits(const char *s, unsigned *n)
{
    while (is_digit(*s)) {
        s++;
        (*n)++;
    }
    return s;
}

static bool looks_like_number(const char *s)
{
    const char *start = s;
    unsigned digits = 0, exponent = 0;
    if (*s == '+' || *s == '-')
        s++;
    s = skip_digits(s, &digits);
    if (*s == '.')
        s = skip_digits(s + 1, &digits);
    if (digits == 0)
        return false;
    if (*s == 'e' || *s == 'E') {
        s++;
        if (*s == '+' || *s == '-')
            s++;
        s = skip_digits(s, &exponent);
        if (exponent == 0)
            return false;
    }
    return *s == '\0' && s - start <= 40;
}

enum err text_parse_float(const char *s, float *x)
{
    if (!looks_like_number(s))
        return ERR_PARSE;
    float value = strtof(s, NULL);
    if (!float_is_finite(value))
        return ERR_RANGE;
    *x = value;
    return ERR_OK;
}

enum err text_parse_u32(const char *s, uint32_t *x)
{
    uint32_t value = 0;
    if (!*s)
        return ERR_PARSE;
    for (; *s; s++) {
        if (!is_digit(*s))
            return ERR_PARSE;
        uint32_t digit = (uint32_t)(*s - '0');
        if (value > (UINT32_MAX - digit) / 10u)
            return ERR_RANGE;
        value = value * 10u + digit;
    }
    *x = value;
    return ERR_OK;
}
