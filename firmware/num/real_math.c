/* Method: x = m 2^e with m in [sqrt(1/2), sqrt(2)); log2 x = e + t P(t), t = m - 1; 2^z = 2^n Q(z - n). P and Q are
 * minimax polynomials (Chebyshev points; P is good to 2^-42, Q to 2^-40), with coefficients in units of 2^-60. */
#include "num/real_math.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#define LOG2_E_Q38   INT64_C(396564993198) /* log2(e) 2^38 */
#define LN_2_Q38     INT64_C(190530846196) /* ln(2) 2^38 */
#define MANTISSA     23
#define BIAS         127
#define HIDDEN_BIT   (1u << MANTISSA)
#define SQRT_HALF_24 0xB504F3u /* sqrt(1/2) 2^24 */
#define Z_BITS       40        /* fraction bits of the exponent of two that exp2_of() takes */
#define Z_LIMIT      200       /* exponent of two beyond which every result is 0 or infinite */

static const int64_t log2_series[] = {
    INT64_C(1663314137230642957), INT64_C(-831657068617265543), INT64_C(554438045637575758),
    INT64_C(-415828533488648165), INT64_C(332662844886684816),  INT64_C(-277219125274692448),
    INT64_C(237615265444924463),  INT64_C(-207908496626792890), INT64_C(184840145179633453),
    INT64_C(-166498242540692862), INT64_C(150908957760617442),  INT64_C(-136081146681106551),
    INT64_C(128067076300485997),  INT64_C(-137140677267090028), INT64_C(131745861260319047),
    INT64_C(-64655703134189232)};

static const int64_t exp2_series[] = {INT64_C(1152921504606862525), INT64_C(799144290325166958),
                                      INT64_C(276962305846623797),  INT64_C(63991880473512138),
                                      INT64_C(11088947981773789),   INT64_C(1537254598262307),
                                      INT64_C(177589500166042),     INT64_C(17585134617795),
                                      INT64_C(1528733014629),       INT64_C(117666078255)};

