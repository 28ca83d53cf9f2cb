/* Gains that were also measured along one direction of the inputs: all of them moved together, input k by share_k. Such a test
 * says what the sum of share_k gain_jk is, far better than the gains themselves do, because their errors add up in it.
 *
 * With D the variances s_k^2 of the gains of row j before it (the relative floor included), P the sum of share_k^2 s_k^2, and r
 * the error of the measured sum, the gains of the row are then those of a normal law with the condition (Anderson, An Introduction
 * to Multivariate Statistical Analysis, 3rd ed., 2003, 2.5):
 *     mean        g_k + share_k s_k^2/(P + r^2) (measured - sum of share_l g_l)
 *     covariance  D - q q',  q_k = share_k s_k^2/sqrt(P + r^2)
 * The plant keeps the mean, the deviations s_k, the shares and the error of each measured sum. Everyone who draws gains, or asks
 * what their errors do together, does so here. */
#ifndef REFLUX_INTERACT_DIRECTION_H
#define REFLUX_INTERACT_DIRECTION_H

#include "interact/plant.h"
#include "num/random.h"

/* Row `output` is known along plant->share, too: the measured sum and its standard deviation, above 0. Its gains become the
 * mean above. A sum that cannot be right, because a number is not finite, changes nothing. floor: relative error of any gain. */
void direction_take(struct interact_plant *plant, size_t output, real_t floor, real_t measured,
                    real_t sd);

/* Turns errors of the gains of a row that were drawn independently, by input, into errors with the covariance above; those of a row
 * without a measured sum stay. The errors may have other deviations than the gains: drawn from whole shapes, for one. */
void direction_correct(const struct interact_plant *plant, size_t output, real_t floor,
                       real_t *errors);

/* The vector q of a row, by input. False, and q all 0: the errors of the row are independent. */
bool direction_common(const struct interact_plant *plant, size_t output, real_t floor, real_t *q);

/* Standard deviation of a gain by itself, the floor included. */
real_t direction_sd(const struct interact_plant *plant, size_t output, size_t input, real_t floor);

/* Draws the gains of a row about their means, by input: one normal deviate each, in ascending order. */
void direction_draw(const struct interact_plant *plant, size_t output, real_t floor,
                    struct random *random, real_t *gains);

#endif
