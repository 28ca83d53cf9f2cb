/* The trial of accepted loops on the plant: every loop's setpoint is stepped once, and the response is compared with the prediction.
 * Tick; what prepares it runs in the main loop.
 *
 *     rest -> settle -> step -> return -> step (next loop) ... -> passed
 *       ^                |                                            a plant without drift
 *       |                +-> rest -> settle -> step (next loop) ... -> passed
 *       +--- not as predicted: was it the plant?                      a plant that drifts
 *
 * At rest the outputs are held in manual and a line is fitted to every measurement. A significant drift is taken off as in the tests:
 * the setpoints follow it, and limits count from its line or from its beginning, whichever is nearer, less the deviation that the tests
 * have left. The outputs rest between the steps because no controller can hold a drifting measurement for ever: its output has limited
 * room, and an ill-conditioned plant soon needs all of it. */
#ifndef REFLUX_COMMISSION_ADOPTION_H
#define REFLUX_COMMISSION_ADOPTION_H

#include "commission/origin.h"
#include "commission/trial_records.h"
#include "identify/steady.h"
#include "supervise/supervisor.h"

struct adoption;

/* Makes it ready, without loops. window: samples over which rest is judged; back: samples until a response is over. Next come the
 * channels in the order of the loops, then those without a loop, then the loops, the inner ones last. */
void adoption_prepare(struct adoption *a, uint32_t window, uint32_t back);
/* The channel is filled in up to `limit`. */
void adoption_add_channel(struct adoption *a, const struct adoption_channel *channel);
/* The loop is filled in up to `size`. ERR_FULL: there is no place. */
MUST_CHECK enum err adoption_add_loop(struct adoption *a, const struct adoption_loop *loop,
                                      bool inner);

/* Remembers the present outputs. */
void adoption_hold(struct adoption *a, const struct supervisor *s);
/* The trial begins; *origin, the operating point, and *work must live as long. The loops are in manual and stay there until the
 * lines of rest are known. ERR_RANGE: channels or window. */
MUST_CHECK enum err adoption_begin(struct adoption *a, const struct supervisor *s,
                                   struct origin *origin, struct steady *work);
/* A tick of it, after validate and before control. */
enum adoption_result adoption_tick(struct adoption *a, struct supervisor *s);
/* Puts the loops into manual and their outputs back to where the trial found them. but_hand: loops that somebody has put into manual
 * stay as they are. */
void adoption_put_back(const struct adoption *a, struct supervisor *s, bool but_hand);

/* Name of the loop, or of the measurement without a loop, for which the trial failed; *peak: overshoot of that loop, or 0. */
const char *adoption_culprit(const struct adoption *a, const struct config *config, real_t *peak);

#endif
