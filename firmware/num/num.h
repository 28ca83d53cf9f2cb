/* num_t: the scalar of regulatory control, chosen when the firmware is built.
 *
 *             float build            fixed build (REFLUX_FIXED_POINT)
 *   type      float32                Q7.24 in an int32, wrapped in a struct so that + and * do not compile
 *   range     +-3.4e38               [-128, 128 - 2^-24]
 *   step      2^-24 relative         2^-24 = 5.96e-8 absolute
 *   overflow  never by design: every signal is a fraction of span and clamped     saturates
 *   rounding  nearest even           nearest, ties away from zero (mul, div, from_float)
 *
 * A channel's span is 1.0, so 24 fraction bits resolve 6e-8 of span and 127 spans of headroom remain for
 * gains and sums. State that must resolve more (integrators, slow filters) lives in num/accumulator.h.
 *
 * Finite inputs always give finite results in the fixed build. In the float build they do as long as the caller
 * keeps magnitudes below 1e18. NaN never gets here, because the firmware refuses it where numbers enter.
 */
#ifndef REFLUX_NUM_NUM_H
#define REFLUX_NUM_NUM_H

#include <stdbool.h>
#include <stdint.h>

#ifdef REFLUX_FIXED_POINT

typedef struct {
    int32_t q;
} num_t;

#define NUM_IS_FIXED      1
#define NUM_FRACTION_BITS 24
#define NUM_FORMAT        "Q7.24"
#define NUM_MAX_MAGNITUDE 127.0f /* largest magnitude that a parameter may have */

static inline num_t num_from_q(int64_t q)
{
    if (q != (int32_t)q)
        q = q < 0 ? INT32_MIN : INT32_MAX;
    return (num_t){(int32_t)q};
}

/* Returns the nearest num_t, saturating. NaN gives 0; callers refuse it before. */
num_t num_from_float(float x);
static inline num_t num_zero(void)
{
    return (num_t){0};
}
static inline num_t num_one(void)
{
    return (num_t){(int32_t)1 << NUM_FRACTION_BITS};
}
static inline float num_to_float(num_t a)
{
    return (float)a.q * 5.9604644775390625e-8f;
}
static inline num_t num_add(num_t a, num_t b)
{
    int32_t sum;
    if (__builtin_add_overflow(a.q, b.q, &sum))
        sum = b.q < 0 ? INT32_MIN : INT32_MAX;
    return (num_t){sum};
}
static inline num_t num_sub(num_t a, num_t b)
{
    int32_t difference;
    if (__builtin_sub_overflow(a.q, b.q, &difference))
        difference = b.q < 0 ? INT32_MAX : INT32_MIN;
    return (num_t){difference};
}
static inline num_t num_neg(num_t a)
{
    return num_sub((num_t){0}, a);
}
/* Returns p * 2^-right, rounded to the nearest, ties away from zero. For a negative p, half a step less one bit is added, so that a
 * tie goes down. right is 1..62, |p| <= 2^62. */
static inline int64_t num_shift_right(int64_t p, int32_t right)
{
    return (p + ((int64_t)1 << (right - 1)) - (p < 0)) >> right;
}
static inline num_t num_mul(num_t a, num_t b)
{
    return num_from_q(num_shift_right((int64_t)a.q * b.q, NUM_FRACTION_BITS));
}
/* Division by zero saturates with the sign of a; 0/0 is 0. */
static inline num_t num_div(num_t a, num_t b)
{
    if (b.q == 0)
        return (num_t){a.q > 0 ? INT32_MAX : (a.q < 0 ? INT32_MIN : 0)};
    int64_t n = (int64_t)a.q * ((int64_t)1 << NUM_FRACTION_BITS);
    int64_t d = b.q;
    int64_t half = (d < 0 ? -d : d) / 2;
    return num_from_q((n + (n < 0 ? -half : half)) / d);
}
static inline bool num_lt(num_t a, num_t b)
{
    return a.q < b.q;
}

/* A sum of products that may leave the range of num_t on its way. Its step is 2^-40 and its range +-2^23, so 512 products of any
 * two numbers fit. */
typedef struct {
    int64_t q40;
} num_wide_t;

static inline num_wide_t num_wide_zero(void)
{
    return (num_wide_t){0};
}
/* sum + a * b */
static inline num_wide_t num_wide_add(num_wide_t sum, num_t a, num_t b)
{
    return (num_wide_t){sum.q40 + (((int64_t)a.q * b.q + 128) >> 8)};
}
/* Returns the nearest num_t, saturating. */
static inline num_t num_from_wide(num_wide_t sum)
{
    return num_from_q((sum.q40 + 32768) >> 16);
}
static inline bool num_eq(num_t a, num_t b)
{
    return a.q == b.q;
}

#else

#define NUM_IS_FIXED 0
typedef float num_t;

#define NUM_FORMAT        "float32"
#define NUM_MAX_MAGNITUDE 127.0f /* limit of the fixed build, so that a configuration fits both */

static inline num_t num_from_float(float x)
{
    return x;
}
static inline num_t num_zero(void)
{
    return 0.0f;
}
static inline num_t num_one(void)
{
    return 1.0f;
}
static inline float num_to_float(num_t a)
{
    return a;
}
static inline num_t num_add(num_t a, num_t b)
{
    return a + b;
}
static inline num_t num_sub(num_t a, num_t b)
{
    return a - b;
}
static inline num_t num_neg(num_t a)
{
    return -a;
}
static inline num_t num_mul(num_t a, num_t b)
{
    return a * b;
}
/* Division by zero saturates at the largest magnitude with the sign of a; 0/0 is 0. */
static inline num_t num_div(num_t a, num_t b)
{
    if (b == 0.0f)
        return a > 0.0f ? 128.0f : (a < 0.0f ? -128.0f : 0.0f);
    return a / b;
}
static inline bool num_lt(num_t a, num_t b)
{
    return a < b;
}

typedef float num_wide_t;

static inline num_wide_t num_wide_zero(void)
{
    return 0.0f;
}
static inline num_wide_t num_wide_add(num_wide_t sum, num_t a, num_t b)
{
    return sum + a * b;
}
static inline num_t num_from_wide(num_wide_t sum)
{
    return sum;
}
static inline bool num_eq(num_t a, num_t b)
{
    return a == b;
}

#endif

static inline num_t num_min(num_t a, num_t b)
{
    return num_lt(b, a) ? b : a;
}
static inline num_t num_max(num_t a, num_t b)
{
    return num_lt(a, b) ? b : a;
}
/* lo <= hi */
static inline num_t num_clamp(num_t x, num_t lo, num_t hi)
{
    return num_max(lo, num_min(x, hi));
}
static inline num_t num_abs(num_t a)
{
    return num_lt(a, num_zero()) ? num_neg(a) : a;
}

#endif
