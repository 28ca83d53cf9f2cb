/* The limits of a test: the guards that end a step before an output exceeds its limit. Limits count from the operating point
 * (origin.h): deviations that earlier tests have left reduce them on both sides. Tick. */
#ifndef REFLUX_COMMISSION_LIMITS_H
#define REFLUX_COMMISSION_LIMITS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "num/real.h"

struct experiment;

/* Limit of output j less the deviation that earlier tests have left, fraction of span; 0 at least. */
real_t limits_room(const struct experiment *e, uint8_t j);
/* Distance of output j from its rest, fraction of span; y: the latest sample of every output. */
real_t limits_away(const struct experiment *e, uint8_t j, const real_t *y);
/* Returns an output that is too far from the operating point for another test; negative: none. */
int limits_spent(const struct experiment *e);

/* Starts the line guard from the present level of each output, after an edge. ERR_RANGE, ERR_NOT_FINITE. */
MUST_CHECK enum err limits_arm(struct experiment *e, const real_t *y);
/* Keeps the extremes of the response in the positive half; two samples have to agree. */
void limits_watch(struct experiment *e, const real_t *y);
/* First amplitude. Where no gain is known it is small beside the limits; where noise hides the response it grows. */
real_t limits_first_step(const struct experiment *e);
/* The amplitude grows. What the outputs do from now on is the response to the difference. Under a drift it stays the response to
 * the whole step, and the extremes of the smaller one, which are mostly drift, stay what they are in fractions of span. */
void limits_step_grows(struct experiment *e, const real_t *y, real_t larger);
/* Largest deviation of output j in both halves of a double step of amplitude 1, by its response so far and an end at `gain`, span
 * per span, magnitude. An inverse response or an overshoot is twice as large at the reversal. */
real_t limits_reach(const struct experiment *e, uint8_t j, real_t gain);

enum limits_verdict {
    LIMITS_FINE,
    LIMITS_TURN, /* the step must turn now, or an output would exceed its limit */
    LIMITS_BACK /* the step must end without a reversal, which would take an output past its limit */
};

/* A predicted peak, fraction of span, and its output. */
struct limits_peak {
    real_t predicted;
    uint8_t output;
};

/* Lets the line guard see a sample without a judgement. */
MUST_CHECK enum err limits_see(struct experiment *e, const real_t *y);
/* Every output that responds has shown its response but for a tenth, by the latest models: what a reversal does is known. */
bool limits_response_is_seen(const struct experiment *e);
/* Judges the positive half; sets *peak unless it is fine. */
MUST_CHECK enum err limits_judge(struct experiment *e, const real_t *y,
                                 enum limits_verdict *verdict, struct limits_peak *peak);
/* An output is near its limit in the negative half, including the response that dead time still hides. */
bool limits_far_enough(const struct experiment *e, const real_t *y);
/* Returns an output that has been as far from the operating point as its limit for two samples before the step; negative: none. */
int limits_strayed(struct experiment *e, const real_t *y);
/* Returns an output that has been past its limit for two samples; negative: none. */
int limits_past(struct experiment *e, const real_t *y);

#endif
