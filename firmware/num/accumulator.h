/* Sums that must not stall: many tiny increments onto a value of order one.
 *
 * An hour-long integral time at a 0.05 s tick adds 1.4e-5 of an error that may itself be 1e-6 of span: far
 * below one step of num_t. Accumulators therefore have more bits:
 *   float build: double-float sum, value and carried remainder: about 2^-47 relative
 *   fixed build: 64-bit Q15.48: range +-32768, step 2^-48 = 3.6e-15, saturating
 * A factor smaller than one has an exponent of its own (struct coefficient), so that it keeps the 24
 * significant bits of the float it came from, however small it is (down to 2^-48).
 */
#ifndef REFLUX_NUM_ACCUMULATOR_H
#define REFLUX_NUM_ACCUMULATOR_H

#include "num/num.h"

#ifdef REFLUX_FIXED_POINT

struct coefficient {
    int32_t mantissa; /* value = mantissa * 2^-shift */
    int32_t shift;    /* 0 .. 78 */
};

struct accumulator {
    int64_t q48;
};

#define ACCUMULATOR_EXTRA_BITS (48 - NUM_FRACTION_BITS)

static inline void accumulator_set(struct accumulator *a, num_t value)
{
    a->q48 = (int64_t)value.q * ((int64_t)1 << ACCUMULATOR_EXTRA_BITS);
}
/* Returns the value rounded to num_t, saturating. The first bit that is left away rounds. */
num_t accumulator_get(const struct accumulator *a);

#else

struct coefficient {
    float value;
};

struct accumulator {
    float sum, carry; /* the exact sum is sum - carry; |carry| <= half a step of sum */
};

static inline void accumulator_set(struct accumulator *a, num_t value)
{
    a->sum = value;
    a->carry = 0.0f;
}
static inline num_t accumulator_get(const struct accumulator *a)
{
    return a->sum;
}

#endif

/* Returns c as a coefficient. c is finite; a magnitude from 2^31 on is clipped, and one below 2^-48 becomes 0. */
struct coefficient coefficient_from_float(float c);

void accumulator_add(struct accumulator *a, num_t x);
/* a += c * x at full width. */
void accumulator_add_product(struct accumulator *a, struct coefficient c, num_t x);
/* a += b, a -= b, a += c * b, all at full width. */
void accumulator_add_sum(struct accumulator *a, const struct accumulator *b);
void accumulator_take_sum(struct accumulator *a, const struct accumulator *b);
void accumulator_add_scaled(struct accumulator *a, struct coefficient c,
                            const struct accumulator *b);
/* Brings the sum inside [lo, hi]. A sum that is inside stays unchanged, remainder included. */
void accumulator_clamp(struct accumulator *a, num_t lo, num_t hi);

#endif
