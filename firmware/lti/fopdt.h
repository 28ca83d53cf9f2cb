/* First-order-plus-dead-time model: gain exp(-dead_time s) / (time_constant s + 1). */
#ifndef REFLUX_LTI_FOPDT_H
#define REFLUX_LTI_FOPDT_H

#include <stddef.h>

#include "base/error.h"
#include "num/real.h"

struct fopdt {
    real_t gain;            /* output span per input span, either sign */
    real_t dead_time_s;     /* s, [0, 1e6] */
    real_t time_constant_s; /* s, (0, 1e6] */
};

/* Finite test for real_t without libm: the difference of an infinity or a NaN with itself is not 0. */
static inline int real_is_finite(real_t x)
{
    return x - x <= REAL_C(0.0);
}

/* First field that is wrong, or ERR_OK; *field gets its name, *wanted the range in words (either may be
 * NULL). NaN and infinity are ERR_NOT_FINITE, anything else ERR_RANGE. A gain of 0 is a model. */
MUST_CHECK static inline enum err fopdt_validate(const struct fopdt *m, const char **field,
                                                 const char **wanted)
{
    const char *unused;
    field = field ? field : &unused;
    wanted = wanted ? wanted : &unused;
    *field = "gain";
    *wanted = "a finite number";
    if (!real_is_finite(m->gain))
        return ERR_NOT_FINITE;
    *field = "dead_time_s";
    *wanted = "0 to 1e6 s";
    if (!real_is_finite(m->dead_time_s))
        return ERR_NOT_FINITE;
    if (m->dead_time_s < REAL_C(0.0) || m->dead_time_s > REAL_C(1e6))
        return ERR_RANGE;
    *field = "time_constant_s";
    *wanted = "above 0, to 1e6 s";
    if (!real_is_finite(m->time_constant_s))
        return ERR_NOT_FINITE;
    if (m->time_constant_s <= REAL_C(0.0) || m->time_constant_s > REAL_C(1e6))
        return ERR_RANGE;
    return ERR_OK;
}

#endif
