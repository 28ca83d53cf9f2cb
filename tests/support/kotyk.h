/* The column of Kotyk and Machacek (1995), section 3, as a difference model. */
#ifndef REFLUX_TESTS_KOTYK_H
#define REFLUX_TESTS_KOTYK_H

#include "lti/difference_model.h"

static inline struct difference_model kotyk_model(void)
{
    return (struct difference_model){
        .outputs = 2,
        .inputs = 2,
        .na = 2,
        .nb = 2,
        .period_s = 120,
        .a = {{REAL_C(-0.80338), REAL_C(0.02616)}, {REAL_C(-1.06726), REAL_C(0.14709)}},
        .b = {{{REAL_C(0.03851), REAL_C(-0.00386)}, {REAL_C(-0.01062), REAL_C(-0.00192)}},
              {{REAL_C(0.01262), REAL_C(0.00316)}, {REAL_C(-0.01990), REAL_C(0.00157)}}}};
}

#endif
