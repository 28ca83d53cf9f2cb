/* An accepted set of loops on trial, on the plant: every loop's setpoint is stepped once, and what it does is held against
 * what was predicted.
 *
 *     rest -> settle -> step -> return -> step (next loop) ... -> passed
 *       ^                |                                            of a plant that stays where it is
 *       |                +-> rest -> settle -> step (next loop) ... -> passed
 *       +--- not as predicted: was it the plant?                      of one that drifts
 *
 * At rest the outputs are held in manual and a line is fitted to every measurement. A drift that is significant is taken off
 * as in the tests: the setpoints go with it, and limits count from its line or from where it began, whichever is nearer; what the tests have left comes off them. No
 * controller can hold a measurement that goes on drifting for ever on the room of its output; and an ill-conditioned plant
 * needs all of it soon. */
#ifndef REFLUX_COMMISSION_ADOPTION_H
#define REFLUX_COMMISSION_ADOPTION_H

#include "commission/origin.h"
#include "commission/trial_records.h"
#include "identify/steady.h"
#include "supervise/supervisor.h"

struct adoption;

/* Makes it ready, in the main loop: no loops yet; window: samples over which rest is judged; back: samples that a response takes to
 * be over. The channels follow in the order of the loops, then those that no loop holds; then loop by loop, the inner ones last. */
void adoption_prepare(struct adoption *a, uint32_t window, uint32_t back);
/* As far as `limit`. */
void adoption_add_channel(struct adoption *a, const struct adoption_channel *channel);
/* As far as `size`. ERR_FULL: there is no place. */
MUST_CHECK enum err adoption_add_loop(struct adoption *a, const struct adoption_loop *loop,
                                      bool inner);

/* Remembers where the outputs are. */
void adoption_hold(struct adoption *a, const struct supervisor *s);
/* The trial begins; *origin, the operating point, and *work must live as long. The loops are in manual and stay there until the
 * lines of rest are known. ERR_RANGE: channels or window. */
MUST_CHECK enum err adoption_begin(struct adoption *a, const struct supervisor *s,
                                   struct origin *origin, struct steady *work);
/* A tick of it, after validate and before control. */
enum adoption_result adoption_tick(struct adoption *a, struct supervisor *s);
/* The loops go to manual, their outputs to where the trial found them. but_hand: those that somebody has taken to manual
 * stay as they are. */
void adoption_put_back(const struct adoption *a, struct supervisor *s, bool but_hand);

/* Name of the loop, or of the measurement without a loop, for which the trial failed; *peak: overshoot of that loop, or 0. */
const char *adoption_culprit(const struct adoption *a, const struct config *config, real_t *peak);

#endif