static uint32_t bits_of(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static float float_of(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Splits |x| = mantissa 2^(exponent - 23), mantissa in [2^23, 2^24). x is finite and not 0. */
static uint32_t split_float(float x, int32_t *exponent)
{
    uint32_t bits = bits_of(x) & 0x7FFFFFFFu;
    uint32_t mantissa = bits & (HIDDEN_BIT - 1u);
    *exponent = (int32_t)(bits >> MANTISSA) - BIAS;
    if (*exponent != -BIAS)
        return mantissa | HIDDEN_BIT;
    int32_t up = __builtin_clz(mantissa) - (31 - MANTISSA); /* subnormal */
    *exponent = 1 - BIAS - up;
    return mantissa << up;
}

/* Returns (a b) 2^-31, rounded down. It multiplies parts of 32 bits, for which the compiler takes single multiplications. */
static int64_t multiply_q31(int64_t a, int32_t b)
{
    int32_t high = (int32_t)((uint64_t)a >> 32);
    int64_t low = (int64_t)((uint64_t)a & UINT32_MAX);
    return (int64_t)high * b * 2 + ((low * b) >> 31);
}

static int64_t series(const int64_t *c, unsigned n, int32_t t_q31)
{
    int64_t sum = c[n - 1];
    for (unsigned k = n - 1; k > 0; k--)
        sum = multiply_q31(sum, t_q31) + c[k - 1];
    return sum;
}

/* Returns log2 |x| in units of 2^-*bits, at least 36 bits of them valid. x is finite and not 0. */
static int64_t log2_of(float x, int32_t *bits)
{
    int32_t exponent;
    uint32_t mantissa = split_float(x, &exponent);
    int32_t t = (int32_t)(mantissa * 2u) - (1 << 24); /* units of 2^-24 */
    if (mantissa > SQRT_HALF_24) {
        exponent++;
        t = (int32_t)mantissa - (1 << 24);
    }
    t *= 1 << 7;
    int64_t part = multiply_q31(
        series(log2_series, (unsigned)(sizeof log2_series / sizeof log2_series[0]), t), t);
    if (exponent == 0) {
        *bits = 60;
        return part;
    }
    *bits = 54;
    return (int64_t)exponent * (INT64_C(1) << 54) + (part >> 6);
}

/* Returns value 2^exponent, rounded to nearest, ties to even; value in [0, 2^63). */
static float round_to_float(uint64_t value, int32_t exponent)
{
    if (value == 0)
        return 0.0f;
    int32_t drop = 63 - __builtin_clzll(value) - MANTISSA; /* leaves 24 bits */
    if (exponent + drop < 1 - BIAS - MANTISSA)
        drop = 1 - BIAS - MANTISSA - exponent; /* subnormal: its last bit is 2^-149 */
    if (drop > 62)
        return 0.0f;
    uint64_t kept = value;
    if (drop > 0) {
        uint64_t half = UINT64_C(1) << (drop - 1), rest = value & ((half << 1) - 1u);
        kept = value >> drop;
        if (rest > half || (rest == half && (kept & 1u) != 0))
            kept++;
    } else {
        kept = value << -drop;
    }
    /* A mantissa that rounds up to 2^24 raises the exponent by one by itself. */
    int32_t biased = exponent + drop + MANTISSA + BIAS;
    if (kept < HIDDEN_BIT)
        return float_of((uint32_t)kept);
    if (biased > 254)
        return INFINITY;
    return float_of((uint32_t)kept + ((uint32_t)(biased - 1) << MANTISSA));
}

/* Returns 2^(z 2^-40). */
static float exp2_of(int64_t z)
{
    int64_t n = (z + (INT64_C(1) << (Z_BITS - 1))) >> Z_BITS;
    int64_t t = z - n * (INT64_C(1) << Z_BITS);
    t = (t + (1 << (Z_BITS - 32))) >> (Z_BITS - 31); /* to units of 2^-31 */
    int64_t m =
        series(exp2_series, (unsigned)(sizeof exp2_series / sizeof exp2_series[0]), (int32_t)t);
    return round_to_float((uint64_t)m, (int32_t)n - 60);
}

/* Returns (mantissa 2^(exponent - 23)) (factor 2^-bits) as a z for exp2_of(), bounded by +-Z_LIMIT.
 * mantissa < 2^24, |factor| < 2^39. */
static int64_t exponent_of_two(uint32_t mantissa, int32_t exponent, int64_t factor, int32_t bits)
{
    const int64_t limit = (int64_t)Z_LIMIT * (INT64_C(1) << Z_BITS);
    int64_t product = (int64_t)mantissa * factor;
    int32_t shift = exponent - MANTISSA - bits + Z_BITS;
    if (shift <= 0)
        product = shift < -62 ? 0 : product >> -shift;
    else if (shift > 47 || product > (limit >> shift) || product < -(limit >> shift))
        product = product == 0 ? 0 : (product > 0 ? limit : -limit);
    else
        product *= INT64_C(1) << shift;
    return product > limit ? limit : (product < -limit ? -limit : product);
}

float float_exp(float x)
{
    if (x != x)
        return x;
    if (x > 90.0f)
        return INFINITY;
    if (x < -110.0f)
        return 0.0f;
    if (x == 0.0f)
        return 1.0f;
    int32_t exponent;
    uint32_t mantissa = split_float(x, &exponent);
    return exp2_of(exponent_of_two(mantissa, exponent, x < 0.0f ? -LOG2_E_Q38 : LOG2_E_Q38, 38));
}

float float_log(float x)
{
    if (x != x || x < 0.0f)
        return NAN;
    if (x == 0.0f)
        return -INFINITY;
    if (isinf(x))
        return x;
    int32_t bits;
    int64_t log2 = log2_of(x, &bits);
    uint64_t magnitude = (uint64_t)(log2 < 0 ? -log2 : log2);
    /* The product has 100 bits, so it is taken in parts of 32. */
    uint64_t high = magnitude >> 32, low = magnitude & UINT32_MAX;
    uint64_t ln_high = (uint64_t)LN_2_Q38 >> 32, ln_low = (uint64_t)LN_2_Q38 & UINT32_MAX;
    uint64_t sum = ((high * ln_high) << 26) + ((high * ln_low + low * ln_high) >> 6) +
                   ((low * ln_low) >> 38); /* units of 2^-bits */
    float y = round_to_float(sum, -bits);
    return log2 < 0 ? -y : y;
}

/* Returns 0 for a float that is no whole number, 1 for an odd one, 2 for an even one. */
static int parity(float y)
{
    int32_t exponent;
    uint32_t mantissa = split_float(y, &exponent);
    if (exponent > MANTISSA)
        return 2;
    if (exponent < 0)
        return 0;
    uint32_t unit = 1u << (MANTISSA - exponent);
    if ((mantissa & (unit - 1u)) != 0)
        return 0;
    return (mantissa & unit) != 0 ? 1 : 2;
}

float float_pow(float x, float y)
{
    if (x != x || y != y)
        return NAN;
    if (y == 0.0f || x == 1.0f)
        return 1.0f;
    bool infinite = isinf(y);
    int kind = infinite ? 2 : parity(y);
    float magnitude = fabsf(x);
    if (x < 0.0f && kind == 0)
        return NAN;
    float result;
    if (magnitude == 1.0f) {
        result = 1.0f;
    } else if (magnitude == 0.0f || isinf(magnitude) || infinite) {
        result = (magnitude < 1.0f) == (y < 0.0f) ? INFINITY : 0.0f;
    } else {
        int32_t bits, exponent;
        int64_t log2 = log2_of(magnitude, &bits);
        uint64_t size = (uint64_t)(log2 < 0 ? -log2 : log2);
        int32_t drop = 64 - __builtin_clzll(size) - 39;
        log2 = drop > 0 ? log2 >> drop : log2;
        uint32_t mantissa = split_float(y, &exponent);
        result = exp2_of(exponent_of_two(mantissa, exponent, y < 0.0f ? -log2 : log2,
                                         drop > 0 ? bits - drop : bits));
    }
    return x < 0.0f && kind == 1 ? -result : result;
}
