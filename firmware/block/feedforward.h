/* A feedforward element computes from a measured disturbance what is added to the output of a control loop. Several
 * kinds of feedforward blocks share it.
 *
 *     u_ff = limit( gain (lead s + 1)/(lag s + 1) exp(-dead_time s) (d - reference) )
 *
 * d and u_ff are fractions of the spans of their channels. The ideal element is -Gd/G: the path of the disturbance
 * divided by the path of the input (Seborg, Edgar and Mellichamp, "Process Dynamics and Control", ch. on
 * feedforward). With first-order models, lead is the time constant of G, lag is that of Gd, and the dead time is
 * that of Gd less that of G where this is positive (docs/methods/feedforward.md). */
#ifndef REFLUX_BLOCK_FEEDFORWARD_H
#define REFLUX_BLOCK_FEEDFORWARD_H

#include <stddef.h>

#include "base/error.h"
#include "block/settings.h"
#include "signal/dead_time.h"
#include "signal/lead_lag.h"

/* Returns settings with gain 0, no dynamics, reference 0 and limits -1..1. */
struct feedforward_settings feedforward_default_config(void);

/* Checks settings for the step interval h_s (s, [0.001, 1e5]). *field gets the name of the wrong parameter of ffN,
 * or "" for the interval; *wanted gets the range in words. Either may be NULL. NaN and infinity are ERR_NOT_FINITE,
 * all else is ERR_RANGE. */
MUST_CHECK enum err feedforward_validate(const struct feedforward_settings *config, float h_s,
                                         const char **field, const char **wanted);

struct feedforward {
    struct dead_time delay;
    struct lead_lag shape;
    struct coefficient gain;
    num_t reference, lo, hi;
    /* Output of the last step. */
    num_t output;
};

/* Returns the bytes of ring (aligned for num_t) that feedforward_init needs; 0 if it refuses config. */
size_t feedforward_bytes(const struct feedforward_settings *config, float h_s);

/* Returns the errors of feedforward_validate, and ERR_MEMORY if ring is NULL or too small; on an error *ff is
 * unchanged. The element is then at rest at d = reference. For another d, call reset before step. */
MUST_CHECK enum err feedforward_init(struct feedforward *ff,
                                     const struct feedforward_settings *config, float h_s,
                                     num_t *ring, size_t bytes);

/* Sets another gain, lead and lag; dead time, reference and transients stay. Returns the errors of lead_lag_init(). */
MUST_CHECK enum err feedforward_retune(struct feedforward *ff,
                                       const struct feedforward_settings *config, float h_s);

/* Sets the new address of the ring. Returns the first entry behind it. */
num_t *feedforward_place_ring(struct feedforward *ff, num_t *ring);

/* Sets the state as if d had always been the disturbance: the next step with the same d gives the output at rest. */
void feedforward_reset(struct feedforward *ff, num_t d);

/* Returns u_ff for the disturbance d, within the limits. */
num_t feedforward_step(struct feedforward *ff, num_t d);

/* Returns u_ff of the last step. */
num_t feedforward_output(const struct feedforward *ff);

#endif
