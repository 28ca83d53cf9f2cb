/* Feedforward element: what a measured disturbance calls for, added to the output of a control loop.
 *
 *     u_ff = limit( gain (lead s + 1)/(lag s + 1) exp(-dead_time s) (d - reference) )
 *
 * d and u_ff are fractions of the spans of their channels. The ideal element is -Gd/G, the disturbance's
 * path over the input's (Seborg, Edgar and Mellichamp, "Process Dynamics and Control", ch. on feedforward);
 * with first-order models lead is the time constant of G, lag that of Gd, dead time the difference of the
 * two where that is positive (docs/feedforward.md).
 */
#ifndef REFLUX_FEEDFORWARD_FEEDFORWARD_H
#define REFLUX_FEEDFORWARD_FEEDFORWARD_H

#include <stddef.h>

#include "block/block.h"
#include "signal/dead_time.h"
#include "signal/lead_lag.h"

/* Gain 0, no dynamics, reference 0, limits -1..1. */
struct element_settings feedforward_default_config(void);

/* First field that is wrong for step interval h_s (s, [0.001, 1e5]), or ERR_OK. *field gets its name, *wanted
 * the range in words (either may be NULL). NaN and infinity are ERR_NOT_FINITE, all else ERR_RANGE. */
MUST_CHECK enum err feedforward_validate(const struct element_settings *config, float h_s,
                                         const char **field, const char **wanted);

struct feedforward {
    struct dead_time delay;
    struct lead_lag shape;
    struct coefficient gain;
    num_t reference, lo, hi;
    num_t output; /* of the last step */
};

/* Bytes of ring (aligned for num_t) that feedforward_init will want; 0 if config is refused. */
size_t feedforward_bytes(const struct element_settings *config, float h_s);

/* Errors as feedforward_validate, and ERR_MEMORY when ring is NULL or too small; then *ff is unchanged.
 * The element is at rest at d = reference: call reset before step. */
MUST_CHECK enum err feedforward_init(struct feedforward *ff, const struct element_settings *config,
                                     float h_s, num_t *ring, size_t bytes);

/* As if d had always been the disturbance: the next step with the same d gives the output at rest. */
void feedforward_reset(struct feedforward *ff, num_t d);

/* u_ff for the disturbance d, within the limits. */
num_t feedforward_step(struct feedforward *ff, num_t d);

/* An element that adds to an MV: settings are a struct element_settings, one member, whose `in` is the disturbance. */
extern const struct block_kind feedforward_kind;

#endif
