/* Shared by the files of this layer. */
#ifndef REFLUX_IDENTIFY_COMMON_H
#define REFLUX_IDENTIFY_COMMON_H

#include "base/error.h"
#include "lti/fopdt.h" /* real_is_finite */
#include "num/real.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)
#define TWO  REAL_C(2.0)

#define VALUE_MAX REAL_C(1e12) /* of a sample: squares of it can be summed in float32 */

/* ERR_OK when lo <= x <= hi; NaN and infinity are ERR_NOT_FINITE. */
MUST_CHECK static inline enum err check_real(real_t x, real_t lo, real_t hi)
{
    if (!real_is_finite(x))
        return ERR_NOT_FINITE;
    return x < lo || x > hi ? ERR_RANGE : ERR_OK;
}

/* 1 - e^-x without cancellation, x >= 0. */
static inline real_t one_less_exp(real_t x)
{
    if (x > REAL_C(80.0))
        return ONE;
    if (x > REAL_C(0.25))
        return ONE - real_exp(-x);
    real_t sum = ONE;
    for (int n = 10; n > 1; n--) /* the next term is below 1e-14 */
        sum = ONE - x / (real_t)n * sum;
    return x * sum;
}

#endif
