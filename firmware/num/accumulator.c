#include "num/accumulator.h"

#ifdef REFLUX_FIXED_POINT

struct coefficient coefficient_from_float(float c)
{
    struct coefficient k = {0, 0};
    float magnitude = c < 0.0f ? -c : c;
    if (!(magnitude >= 3.5527137e-15f)) /* 2^-48; also NaN */
        return k;
    if (magnitude >= 2147483648.0f) {
        k.mantissa = c < 0.0f ? -INT32_MAX : INT32_MAX;
        return k;
    }
    /* Bounded: 2^-48 needs 78 doublings to reach 2^30. Doubling is exact. */
    while (magnitude < 1073741824.0f && k.shift < 78) {
        magnitude *= 2.0f;
        k.shift++;
    }
    int32_t mantissa = magnitude >= 2147483648.0f ? INT32_MAX : (int32_t)magnitude;
    k.mantissa = c < 0.0f ? -mantissa : mantissa;
    return k;
}

static int64_t saturating_add(int64_t a, int64_t b)
{
    int64_t sum;
    if (__builtin_add_overflow(a, b, &sum))
        return b > 0 ? INT64_MAX : INT64_MIN;
    return sum;
}

num_t accumulator_get(const struct accumulator *a)
{
    return num_from_q((a->q48 >> ACCUMULATOR_EXTRA_BITS) +
                      (a->q48 >> (ACCUMULATOR_EXTRA_BITS - 1) & 1));
}

void accumulator_add(struct accumulator *a, num_t x)
{
    a->q48 = saturating_add(a->q48, (int64_t)x.q * ((int64_t)1 << ACCUMULATOR_EXTRA_BITS));
}

/* a += product * 2^-(48 + right); |product| <= 2^62. */
static void add_shifted(struct accumulator *a, int64_t product, int32_t right)
{
    if (right > 62)
        return;
    int64_t scaled;
    if (right > 0) {
        scaled = num_shift_right(product, right);
    } else {
        scaled = (int64_t)((uint64_t)product << -right);
        if (scaled >> -right != product)
            scaled = product < 0 ? INT64_MIN : INT64_MAX;
    }
    a->q48 = saturating_add(a->q48, scaled);
}

void accumulator_add_product(struct accumulator *a, struct coefficient c, num_t x)
{
    /* mantissa * q is the product scaled by 2^(shift + 24); we want it scaled by 2^48. */
    add_shifted(a, (int64_t)c.mantissa * x.q, c.shift + NUM_FRACTION_BITS - 48);
}

void accumulator_add_sum(struct accumulator *a, const struct accumulator *b)
{
    a->q48 = saturating_add(a->q48, b->q48);
}

void accumulator_take_sum(struct accumulator *a, const struct accumulator *b)
{
    a->q48 = saturating_add(a->q48, b->q48 == INT64_MIN ? INT64_MAX : -b->q48);
}

void accumulator_add_scaled(struct accumulator *a, struct coefficient c,
                            const struct accumulator *b)
{
    /* The product is taken in two halves, scaled by 2^16 and 2^47. Each has 62 bits at most. The last bit of b does not matter. */
    int64_t high = b->q48 >> 32;
    int64_t low = (b->q48 & UINT32_MAX) >> 1;
    add_shifted(a, c.mantissa * high, c.shift + 16 - 48);
    add_shifted(a, c.mantissa * low, c.shift + 47 - 48);
}

void accumulator_clamp(struct accumulator *a, num_t lo, num_t hi)
{
    struct accumulator low, high;
    accumulator_set(&low, lo);
    accumulator_set(&high, hi);
    if (a->q48 < low.q48)
        *a = low;
    else if (a->q48 > high.q48)
        *a = high;
}

#else

struct coefficient coefficient_from_float(float c)
{
    return (struct coefficient){c};
}

void accumulator_add(struct accumulator *a, num_t x)
{
    /* Double-float: the exact error of the addition (two-sum, whichever term is larger) joins the carry,
     * then both are normalised. Kahan's shorter form loses the carry when x is larger than the sum, as a
     * proportional part usually is. Needs the compiler not to re-associate: the default without
     * -ffast-math. */
    float s = a->sum + x;
    float from_x = s - a->sum;
    float lost = (a->sum - (s - from_x)) + (x - from_x);
    lost -= a->carry;
    float t = s + lost;
    a->carry = (t - s) - lost;
    a->sum = t;
}

void accumulator_add_product(struct accumulator *a, struct coefficient c, num_t x)
{
    accumulator_add(a, c.value * x);
}

void accumulator_add_sum(struct accumulator *a, const struct accumulator *b)
{
    accumulator_add(a, b->sum);
    accumulator_add(a, -b->carry);
}

void accumulator_take_sum(struct accumulator *a, const struct accumulator *b)
{
    accumulator_add(a, -b->sum);
    accumulator_add(a, b->carry);
}

void accumulator_add_scaled(struct accumulator *a, struct coefficient c,
                            const struct accumulator *b)
{
    accumulator_add(a, c.value * b->sum); /* the carry of b is half a step of its sum at most */
}

void accumulator_clamp(struct accumulator *a, num_t lo, num_t hi)
{
    if (a->sum < lo)
        accumulator_set(a, lo);
    else if (a->sum > hi)
        accumulator_set(a, hi);
}

#endif
