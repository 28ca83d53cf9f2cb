#include "base/text.h"

#include <string.h>

#include "base/channel.h"
#include "base/decimal.h"

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

/* Divides x by 1000, in parts of 16 bits, because nothing else here divides 64 bits. */
static uint64_t divide_by_1000(uint64_t x, unsigned *rest)
{
    uint64_t result = 0;
    uint32_t left = 0;
    for (unsigned i = 4; i-- > 0;) {
        left = left << 16 | (uint32_t)(x >> (16u * i) & 0xFFFFu);
        result = result << 16 | left / 1000u;
        left %= 1000u;
    }
    *rest = left;
    return result;
}

static void text_thousandths(struct text *t, unsigned x)
{
    text_char(t, (char)('0' + x / 100u));
    text_char(t, (char)('0' + x / 10u % 10u));
    text_char(t, (char)('0' + x % 10u));
}

void text_seconds(struct text *t, uint64_t ms)
{
    unsigned group[7], n = 0;
    do
        ms = divide_by_1000(ms, &group[n++]);
    while (ms >= 1000u);
    text_u32(t, (uint32_t)ms);
    while (n) {
        if (n == 1)
            text_char(t, '.');
        text_thousandths(t, group[--n]);
    }
}

/* Writes a number as %g of a C library does. It takes a power of ten where the number would begin with five zeros or would
 * be longer than `digits`. */
static void put_decimal(struct text *t, const struct decimal *d, int digits)
{
    int power = d->n ? d->point - 1 : 0;
    bool scientific = power < -4 || power >= digits;
    int point = scientific ? 1 : power + 1, n = d->n > point ? d->n : point;
    for (int i = point < 1 ? point - 1 : 0; i < n; i++) {
        if (i == point)
            text_char(t, '.');
        text_char(t, (char)('0' + (i >= 0 && i < d->n ? d->digit[i] : 0)));
    }
    if (scientific) {
        unsigned size = (unsigned)(power < 0 ? -power : power);
        text_str(t, power < 0 ? "e-" : "e+");
        text_char(t, (char)('0' + size / 10u));
        text_char(t, (char)('0' + size % 10u));
    }
}

/* Begins a number with its sign and makes *x positive. Returns false, and writes `none`, where *x is not finite. */
static bool begin_number(struct text *t, float *x)
{
    if (!float_is_finite(*x)) {
        text_str(t, "none");
        return false;
    }
    uint32_t bits;
    memcpy(&bits, x, sizeof bits);
    if (bits >> 31) {
        text_char(t, '-');
        *x = -*x;
    }
    return true;
}

void text_float(struct text *t, float x)
{
    struct decimal d;
    int digits = 6;
    if (!begin_number(t, &x))
        return;
    /* Six digits are enough for most numbers that people type; nine are always enough. */
    for (; digits < 9; digits++) {
        decimal_of_float(&d, x);
        decimal_round(&d, (unsigned)digits);
        if (decimal_to_float(&d) == x)
            break;
    }
    decimal_of_float(&d, x);
    decimal_round(&d, (unsigned)digits);
    put_decimal(t, &d, digits);
}

static void put_rounded(struct text *t, float x, unsigned digits)
{
    struct decimal d;
    if (!begin_number(t, &x))
        return;
    decimal_of_float(&d, x);
    decimal_round(&d, digits);
    put_decimal(t, &d, 9);
}

void text_float4(struct text *t, float x)
{
    put_rounded(t, x, 4);
}

void text_float9(struct text *t, float x)
{
    put_rounded(t, x, 9);
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Appends digits to *d. whole: they stand before the point, so d->point rises with them. */
static const char *take_digits(const char *s, struct decimal *d, bool whole)
{
    for (; is_digit(*s); s++) {
        if (d->n < DECIMAL_READ)
            d->digit[d->n++] = (uint8_t)(*s - '0');
        d->point = (int16_t)(d->point + whole);
    }
    return s;
}

enum err text_parse_float(const char *s, float *x)
{
    const char *start = s;
    struct decimal d = {.n = 0};
    bool negative = *s == '-';
    if (*s == '+' || *s == '-')
        s++;
    s = take_digits(s, &d, true);
    if (*s == '.')
        s = take_digits(s + 1, &d, false);
    if (d.n == 0)
        return ERR_PARSE;
    if (*s == 'e' || *s == 'E') {
        int power = 0, sign = s[1] == '-' ? -1 : 1;
        s += s[1] == '+' || s[1] == '-' ? 2 : 1;
        if (!is_digit(*s))
            return ERR_PARSE;
        for (; is_digit(*s); s++)
            power = power < 1000 ? power * 10 + (*s - '0') : power;
        d.point = (int16_t)(d.point + sign * power);
    }
    if (*s != '\0' || s - start > 40)
        return ERR_PARSE;
    float value = decimal_to_float(&d);
    if (!float_is_finite(value))
        return ERR_RANGE;
    *x = negative ? -value : value;
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

static void name_of(struct text *t, const char *name)
{
    text_char(t, ' ');
    text_str(t, name);
    text_char(t, ' ');
}

void text_named_str(struct text *t, const char *name, const char *value)
{
    name_of(t, name);
    text_str(t, value[0] ? value : "-");
}

void text_named_u32(struct text *t, const char *name, uint32_t value)
{
    name_of(t, name);
    text_u32(t, value);
}

void text_named_float(struct text *t, const char *name, float value)
{
    name_of(t, name);
    text_float(t, value);
}
