/* Filtered derivative Td s/(Tf s + 1): what changes passes, what stays dies away.
 *
 * Backward Euler: d += Td/(Tf + h) (x - x') - h/(Tf + h) d. The state is wide: kept in num_t, the decay would
 * stop at h/(Tf + h) d < half a step of num_t and leave a false derivative for ever. It decays at full width too, so a
 * derivative beyond the range of num_t is forgotten as fast as any other.
 */
#ifndef REFLUX_SIGNAL_WASHOUT_H
#define REFLUX_SIGNAL_WASHOUT_H

#include "base/error.h"
#include "num/accumulator.h"

struct washout {
    struct accumulator d;
    struct coefficient gain;  /* scale * Td / (Tf + h) */
    struct coefficient decay; /* -h / (Tf + h) */
    num_t last_x;
};

/* scale multiplies the result, magnitude [0, 1e6]; Td, Tf [0, 1e6] s; h [0.001, 1e5] s. Output 0.
 * ERR_RANGE or ERR_NOT_FINITE leave *f unchanged. */
MUST_CHECK enum err washout_init(struct washout *f, float scale, float td_s, float tf_s, float h_s);

/* New numbers, output kept: it dies away with the new Tf. Ranges and errors as washout_init. */
MUST_CHECK enum err washout_retune(struct washout *f, float scale, float td_s, float tf_s,
                                   float h_s);

/* At rest with input x: output 0. */
void washout_reset(struct washout *f, num_t x);

num_t washout_step(struct washout *f, num_t x);

/* Output of the last step, saturating; whole, it is in d. */
num_t washout_value(const struct washout *f);

#endif
