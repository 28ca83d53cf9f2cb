/* A feedforward element turns a measured disturbance into what is added to the output of a control loop. Kinds of feedforward blocks share it.
 *
 *     u_ff = limit( gain (lead s + 1)/(lag s + 1) exp(-dead_time s) (d - reference) )
 *
 * d and u_ff are fractions of the spans of their channels. The ideal element is -Gd/G, the disturbance's
 * path over the input's (Seborg, Edgar and Mellichamp, "Process Dynamics and Control", ch. on feedforward);
 * with first-order models lead is the time constant of G, lag that of Gd, dead time the difference of the
 * two where that is positive (docs/feedforward.md).
 */
#ifndef REFLUX_BLOCK_FEEDFORWARD_H
#define REFLUX_BLOCK_FEEDFORWARD_H

#include <stddef.h>

#include "base/error.h"
#include "block/settings.h"
#include "signal/dead_time.h"
#include "signal/lead_lag.h"

/* Gain 0, no dynamics, reference 0, limits -1..1. */
struct element_settings feedforward_default_config(void);

/* Checks settings for step interval h_s (s, [0.001, 1e5]). *field gets the parameter of ffN that is wrong, "" for the
 * interval, *wanted the range in words (either may be NULL). NaN and infinity are ERR_NOT_FINITE, all else ERR_RANGE. */
MUST_CHECK enum err feedforward_validate(const struct element_settings *config, float h_s,
                                         const char **field, const char **wanted);

struct feedforward {
    struct dead_time delay;
    struct lead_lag shape;
    struct coefficient gain;
    num_t reference, lo, hi;
    /* Output of the last step. */
    num_t output;
};

/* Bytes of ring (aligned for num_t) that feedforward_init will want; 0 if config is refused. */
size_t feedforward_bytes(const struct element_settings *config, float h_s);

/* Errors as feedforward_validate, and ERR_MEMORY when ring is NULL or too small; then *ff is unchanged.
 * The element is at rest at d = reference: call reset before step. */
MUST_CHECK enum err feedforward_init(struct feedforward *ff, const struct element_settings *config,
                                     float h_s, num_t *ring, size_t bytes);

/* Another gain, lead and lag; dead time, reference and what is under way stay. Errors as lead_lag_init(). */
MUST_CHECK enum err feedforward_retune(struct feedforward *ff,
                                       const struct element_settings *config, float h_s);

/* The ring stands here from now on. Returns the entry behind it. */
num_t *feedforward_place_ring(struct feedforward *ff, num_t *ring);

/* As if d had always been the disturbance: the next step with the same d gives the output at rest. */
void feedforward_reset(struct feedforward *ff, num_t d);

/* Returns u_ff for the disturbance d, within the limits. */
num_t feedforward_step(struct feedforward *ff, num_t d);

/* Returns u_ff of the last step. */
num_t feedforward_output(const struct feedforward *ff);

#endif
