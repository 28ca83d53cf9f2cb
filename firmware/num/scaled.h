/* scaled_t: a number with a range far beyond that of num_t. It serves variances, gains of estimators and other numbers that
 * may be 1e-8 or 1e6.
 *
 *             float build     fixed build
 *   type      float32         mantissa and exponent: m * 2^e, |m| in [2^29, 2^30], or m = 0
 *   step      2^-24 relative  2^-29 relative
 *   range     +-3.4e38        exponents are int32, far beyond all numbers here
 *   rounding  nearest         within a step; of a quotient within 2^-26
 *
 * Division by zero gives the largest magnitude with the sign of the dividend, 0/0 is 0. */
#ifndef REFLUX_NUM_SCALED_H
#define REFLUX_NUM_SCALED_H

#include "num/accumulator.h"
#include "num/real.h"
#include "num/scaled_type.h"

#ifdef REFLUX_FIXED_POINT

/* Return m * 2^e with a mantissa that fits. |m| is below 2^62 in the first, below 2^31 in the second. */
scaled_t scaled_from_product(int64_t m, int32_t e);
scaled_t scaled_normal(int32_t m, int32_t e);
scaled_t scaled_add(scaled_t a, scaled_t b);
scaled_t scaled_mul(scaled_t a, scaled_t b);
scaled_t scaled_div(scaled_t a, scaled_t b);
/* Returns a/b for b > 0. */
scaled_t scaled_div_positive(scaled_t a, scaled_t b);
scaled_t scaled_from_num(num_t x);
bool scaled_lt(scaled_t a, scaled_t b);
/* NaN gives 0; callers refuse it before. */
scaled_t scaled_from_float(float x);
/* Returns the nearest num_t, saturating. */
num_t scaled_to_num(scaled_t x);
/* Returns a float, saturating at +-3.4e38; 0 below 1e-38. */
float scaled_to_float(scaled_t x);
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
/* Does the work of accumulator_add_product(), inline for loops over many parameters. It assumes that |a| exceeds the product. */
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
