/* The column of Kotyk and Machacek (1995), section 3, in volts, and their compensator. */
#ifndef REFLUX_TESTS_KOTYK_MODEL_H
#define REFLUX_TESTS_KOTYK_MODEL_H

#include "lti/difference_model.h"
#include "num/matrix.h"

#define KOTYK_PERIOD 120

static inline void kotyk_model(struct difference_model *m)
{
    *m = (struct difference_model){
        .outputs = 2,
        .inputs = 2,
        .na = 2,
        .nb = 2,
        .period_s = KOTYK_PERIOD,
        .a = {{REAL_C(-0.80338), REAL_C(0.02616)}, {REAL_C(-1.06726), REAL_C(0.14709)}},
        .b = {{{REAL_C(0.03851), REAL_C(-0.00386)}, {REAL_C(-0.01062), REAL_C(-0.00192)}},
              {{REAL_C(0.01262), REAL_C(0.00316)}, {REAL_C(-0.01990), REAL_C(0.00157)}}}};
}

static inline struct difference_model kotyk_column(void)
{
    struct difference_model m;
    kotyk_model(&m);
    return m;
}

static inline void kotyk_compensator(struct matrix *g)
{
    g->rows = g->cols = 2;
    g->value[0][0] = REAL_C(1.0);
    g->value[0][1] = REAL_C(0.33);
    g->value[1][0] = REAL_C(0.64);
    g->value[1][1] = REAL_C(1.2112);
}

#endif
