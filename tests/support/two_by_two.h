/* The smallest plant worth controlling: two first-order outputs, each fed by both inputs, exact in time.
 *
 *     tau_i dy_i/dt = 20 + sum_j k_ij u_j + d - y_i      k = [0.8 0.3; 0.2 0.9], tau = 120 s, 180 s
 */
#ifndef REFLUX_TESTS_TWO_BY_TWO_H
#define REFLUX_TESTS_TWO_BY_TWO_H

#include "plants/plant.h"

extern const struct plant_class two_by_two;

#endif
