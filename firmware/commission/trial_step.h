/* A setpoint step of a trial (adoption.h): what is seen of it, and whether it went as predicted. Tick. */
#ifndef REFLUX_COMMISSION_TRIAL_STEP_H
#define REFLUX_COMMISSION_TRIAL_STEP_H

#include "commission/trial_records.h"
#include "supervise/supervisor.h"

struct swing_rule;
struct trial_step;

/* Counts a sample for loop k where its output is at a limit; the step was chosen so that none comes there. */
void trial_step_watch_output(struct trial_step *t, const struct supervisor *s, uint8_t k,
                             uint8_t output);
/* A sample of the step of *loop, whose iae and peak it counts. error: setpoint less measurement; ends: in the last quarter. */
void trial_step_sample(struct trial_step *t, struct adoption_loop *loop, real_t error, real_t h_s,
                       bool ends);
/* A sample of the way back. error and ends as above. */
void trial_step_rest(struct trial_step *t, real_t error, bool ends);
/* At the end of a step, there or back, with a raised gain: the mean error of its last quarter is half of the step, though the loop would
 * have settled with the accepted gain. step: of the setpoint, signed; left: that error by the prediction, in units of the step and in its
 * direction. */
bool trial_step_is_restless(const struct trial_step *t, const struct adoption_loop *loop,
                            const struct adoption_channel *channel, real_t step, real_t left);
/* A sample for the oscillation after a step, away or back; last: of the stage. */
void trial_step_swing(struct trial_step *t, const struct adoption_loop *loop,
                      const struct adoption_channel *channel, real_t error,
                      const struct swing_rule *rule, bool last);
/* The verdict on a step of `ticks` samples; ADOPTION_RUNNING: as predicted. loops: that may be blocked. */
enum adoption_result trial_step_verdict(const struct trial_step *t,
                                        const struct adoption_loop *loop,
                                        const struct adoption_channel *channel, uint8_t loops,
                                        uint32_t ticks, real_t h_s);

#endif
