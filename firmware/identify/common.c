#include "identify/common.h"

#include "lti/fopdt.h" /* real_is_finite */

enum err check_real(real_t x, real_t lo, real_t hi)
{
    if (!real_is_finite(x))
        return ERR_NOT_FINITE;
    return x < lo || x > hi ? ERR_RANGE : ERR_OK;
}

real_t one_less_exp(real_t x)
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
