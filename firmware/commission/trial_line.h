/* The line that a measurement follows at rest before the steps of a trial. A plant that drifts goes on along it, whatever the loops do.
 * Levels are fractions of span, slopes span per second. Tick. */
#ifndef REFLUX_COMMISSION_TRIAL_LINE_H
#define REFLUX_COMMISSION_TRIAL_LINE_H

#include <stdbool.h>

#include "num/real.h"

struct steady_result;
struct trial_line;

/* Takes the line of a rest that ends now. It drifts where that is significant and a twentieth of the smallest step in the time of the
 * longest, s. */
void trial_line_take(struct trial_line *l, const struct steady_result *now, real_t longest_s,
                     real_t smallest_step);
/* At the end of another rest, age_s after the first: the plant has left its line, or climbs differently, by a tenth of a step of
 * lasts_s and beyond what the deviations explain. The loops did not cause that. */
bool trial_line_has_bent(const struct trial_line *l, const struct steady_result *now, real_t age_s,
                         real_t step, real_t lasts_s);
/* Distance by which the drift has carried the measurement in age_s, at most `most` either way. */
real_t trial_line_carried(const struct trial_line *l, real_t age_s, real_t most);
/* Part of a slope that the line has not foreseen, magnitude: twice its deviation, and all of it where it is no drift. */
real_t trial_line_unforeseen(const struct trial_line *l);

#endif
