/* scaled_t: a number with a range far beyond that of num_t, for variances, gains of estimators and what else is sometimes
 * 1e-8 and sometimes 1e6.
 *
 *             float build     fixed build
 *   type      float32         mantissa and exponent: m * 2^e, |m| in [2^29, 2^30], or m = 0
 *   step      2^-24 relative  2^-29 relative
 *   range     +-3.4e38        exponents are int32: nothing here gets near their end
 *   rounding  nearest         within a step; of a quotient within 2^-26
 *
 * Division by zero gives the largest magnitude with the sign of the dividend, 0/0 is 0. */
#ifndef REFLUX_NUM_SCALED_H
#define REFLUX_NUM_SCALED_H

#include "num/accumulator.h"
#include "num/real.h"

#ifdef REFLUX_FIXED_POINT

#define SCALED_EXPONENT_MAX 4096 /* of what a division by zero gives */

typedef struct {
    int32_t m, e;
} scaled_t;

/* (a * b) / 2^32 to the nearest: one instruction on Cortex-M4. */
static inline int32_t scaled_high(int32_t a, int32_t b)
{
    return (int32_t)(((int64_t)a * b + ((int64_t)1 << 31)) >> 32);
}

/* m * 2^e, made to fit; |m| < 2^62. */
scaled_t scaled_from_product(int64_t m, int32_t e);

/* m * 2^e, made to fit. */
static inline scaled_t scaled_normal(int32_t m, int32_t e)
{
    if (m == 0)
        return (scaled_t){0, 0};
    int32_t left = __builtin_clz((uint32_t)(m < 0 ? -m : m)) - 2;
    if (left < 0)
        return (scaled_t){m >> 1, e + 1};
    return (scaled_t){(int32_t)((uint32_t)m << left), e - left};
}

static inline scaled_t scaled_add(scaled_t a, scaled_t b)
{
    if (a.m == 0)
        return b;
    if (b.m == 0)
        return a;
    int32_t apart = a.e - b.e;
    if (apart >= 0)
        return apart > 30 ? a : scaled_normal(a.m + (b.m >> apart), a.e);
    return apart < -30 ? b : scaled_normal(b.m + (a.m >> -apart), b.e);
}

/* The product of two full mantissas has 59 or 60 bits, so that one look at its upper word is enough. */
static inline scaled_t scaled_mul(scaled_t a, scaled_t b)
{
    int64_t product = (int64_t)a.m * b.m;
    uint32_t high = (uint32_t)(product >> 32), low = (uint32_t)product;
    if ((high ^ (uint32_t)((int32_t)high >> 31)) < 1u << 27)
        return (scaled_t){(int32_t)(high << 3 | low >> 29), a.e + b.e + 29};
    return (scaled_t){(int32_t)(high << 2 | low >> 30), a.e + b.e + 30};
}

/* 1/b, b not 0: by Newton's step from the quotient that the processor's division gives. */
static inline scaled_t scaled_inverse(scaled_t b)
{
    int32_t m = b.m < 0 ? -b.m : b.m;
    int32_t rough = (int32_t)(0x7FFFFFFFu / (uint32_t)(m >> 15)) * (1 << 13); /* 2^59/m, to 2^-14 */
    int32_t lacking = (int32_t)((((int64_t)1 << 59) - (int64_t)m * rough) >> 28);
    int32_t r = rough + (int32_t)(((int64_t)rough * lacking) >> 31);
    r = r < 1 << 30 ? r : (1 << 30) - 1;
    return (scaled_t){b.m < 0 ? -r : r, -59 - b.e};
}

scaled_t scaled_div(scaled_t a, scaled_t b);
/* The same for b > 0. */
static inline scaled_t scaled_div_positive(scaled_t a, scaled_t b)
{
    return scaled_mul(a, scaled_inverse(b));
}
static inline scaled_t scaled_from_num(num_t x)
{
    return scaled_normal(x.q, -NUM_FRACTION_BITS);
}
bool scaled_lt(scaled_t a, scaled_t b);
scaled_t scaled_from_float(float x); /* NaN gives 0 (callers refuse it before) */
num_t scaled_to_num(scaled_t x);     /* nearest, saturating */
float scaled_to_float(scaled_t x);   /* saturating at +-3.4e38, 0 below 1e-38 */
/* a += x * y at full width, saturating. */
void scaled_accumulate(struct accumulator *a, scaled_t x, scaled_t y);
static inline scaled_t scaled_neg(scaled_t a)
{
    return (scaled_t){-a.m, a.e};
}
static inline bool scaled_is_zero(scaled_t a)
{
    return a.m == 0;
}

#else

typedef float scaled_t;

static inline scaled_t scaled_add(scaled_t a, scaled_t b)
{
    return a + b;
}
static inline scaled_t scaled_mul(scaled_t a, scaled_t b)
{
    return a * b;
}
static inline scaled_t scaled_div(scaled_t a, scaled_t b)
{
    if (b == 0.0f)
        return a > 0.0f ? 3.4e38f : (a < 0.0f ? -3.4e38f : 0.0f);
    return a / b;
}
static inline scaled_t scaled_div_positive(scaled_t a, scaled_t b)
{
    return a / b;
}
static inline bool scaled_lt(scaled_t a, scaled_t b)
{
    return a < b;
}
static inline scaled_t scaled_from_num(num_t x)
{
    return x;
}
static inline scaled_t scaled_from_float(float x)
{
    return x;
}
static inline num_t scaled_to_num(scaled_t x)
{
    return x;
}
static inline float scaled_to_float(scaled_t x)
{
    return x;
}
/* As accumulator_add(), written here for loops over many parameters; the sum of them is the larger. */
static inline void scaled_accumulate(struct accumulator *a, scaled_t x, scaled_t y)
{
    float more = real_fma(x, y, -a->carry), sum = a->sum + more;
    a->carry = (sum - a->sum) - more;
    a->sum = sum;
}
static inline scaled_t scaled_neg(scaled_t a)
{
    return -a;
}
static inline bool scaled_is_zero(scaled_t a)
{
    return a == 0.0f;
}

#endif

static inline scaled_t scaled_sub(scaled_t a, scaled_t b)
{
    return scaled_add(a, scaled_neg(b));
}

#endif
