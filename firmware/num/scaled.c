#include "num/scaled.h"

#ifdef REFLUX_FIXED_POINT

#include <string.h>

#include "num/scaled_inline.h"

/* Bits of a mantissa: |m| is in [2^29, 2^30]. */
#define MANTISSA_BITS 30

scaled_t scaled_from_product(int64_t m, int32_t e)
{
    int32_t high = (int32_t)(m >> 32);
    if (high == (int32_t)m >> 31) /* it has 32 bits */
        return m == INT32_MIN ? (scaled_t){-(1 << 29), e + 2} : scaled_normal((int32_t)m, e);
    uint32_t above = (uint32_t)(high < 0 ? ~high : high);
    int32_t right = above ? 34 - __builtin_clz(above) : 2;
    return scaled_normal((int32_t)(m >> right), e + right);
}

scaled_t scaled_normal(int32_t m, int32_t e)
{
    return inline_normal(m, e);
}

scaled_t scaled_add(scaled_t a, scaled_t b)
{
    return inline_add(a, b);
}

scaled_t scaled_mul(scaled_t a, scaled_t b)
{
    return inline_mul(a, b);
}

scaled_t scaled_div_positive(scaled_t a, scaled_t b)
{
    return inline_mul(a, inline_inverse(b));
}

scaled_t scaled_from_num(num_t x)
{
    return inline_normal(x.q, -NUM_FRACTION_BITS);
}

scaled_t scaled_div(scaled_t a, scaled_t b)
{
    const int32_t most = (1 << MANTISSA_BITS) - 1;
    if (b.m == 0)
        return a.m == 0 ? a : (scaled_t){a.m < 0 ? -most : most, SCALED_EXPONENT_MAX};
    return scaled_div_positive(a, b);
}

bool scaled_lt(scaled_t a, scaled_t b)
{
    if (a.m == 0 || b.m == 0 || (a.m < 0) != (b.m < 0))
        return a.m < b.m;
    if (a.e != b.e)
        return (a.e < b.e) == (a.m > 0);
    return a.m < b.m;
}

scaled_t scaled_from_float(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    int32_t exponent = (int32_t)(bits >> 23 & 0xFFu);
    int32_t fraction = (int32_t)(bits & 0x7FFFFFu);
    if (exponent == 0xFF && fraction)
        return (scaled_t){0, 0}; /* no number */
    if (exponent)
        fraction += 1 << 23;
    else
        exponent = 1;
    return scaled_from_product(bits >> 31 ? -fraction : fraction, exponent - 150);
}

num_t scaled_to_num(scaled_t x)
{
    int32_t left = x.e + NUM_FRACTION_BITS;
    if (left < -MANTISSA_BITS - 1)
        return num_zero();
    if (left < 0)
        return num_from_q(num_shift_right(x.m, -left));
    return num_from_q(x.m * ((int64_t)1 << (left < 32 ? left : 32)));
}

void scaled_accumulate(struct accumulator *a, scaled_t x, scaled_t y)
{
    int64_t product = (int64_t)x.m * y.m; /* below 2^60 */
    int32_t right = -(x.e + y.e + NUM_FRACTION_BITS + ACCUMULATOR_EXTRA_BITS);
    struct accumulator more = {0};
    if (right > 62)
        return;
    if (right > 0)
        more.q48 = num_shift_right(product, right);
    else if (__builtin_mul_overflow(product, (int64_t)1 << (right < -62 ? 62 : -right), &more.q48))
        more.q48 = product < 0 ? INT64_MIN : INT64_MAX;
    accumulator_add_sum(a, &more);
}

float scaled_to_float(scaled_t x)
{
    float value = (float)x.m;
    if (x.e > 127 - MANTISSA_BITS)
        return x.m < 0 ? -3.4e38f : (x.m ? 3.4e38f : 0.0f);
    if (x.e < -126 - MANTISSA_BITS)
        return 0.0f;
    /* Multiplies by the power of two in two steps, because both factors must be normal numbers. */
    for (int32_t part = 0, e = x.e; part < 2; part++) {
        int32_t now = part == 0 ? e / 2 : e - e / 2;
        uint32_t bits = (uint32_t)(now + 127) << 23;
        float power;
        memcpy(&power, &bits, sizeof power);
        value *= power;
    }
    return value;
}

#endif
