#include "base/decimal.h"

#include <string.h>

#define SHIFT_MAX 28 /* bits in one shift: 10 * 2^28 fits uint32_t */

#define MANTISSA_BITS 24
#define EXPONENT_MIN  (-149) /* exponent of the last bit of the smallest float */

static void tidy(struct decimal *d)
{
    unsigned zeros = 0;
    while (zeros < d->n && d->digit[zeros] == 0)
        zeros++;
    memmove(d->digit, d->digit + zeros, (size_t)d->n - zeros);
    d->n = (uint8_t)(d->n - zeros);
    d->point = (int16_t)(d->point - (int)zeros);
    while (d->n > DECIMAL_KEPT || (d->n && d->digit[d->n - 1] == 0))
        d->more = d->digit[--d->n] != 0 || d->more;
}

/* Multiplies by 2^k, k at most SHIFT_MAX, from the last digit to the first. */
static void shift_left(struct decimal *d, unsigned k)
{
    uint32_t carry = 0;
    for (unsigned i = d->n + DECIMAL_SPARE; i-- > 0;) {
        if (i >= DECIMAL_SPARE)
            carry += (uint32_t)d->digit[i - DECIMAL_SPARE] << k;
        d->digit[i] = (uint8_t)(carry % 10u);
        carry /= 10u;
    }
    d->n = (uint8_t)(d->n + DECIMAL_SPARE);
    d->point = (int16_t)(d->point + DECIMAL_SPARE);
    tidy(d);
}

/* Divides by 2^k, k at most SHIFT_MAX, by long division. After the last digit, every round halves the remainder at least
 * once, so at most k rounds follow. */
static void shift_right(struct decimal *d, unsigned k)
{
    uint32_t rest = 0;
    unsigned written = 0;
    for (unsigned read = 0; read < d->n || rest; read++) {
        rest = rest * 10u + (read < d->n ? d->digit[read] : 0u);
        uint8_t digit = (uint8_t)(rest >> k);
        rest &= (1u << k) - 1u;
        if (!written && !digit)
            d->point--;
        else if (written < DECIMAL_KEPT)
            d->digit[written++] = digit;
        else
            d->more = digit || d->more;
    }
    d->n = (uint8_t)written;
    tidy(d);
}

/* Multiplies by 2^k. */
static void shift(struct decimal *d, int k)
{
    for (; k > SHIFT_MAX; k -= SHIFT_MAX)
        shift_left(d, SHIFT_MAX);
    for (; k < -SHIFT_MAX; k += SHIFT_MAX)
        shift_right(d, SHIFT_MAX);
    if (k > 0)
        shift_left(d, (unsigned)k);
    else
        shift_right(d, (unsigned)-k);
}

void decimal_of_float(struct decimal *d, float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    uint32_t exponent = bits >> (MANTISSA_BITS - 1) & 0xFFu;
    uint32_t mantissa = bits & ((1u << (MANTISSA_BITS - 1)) - 1u);
    if (exponent)
        mantissa |= 1u << (MANTISSA_BITS - 1);
    else
        exponent = 1;
    *d = (struct decimal){.n = 8, .point = 8}; /* 2^24 has eight digits */
    for (unsigned i = d->n; i-- > 0; mantissa /= 10u)
        d->digit[i] = (uint8_t)(mantissa % 10u);
    tidy(d);
    shift(d, (int)exponent - 1 + EXPONENT_MIN);
}

/* Returns whether d rounds up to n digits. */
static bool rounds_up(const struct decimal *d, unsigned n)
{
    if (n >= d->n)
        return false;
    if (d->digit[n] == 5 && n + 1u == d->n && !d->more)
        return n > 0 && d->digit[n - 1] % 2u != 0;
    return d->digit[n] >= 5;
}

void decimal_round(struct decimal *d, unsigned n)
{
    bool up = rounds_up(d, n);
    if (n < d->n)
        d->n = (uint8_t)n;
    while (up && d->n && d->digit[d->n - 1] == 9)
        d->n--;
    if (up && d->n) {
        d->digit[d->n - 1]++;
    } else if (up) {
        d->digit[0] = 1;
        d->n = 1;
        d->point++;
    }
    d->more = false;
    tidy(d);
}

/* Returns the nearest whole number, of two equally near ones the even one. d is below 10^9. */
static uint32_t nearest_whole(const struct decimal *d)
{
    uint32_t x = 0;
    if (d->point < 0)
        return 0;
    for (int i = 0; i < d->point; i++)
        x = x * 10u + (i < d->n ? d->digit[i] : 0u);
    return x + (rounds_up(d, (unsigned)d->point) ? 1u : 0u);
}

float decimal_to_float(struct decimal *d)
{
    uint32_t bits = 0;
    float x;
    int exponent = 0, k;
    tidy(d);
    if (d->n && d->point > 39) { /* at least 1e39 */
        bits = 0x7F800000u;
    } else if (d->n && d->point >= -45) { /* smaller ones are nearer to 0 */
        /* Scales to 0.5 .. 1 times 2^exponent. The point comes nearer with every shift, because 8 is less than 10. */
        while ((k = d->point ? -3 * d->point : d->digit[0] < 5) != 0) {
            shift(d, k);
            exponent -= k;
        }
        /* Very small floats have fewer bits. */
        k = exponent - MANTISSA_BITS < EXPONENT_MIN ? exponent - EXPONENT_MIN : MANTISSA_BITS;
        shift(d, k);
        bits = nearest_whole(d);
        if (k == MANTISSA_BITS)
            bits += (uint32_t)(exponent - MANTISSA_BITS - EXPONENT_MIN) << (MANTISSA_BITS - 1);
        if (bits > 0x7F800000u)
            bits = 0x7F800000u;
    }
    memcpy(&x, &bits, sizeof x);
    return x;
}
