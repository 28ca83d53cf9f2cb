/* Arithmetic of scaled_t without calls, for the inner loops of num/ud_scaled.c. num/scaled.c has the same as functions. */
#ifndef REFLUX_NUM_SCALED_INLINE_H
#define REFLUX_NUM_SCALED_INLINE_H

#include "num/scaled_type.h"

#ifdef REFLUX_FIXED_POINT

/* Returns (a * b) / 2^32, to the nearest. It is one instruction on Cortex-M4. */
static inline int32_t inline_high(int32_t a, int32_t b)
{
    return (int32_t)(((int64_t)a * b + ((int64_t)1 << 31)) >> 32);
}

/* Returns m * 2^e with a mantissa that fits. */
static inline scaled_t inline_normal(int32_t m, int32_t e)
{
    if (m == 0)
        return (scaled_t){0, 0};
    uint32_t size = m < 0 ? 0u - (uint32_t)m : (uint32_t)m; /* right for INT32_MIN, too */
    int32_t left = __builtin_clz(size) - 2;
    if (left < 0)
        return (scaled_t){m >> 1, e + 1};
    return (scaled_t){(int32_t)((uint32_t)m << left), e - left};
}

static inline scaled_t inline_add(scaled_t a, scaled_t b)
{
    if (a.m == 0)
        return b;
    if (b.m == 0)
        return a;
    int32_t apart = a.e - b.e;
    if (apart >= 0)
        return apart > 30 ? a : inline_normal(a.m + (b.m >> apart), a.e);
    return apart < -30 ? b : inline_normal(b.m + (a.m >> -apart), b.e);
}

/* Returns a * b. The product of two full mantissas has 59 or 60 bits, so its upper word tells the shift. */
static inline scaled_t inline_mul(scaled_t a, scaled_t b)
{
    int64_t product = (int64_t)a.m * b.m;
    uint32_t high = (uint32_t)(product >> 32), low = (uint32_t)product;
    if ((high ^ (uint32_t)((int32_t)high >> 31)) < 1u << 27)
        return (scaled_t){(int32_t)(high << 3 | low >> 29), a.e + b.e + 29};
    return (scaled_t){(int32_t)(high << 2 | low >> 30), a.e + b.e + 30};
}

/* Returns 1/b, b not 0, by Newton's step from the quotient of the processor's division. */
static inline scaled_t inline_inverse(scaled_t b)
{
    int32_t m = b.m < 0 ? -b.m : b.m;
    int32_t rough = (int32_t)(0x7FFFFFFFu / (uint32_t)(m >> 15)) * (1 << 13); /* 2^59/m, to 2^-14 */
    int32_t lacking = (int32_t)((((int64_t)1 << 59) - (int64_t)m * rough) >> 28);
    int32_t r = rough + (int32_t)(((int64_t)rough * lacking) >> 31);
    r = r < 1 << 30 ? r : (1 << 30) - 1;
    return (scaled_t){b.m < 0 ? -r : r, -59 - b.e};
}

#endif
#endif
