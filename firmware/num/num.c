/* Conversion to the fixed-point scalar; the other operations are inline. */
#include "num/num.h"

#ifdef REFLUX_FIXED_POINT

#define EXPONENT_OF_ONE  127u /* as a float stores it */
#define SIGNIFICAND_BITS 23

/* Converts from the bits, because without a floating-point unit each operation on floats is a call of a library. */
num_t num_from_float(float x)
{
    const union {
        float f;
        uint32_t u;
    } bits = {.f = x};
    uint32_t exponent = bits.u >> SIGNIFICAND_BITS & 0xFFu;
    uint32_t fraction = bits.u & ((1u << SIGNIFICAND_BITS) - 1u);
    bool negative = bits.u >> 31 != 0u;
    if (exponent >= EXPONENT_OF_ONE + 7u) { /* 128 and above; NaN has exponent 255 */
        bool nan = exponent == 0xFFu && fraction != 0u;
        return (num_t){nan ? 0 : negative ? INT32_MIN : INT32_MAX};
    }
    /* x is the significand times 2^left, in steps of num_t. */
    int32_t left =
        (int32_t)exponent - (int32_t)EXPONENT_OF_ONE - SIGNIFICAND_BITS + NUM_FRACTION_BITS;
    int32_t q = (int32_t)(fraction | 1u << SIGNIFICAND_BITS);
    if (left >= 0)
        q <<= left;
    else if (left >= -(SIGNIFICAND_BITS + 1))
        q = (q + (1 << (-left - 1))) >> -left;
    else
        q = 0; /* below half a step, as denormal numbers are */
    return (num_t){negative ? -q : q};
}

#endif
