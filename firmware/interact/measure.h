/* Interaction that sees gains, time constants and dead times together: the relative normalised gain array.
 *
 * M.-J. He, W.-J. Cai, W. Ni and L.-H. Xie, "RNGA based control system configuration for multivariable processes",
 * J. Process Control 19 (2009) 1036:
 *     K_N = K ./ (L + T)         gain over average residence time
 *     Phi = K_N .* (K_N^-1)'     RNGA: paired elements should be positive and near 1
 *     Gamma = Phi ./ Lambda      RARTA: how residence times change when the other loops close
 * and the equivalent transfer function of a pair with all other loops closed: gain K/lambda, gamma T, gamma L. */
#ifndef REFLUX_INTERACT_MEASURE_H
#define REFLUX_INTERACT_MEASURE_H

#include <stdbool.h>

#include "interact/assignment.h"
#include "interact/rga.h"

struct measure {
    struct matrix lambda, phi,
        gamma; /* rows and columns as in the pairs; gamma 0 where lambda is 0 */
};

struct measure_work {
    struct rga_work rga;
    struct matrix gains;
};

/* Judges the square plant of the pairs: row k output[k], column k input[k]. shortest_s, above 0 to 1e6: residence times are
 * taken as at least this (the sample interval), for an effect without delay has none. ERR_SINGULAR: K or K_N is. */
MUST_CHECK enum err measure_compute(const struct interact_plant *plant, const struct pairs *pairs,
                                    real_t shortest_s, struct measure_work *work,
                                    struct measure *result);

/* Returns true when the RNGA would pair alike: no other assignment has a smaller sum of |ln phi| over positive elements. Where it
 * would not, gains and speeds pull different ways, and the pairing by gains alone deserves a look. */
bool measure_agrees(const struct measure *m, struct assignment *work);

/* Equivalent transfer function of pair k. ERR_RANGE: lambda or gamma of the pair is not positive: there is none. */
MUST_CHECK enum err measure_equivalent(const struct measure *m, const struct interact_plant *plant,
                                       const struct pairs *pairs, uint8_t k,
                                       struct fopdt *equivalent);

#endif
