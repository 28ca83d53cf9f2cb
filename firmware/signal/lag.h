/* First-order filter 1/(T s + 1).
 *
 * Backward Euler: y += h/(T + h) (x - y). Unconditionally stable, gain exactly 1 at rest, no libm; against
 * the exact sampled filter its time constant reads about h/2 long. The state is wide (num/accumulator.h), so
 * T = 10 h at a 0.05 s tick still arrives within one step of num_t.
 */
#ifndef REFLUX_SIGNAL_LAG_H
#define REFLUX_SIGNAL_LAG_H

#include <stdbool.h>

#include "base/error.h"
#include "num/accumulator.h"

struct lag {
    struct accumulator y;
    struct coefficient k; /* h / (T + h) */
    bool through;         /* T = 0: the output is the input, bit for bit */
};

/* Time constant [0, 1e6] s (0 passes the input through), step interval [0.001, 1e5] s. Output 0; call reset
 * for a start without a jump. ERR_RANGE or ERR_NOT_FINITE leave *f unchanged. */
MUST_CHECK enum err lag_init(struct lag *f, float time_constant_s, float h_s);

/* New time constant or interval, output kept. Ranges and errors as lag_init. */
MUST_CHECK enum err lag_retune(struct lag *f, float time_constant_s, float h_s);

/* At rest at value. */
void lag_reset(struct lag *f, num_t value);

/* A step where T is not 0. */
num_t lag_filter(struct lag *f, num_t x);
static inline num_t lag_step(struct lag *f, num_t x)
{
    if (!f->through)
        return lag_filter(f, x);
    accumulator_set(&f->y, x); /* 1 * (x - y) + y need not be x in floating point */
    return x;
}

#endif
