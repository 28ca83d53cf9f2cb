/* Does an oscillation decay? Half cycles of an error, by its integral: that turns where the error changes its sign, and from one
 * turn to the next it moves by the area of a half cycle. Noise, which peaks are full of, hardly shows in areas; of a damped
 * oscillation areas decay as its peaks do, by exp(-pi zeta / sqrt(1 - zeta^2)). The way to the setpoint counts as the first.
 * A half cycle is not smaller where its area and its mean height both are not. What lasts more than twice as long as the half
 * cycle before is a slow tail, which may have any area. */
#ifndef REFLUX_COMMISSION_SWING_H
#define REFLUX_COMMISSION_SWING_H

#include <stdbool.h>
#include <stdint.h>

#include "num/real.h"

#define SWING_DECAY REAL_C(0.7) /* times the half cycle before, at most: a damping of 0.11 */

struct swing;

/* A sample. noise_sd: of the error; constant: what of it may be there all the time without being a swing (a drift nobody
 * foresaw), magnitude. What these two may add to an area is left out of the account. */
void swing_step(struct swing *w, real_t error, real_t noise_sd, real_t constant);
/* After the last sample: the half cycle that has not ended counts as far as it has come. */
void swing_end(struct swing *w, real_t noise_sd, real_t constant);

#endif
