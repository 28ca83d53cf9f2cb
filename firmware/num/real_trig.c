#include "num/real_trig.h"

#ifdef REFLUX_REAL_DOUBLE

void real_sincos(real_t x, real_t *sine, real_t *cosine)
{
    *sine = sin(x);
    *cosine = cos(x);
}

#else

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#define QUARTER_BITS  39
#define TWO_OVER_PI   UINT64_C(349985421095) /* 2/pi 2^39 */
#define HALF_PI       1.57079632679f
#define QUARTER_PI    0.78539816340f
#define LARGEST       1e6f
#define MANTISSA_BITS 23

/* Returns the whole quarter turns in |x|. *rest gets the rest, an angle within +-pi/4. x is from pi/4 to LARGEST. */
static uint32_t reduce(float x, float *rest)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    uint64_t mantissa = (bits & 0x7FFFFFu) | 0x800000u;
    unsigned exponent = (bits >> MANTISSA_BITS) - 127u + 1u; /* 0 for [0.5, 1) */
    uint64_t turns = mantissa * TWO_OVER_PI;                 /* below 2^63 */
    unsigned fraction = QUARTER_BITS + MANTISSA_BITS + 1u - exponent;
    uint64_t unit = UINT64_C(1) << fraction, whole = turns >> fraction;
    uint64_t left = turns & (unit - 1u);
    bool up = left >= unit / 2u;
    float part = (float)(up ? unit - left : left) / (float)unit * HALF_PI;
    *rest = up ? -part : part;
    whole += up ? 1u : 0u;
    return (uint32_t)whole;
}

void real_sincos(real_t x, real_t *sine, real_t *cosine)
{
    float size = fabsf(x);
    if (!(size <= LARGEST)) {
        *sine = *cosine = NAN;
        return;
    }
    float r = size;
    uint32_t quarters = size > QUARTER_PI ? reduce(size, &r) : 0u;
    /* Taylor series; the first term left out is below 2e-9. */
    float q = r * r;
    float s = r + r * q *
                      (-1.0f / 6.0f +
                       q * (1.0f / 120.0f + q * (-1.0f / 5040.0f + q * (1.0f / 362880.0f))));
    float c =
        1.0f +
        q * (-0.5f + q * (1.0f / 24.0f +
                          q * (-1.0f / 720.0f + q * (1.0f / 40320.0f - q * (1.0f / 3628800.0f)))));
    float sine_of = (quarters & 1u) != 0u ? c : s, cosine_of = (quarters & 1u) != 0u ? s : c;
    if ((quarters & 2u) != 0u)
        sine_of = -sine_of;
    if (((quarters + 1u) & 2u) != 0u)
        cosine_of = -cosine_of;
    *sine = x < 0.0f ? -sine_of : sine_of;
    *cosine = cosine_of;
}

#endif
