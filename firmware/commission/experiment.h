/* One double step on one input, from rest to rest (Johansson 1994, "step response experiments"):
 *
 *     rest   until every output is at rest, against its own noise
 *     up     + amplitude, for a given time or until a first-order model of all data so far says that the response is
 *            over but for a twentieth, or until the guard sees an output on its way past its limit. An amplitude that is
 *            to be found grows in steps while the response does not stand out of the noise
 *     down   - amplitude, as long as the last level above
 *     back   0, until every output is at rest, so that the drift since before the step is known
 *
 * Everything is in fractions of span and in samples. No trajectory is stored but the bounded record; the model comes
 * from it and from the moments afterwards (docs/commissioning.md).
 */
#ifndef REFLUX_COMMISSION_EXPERIMENT_H
#define REFLUX_COMMISSION_EXPERIMENT_H

#include "commission/experiment_state.h"

/* ERR_RANGE, ERR_NOT_FINITE: of the config, *e then not to be used. */
MUST_CHECK enum err experiment_begin(struct experiment *e, const struct experiment_config *config);

/* One sample of every output, validated, fraction of span. Sets e->level, the test signal from now to the next sample.
 * Not to be called once DONE or FAILED. ERR_NOT_FINITE: nothing has changed. */
MUST_CHECK enum err experiment_step(struct experiment *e, const real_t *y);

/* The interim fit that experiment_step has begun (e->interim_fitting) is done: its models are used from the next sample on. */
void experiment_take_interim_fit(struct experiment *e);
/* A sample was lost on the way, before the one to come: the one before stands in for it, and nothing is decided, because
 * nothing could have been done. ERR_STATE before the first sample, and once DONE or FAILED. */
MUST_CHECK enum err experiment_missed(struct experiment *e);

/* What is known of output j apart from its response, once DONE: level, drift, noise; times from the first edge. */
MUST_CHECK enum err experiment_baseline(const struct experiment *e, uint8_t j, struct baseline *b);

/* ... before the step alone, where the drift after it is another. */
void experiment_baseline_before(const struct experiment *e, uint8_t j, struct baseline *b);

/* How much faster output j drifts after the step than before it, span per second, and the standard deviation of that;
 * 0 and 0 where it did not come to rest. */
real_t experiment_bend(const struct experiment *e, uint8_t j, real_t *sd);

#endif
