/* Finds out whether an oscillation decays, by the areas of the half cycles of an error. The integral of the error turns where the
 * error changes its sign, and between two turns it moves by the area of a half cycle. Areas hardly show noise, peaks do; both decay by
 * exp(-pi zeta / sqrt(1 - zeta^2)). The way to the setpoint counts as the first half cycle. A half cycle is smaller where its area or
 * its mean height is smaller. Two in a row must not be smaller before it counts as an oscillation, because another loop may make one of
 * them larger. One that lasts more than twice as long as the one before is a slow tail and may have any area. Tick. */
#ifndef REFLUX_COMMISSION_SWING_H
#define REFLUX_COMMISSION_SWING_H

#include <stdbool.h>
#include <stdint.h>

#include "num/real.h"

/* Condition under which two half cycles decay. */
struct swing_rule {
    real_t decay; /* largest ratio of the second to the first */
    real_t sds;   /* standard deviations of the noise in both areas that do not count */
};
extern const struct swing_rule swing_accepted; /* with the gain of the settings */
extern const struct swing_rule swing_raised;   /* with a raised gain */

struct swing;

/* Takes a sample. noise_sd: of the error; constant: part of the error that may be constant, such as an unforeseen drift, magnitude.
 * The area that these two can explain does not count. */
void swing_step(struct swing *w, real_t error, const struct swing_rule *rule, real_t noise_sd,
                real_t constant);
/* After the last sample: the half cycle that has not ended counts as far as it has come. */
void swing_end(struct swing *w, const struct swing_rule *rule, real_t noise_sd, real_t constant);

#endif
