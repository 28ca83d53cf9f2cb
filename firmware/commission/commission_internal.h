/* What the files of commission.h share: channels.c, tests.c, by_relay.c, results.c, acceptance.c, and commission.c, which puts them
 * together. All of it runs in the tick. */
#ifndef REFLUX_COMMISSION_COMMISSION_INTERNAL_H
#define REFLUX_COMMISSION_COMMISSION_INTERNAL_H

#include "commission/commission_state.h"
#include "supervise/supervisor.h"

/* ---- commission.c ---- */

/* Somewhere between begin and the proposal: test signals may be on the outputs. */
bool commission_is_testing(const struct commission *c);
/* Takes the test signals away. */
void commission_release(struct commission *c, struct supervisor *s);
/* Ends it, or a trial, before its time; subject NULL: nobody's. */
void commission_end(struct commission *c, struct supervisor *s, enum commission_reason reason,
                    const char *subject, real_t value);

/* ---- channels.c ---- */

bool commission_input_is_tested(const struct supervisor *s, uint8_t j);
bool commission_measurement_is_tested(const struct supervisor *s, uint8_t i);
/* Where output j is held, fraction of span. */
real_t commission_test_base(const struct supervisor *s, uint8_t j);
/* Smaller of the ways from there to both operating limits, fraction of span. */
real_t commission_room(const struct supervisor *s, uint8_t j, real_t held);
/* Farthest that a measurement may go from rest, fraction of span. */
real_t commission_limit(const struct measurement_config *m);
/* Counts for how many samples in a row each tested measurement has read an end of its span; once a tick. */
void commission_watch_spans(struct commission *c, const struct supervisor *s);
/* A measurement that has done so for two samples, index in measurement[]; negative: none. */
int commission_at_end(const struct commission *c);
/* Anything that is not a test's to decide; REASON_NOT: nothing. */
enum commission_reason commission_disturbance(const struct commission *c,
                                              const struct supervisor *s, const char **subject);
/* What stands in the way of a trial, whether it has begun or not. */
enum commission_reason commission_hindrance(const struct commission *c, const struct supervisor *s,
                                            const char **subject);

/* ---- tests.c ---- */

void commission_begin(struct commission *c, struct supervisor *s);
/* The test of the input at c->at, from its start. */
void commission_start_input(struct commission *c, struct supervisor *s);
/* No half is longer, samples. */
uint32_t commission_longest(const struct supervisor *s);
/* Time that has gone by without a sample for the tests belongs to the operating point's age. */
void commission_age_origin(struct commission *c, const struct supervisor *s);
/* A tick of it. */
void commission_test(struct commission *c, struct supervisor *s);
/* The smallest step that a test was done again with because an output was not linear, fraction of span; 0: every output is
 * linear, as far as has been seen. */
real_t commission_small_step(const struct commission *c);
const char *commission_input_name(const struct commission *c, const struct supervisor *s);

/* Everything found before, and remembers what the tests belong to. */
void commission_forget(struct commission *c, const struct supervisor *s);

/* ---- by_relay.c ---- */

void commission_begin_relay(struct commission *c, struct supervisor *s);
/* From its start. */
void commission_start_relay(struct commission *c, struct supervisor *s);
/* A tick of it. */
void commission_relay(struct commission *c, struct supervisor *s);

/* ---- results.c ---- */

/* Is input[k] to be tested in this round? */
bool commission_is_due(const struct commission *c, uint8_t k);
/* The next input that is due, or the analysis. */
void commission_next_input(struct commission *c, struct supervisor *s);
/* A tick of waiting for a fit or for the analysis, and what comes of them. */
void commission_wait_for_job(struct commission *c, struct supervisor *s);
/* From now on the background may work; the result is taken after so many ticks. */
void commission_ask_for(struct commission *c, enum model_job job, uint32_t ticks);
/* So many base ticks. */
uint32_t commission_samples(const struct supervisor *s, real_t seconds);

/* ---- acceptance.c ---- */

void commission_begin_trial(struct commission *c, struct supervisor *s);
void commission_acceptance(struct commission *c, struct supervisor *s);
/* What is not for the adoption to judge. True: the trial is over. */
bool commission_acceptance_is_disturbed(struct commission *c, struct supervisor *s);
/* The loops go to manual and their outputs to where the trial found them; but what somebody has taken in hand stays
 * there. The main loop puts the old configuration into force. */
void commission_back_to_old(struct commission *c, struct supervisor *s,
                            enum commission_reason reason, const char *subject, real_t value);

/* The test of an input is made again, over all rounds, so often at most: */
#define LONGER_MOST   3u /* with longer halves, where an output did not come to rest */
#define SMALLER_MOST  1u /* with a smaller step, because an output is not linear */
#define GENTLER_TIMES 3u /* ... because the guard has cut it */

#define NOISE_FLOOR          REAL_C(7e-5) /* of span: what 12 bits of conversion leave */
#define MISSED_MOST          8u           /* samples in a row that a test can do without */
#define AMPLITUDE_FIRST      REAL_C(0.02) /* of span: the first step, where it is to be found */
#define AMPLITUDE_MOST       REAL_C(0.25) /* ... and the largest */
#define STEP_NEVER           REAL_C(1e-4) /* of span: smaller than this no step of a setpoint is made */
#define COMMISSION_HALF_MOST 1000u        /* samples, unless test.longest says otherwise */

/* When every response to input k is over but for a twentieth, s, as far as it is surely known. */
real_t commission_lasts(const struct commission *c, uint8_t k);

#endif
