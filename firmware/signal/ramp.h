/* Rate limiter: follows its target, but never faster than a rate.
 *
 * The position is wide, so a rate of 1e-6 of span per second moves at a 0.05 s tick too, where one step is
 * less than one step of num_t. It arrives exactly and never overshoots.
 */
#ifndef REFLUX_SIGNAL_RAMP_H
#define REFLUX_SIGNAL_RAMP_H

#include <stdbool.h>

#include "base/error.h"
#include "num/accumulator.h"

struct ramp {
    struct accumulator position;
    struct coefficient step; /* rate * h */
    num_t reach;             /* the same as num_t: a target this near is taken at once */
    bool jump;               /* no limit */
};

/* Rate per second: 0 = no limit, else [1e-9, 1e6]; rate * h above 100 counts as no limit. h [0.001, 1e5] s.
 * Position 0; call reset to start elsewhere. ERR_RANGE or ERR_NOT_FINITE leave *f unchanged. */
MUST_CHECK enum err ramp_init(struct ramp *f, float rate_per_s, float h_s);

/* New rate or interval, position kept. Ranges and errors as ramp_init. */
MUST_CHECK enum err ramp_retune(struct ramp *f, float rate_per_s, float h_s);

/* The position is value, at once. */
void ramp_reset(struct ramp *f, num_t value);

/* Returns the position. */
static inline num_t ramp_position(const struct ramp *f)
{
    return accumulator_get(&f->position);
}

/* A step where there is a limit. */
num_t ramp_limit(struct ramp *f, num_t target);
static inline num_t ramp_step(struct ramp *f, num_t target)
{
    if (!f->jump)
        return ramp_limit(f, target);
    accumulator_set(&f->position, target);
    return target;
}

#endif
