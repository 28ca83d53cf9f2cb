/* What the outputs answer along a direction (direction.h), by the single tests and by the record of its own test.
 *
 * The lags of the inputs nearly cancel in a direction: what is left begins like a pulse, and a fit of its shape leaves the end wide
 * open. The single tests know when everything is over, so the end is read from the points after that, less the little that the model
 * says is still to come: a mean of noise, and as sure as it is long. Main loop; direction_response(), direction_end() and
 * direction_over_s() in the tick, too. */
#ifndef REFLUX_COMMISSION_DIRECTION_SUM_H
#define REFLUX_COMMISSION_DIRECTION_SUM_H

#include <stdbool.h>
#include <stdint.h>

#include "num/real.h"

#define DIRECTION_LAGS REAL_C(5.0) /* after which a lag leaves 0.7 % */

struct commission;

/* Response of output j, span, to a level of 1 in the direction, after t_s; its end. By the single tests. */
real_t direction_response(const struct commission *c, uint8_t j, real_t t_s);
real_t direction_end(const struct commission *c, uint8_t j);
/* Dead time and so many lags of the slowest element of output j that the direction uses, s. */
real_t direction_over_s(const struct commission *c, uint8_t j, real_t lags);

/* Gain of output j along the direction, from the record of the latest test. False: the test did not last so long. A long piece of
 * work: every point of the record takes the responses of all inputs. */
bool direction_plateau(const struct commission *c, uint8_t j, real_t *gain);
/* Its standard deviation, as long a piece; the record must still be the same. False: it is not finite. */
bool direction_plateau_sd(const struct commission *c, uint8_t j, real_t gain, real_t *sd);

#endif
