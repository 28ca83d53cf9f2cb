/* How far the outputs of a test may go, and whether they would: the guards of a step, and what ends it. Limits count from the
 * operating point (origin.h): what earlier tests have left comes off them on both sides. */
#ifndef REFLUX_COMMISSION_LIMITS_H
#define REFLUX_COMMISSION_LIMITS_H

#include "commission/experiment_state.h"

/* Of output j, fraction of span: its limit less what earlier tests have left; 0 at least. */
real_t limits_room(const struct experiment *e, uint8_t j);
/* How far output j is from its rest, fraction of span; y: the latest sample of every output. */
real_t limits_away(const struct experiment *e, uint8_t j, const real_t *y);
/* An output that is too far from the operating point for another test; negative: none. */
int limits_spent(const struct experiment *e);

/* The line guard from the level of each output now, after an edge. ERR_RANGE, ERR_NOT_FINITE. */
MUST_CHECK enum err limits_arm(struct experiment *e, const real_t *y);
/* Keeps what the response has been in the positive half; two samples have to agree. */
void limits_watch(struct experiment *e, const real_t *y);
/* Farthest that output j would go in both halves of a double step of amplitude 1, by what it has done so far and an end at
 * `gain`, span per span, magnitude. What goes the wrong way first, or overshoots, does so twice as far at the reversal. */
real_t limits_reach(const struct experiment *e, uint8_t j, real_t gain);

enum limits_verdict {
    LIMITS_FINE,
    LIMITS_TURN, /* now, or an output would go past its limit */
    LIMITS_BACK  /* to no step at all: the reversal would take one past its limit */
};

/* In the positive half. e->culprit and e->predicted are set unless it is fine. */
MUST_CHECK enum err limits_judge(struct experiment *e, const real_t *y,
                                 enum limits_verdict *verdict);
/* In the negative half: is an output near its limit, what is under way in dead time included? */
bool limits_far_enough(const struct experiment *e, const real_t *y);
/* Before the step, once there is an operating point: an output that has left it for two samples, as far as its limit.
 * Negative: none. */
int limits_strayed(struct experiment *e, const real_t *y);
/* An output that has been past its limit for two samples; negative: none. */
int limits_past(struct experiment *e, const real_t *y);

#endif
