/* The pilot column of Kotyk and Machacek (1995): methanol and water, second order, samples of 120 s, deviations in volts. */
#ifndef REFLUX_TESTS_KOTYK_MODEL_H
#define REFLUX_TESTS_KOTYK_MODEL_H

#include "lti/difference_model.h"

static inline struct difference_model kotyk_model(void)
{
    return (struct difference_model){
        .outputs = 2,
        .inputs = 2,
        .na = 2,
        .nb = 2,
        .period_s = REAL_C(120.0),
        .a = {{REAL_C(-0.80338), REAL_C(0.02616)}, {REAL_C(-1.06726), REAL_C(0.14709)}},
        .b = {{{REAL_C(0.03851), REAL_C(-0.00386)}, {REAL_C(-0.01062), REAL_C(-0.00192)}},
              {{REAL_C(0.01262), REAL_C(0.00316)}, {REAL_C(-0.01990), REAL_C(0.00157)}}}};
}

#endif
