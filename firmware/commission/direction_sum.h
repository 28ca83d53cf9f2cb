/* Responses of the outputs along a direction (direction.h), by the single tests and by the record of the direction's own test.
 *
 * In a direction the lags of the inputs nearly cancel. What remains begins like a pulse, and a fit of its shape leaves the end wide
 * open. The single tests tell when every response is over, so the end is the mean of the points after that time, less the small part
 * that the model says is still to come. Such a mean is the surer the longer it lasts. Main loop; direction_response(),
 * direction_end() and direction_over_s() run in the tick, too. */
#ifndef REFLUX_COMMISSION_DIRECTION_SUM_H
#define REFLUX_COMMISSION_DIRECTION_SUM_H

#include <stdbool.h>
#include <stdint.h>

#include "num/real.h"

#define DIRECTION_LAGS REAL_C(5.0) /* after which a lag leaves 0.7 % */

struct commission;

/* Response of output j to a level of 1 in the direction after t_s, and its end, in fractions of span. By the single tests. */
real_t direction_response(const struct commission *c, uint8_t j, real_t t_s);
real_t direction_end(const struct commission *c, uint8_t j);
/* Dead time plus the given number of lags of the slowest element of output j that the direction uses, s. */
real_t direction_over_s(const struct commission *c, uint8_t j, real_t lags);

/* Finds the gain of output j along the direction from the record of the latest test. False: the test ended before the responses were
 * over. This is a long piece of work, because every point of the record takes the responses of all inputs. */
bool direction_plateau(const struct commission *c, uint8_t j, real_t *gain);
/* Finds the standard deviation of that gain in a second piece of work as long as the first. The record must not have changed
 * meanwhile. False: the deviation is not finite. */
bool direction_plateau_sd(const struct commission *c, uint8_t j, real_t gain, real_t *sd);

#endif
