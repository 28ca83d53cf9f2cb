/* Watches the loops of a kept set for a day or so after the trial, while the plant is operated: loops that the trial has kept may still be
 * too fast for the plant of the afternoon. It looks at each loop for four signs, and counts what the loop does:
 *
 *     past the limit   further from its setpoint than its limit in the tests
 *     oscillation      half cycles of the error that do not decay, SWINGS in a row, and larger than the noise
 *     output stuck     at a limit of the output without a break for longer than a setpoint step takes
 *     manual           more than a tenth of the watch, because a measurement is lost or an interlock holds the output
 *
 * A setpoint may be moved: its loop is looked at again when the step is over. Tick; *w is in the workspace. */
#ifndef REFLUX_COMMISSION_KEPT_WATCH_H
#define REFLUX_COMMISSION_KEPT_WATCH_H

#include "commission/adoption.h"

#define KEPT_WATCH_HOURS_MOST 1000u

struct kept_watch;

enum kept_sign {
    KEPT_FINE, /* nothing so far */
    KEPT_OVER, /* the watch is through, without a sign */
    KEPT_PAST_LIMIT,
    KEPT_SWINGS,
    KEPT_STUCK,
    KEPT_IN_MANUAL,
    KEPT_HAND /* a person has put a loop into another mode */
};

/* Begins to watch the loops of *a. length: of the watch, samples. */
void kept_watch_begin(struct kept_watch *w, const struct adoption *a, const struct supervisor *s,
                      uint32_t length);
/* A sample, after validate. Returns the first sign; *w then says which loop. */
enum kept_sign kept_watch_tick(struct kept_watch *w, const struct adoption *a,
                               const struct supervisor *s);
/* All setpoints are still near where the trial began: the outputs of that time would hold the plant there. */
bool kept_watch_is_near(const struct kept_watch *w, const struct adoption *a,
                        const struct supervisor *s);

/* Standard deviation of the error of loop k, fraction of span; 0 without samples. */
real_t kept_watch_sd(const struct kept_watch *w, uint8_t k);

#endif
