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
#include "num/scaled_type.h"

#ifdef REFLUX_FIXED_POINT

/* m * 2^e, made to fit; |m| < 2^62 and 2^31. */
scaled_t scaled_from_product(int64_t m, int32_t e);
scaled_t scaled_normal(int32_t m, int32_t e);
scaled_t scaled_add(scaled_t a, scaled_t b);
scaled_t scaled_mul(scaled_t a, scaled_t b);
scaled_t scaled_div(scaled_t a, scaled_t b);
/* The same for b > 0. */
scaled_t scaled_div_positive(scaled_t a, scaled_t b);
scaled_t scaled_from_num(num_t x);
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
