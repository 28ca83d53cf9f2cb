/* One double step on one input, from rest to rest (Johansson 1994, "step response experiments"):
 *
 *     rest   until every output is at rest, compared with its own noise
 *     up     + amplitude, for a given time, or until a first-order model of all data so far says that 95 % of the response is
 *            over, or until the guard predicts that an output will exceed its limit. An amplitude that is not given grows in
 *            steps while the response does not exceed the noise
 *     down   - amplitude, as long as the last level above
 *     back   0, until every output is at rest, so that the drift since before the step is known
 *
 * Everything is in fractions of span and in samples. Only the bounded record is stored, no trajectory; the model comes from it and
 * from the moments afterwards (docs/use/commission.md). Tick; experiment_baseline() and experiment_bend() in the main loop. */
#ifndef REFLUX_COMMISSION_EXPERIMENT_H
#define REFLUX_COMMISSION_EXPERIMENT_H

#include "commission/experiment_config.h"
#include "identify/identified.h"

struct experiment;

/* ERR_RANGE, ERR_NOT_FINITE: of the config, *e then not to be used. */
MUST_CHECK enum err experiment_begin(struct experiment *e, const struct experiment_config *config);

/* Takes one sample of every output, validated, fraction of span. Sets e->level, the test signal until the next sample.
 * Must not be called once DONE or FAILED. ERR_NOT_FINITE: nothing has changed. */
MUST_CHECK enum err experiment_step(struct experiment *e, const real_t *y);

/* Takes the result of the interim fit that experiment_step() has begun (e->interim_fitting): its models count from the next sample on. */
void experiment_take_interim_fit(struct experiment *e);
/* Stands in for a sample that was lost, with the one before; decides nothing, because no command could follow. ERR_STATE before the
 * first sample, and once DONE or FAILED. */
MUST_CHECK enum err experiment_missed(struct experiment *e);

/* The sensor of output j reads in steps of that share of its span (0: fine ones) and is renewed every `renewal` samples. */
void experiment_know_sensor(struct experiment *e, uint8_t j, real_t step, unsigned renewal);

/* Gives level, drift and noise of output j without its response, once DONE; times count from the first edge. */
MUST_CHECK enum err experiment_baseline(const struct experiment *e, uint8_t j, struct baseline *b);

/* Likewise from the rest before the step alone, where the drift after it differs. */
void experiment_baseline_before(const struct experiment *e, uint8_t j, struct baseline *b);

/* Returns the slope of output j after the step less that before it, span per second, and its standard deviation; 0 and 0 where it
 * did not come to rest. */
real_t experiment_bend(const struct experiment *e, uint8_t j, real_t *sd);

#endif
