#ifndef REFLUX_GMV_GMV_STATE_H
#define REFLUX_GMV_GMV_STATE_H

#include "kinds/gmv/gmv_learner_state.h"
#include "kinds/gmv/gmv_samples_state.h"

/* The estimators stand behind it. */
struct gmv {
    struct gmv_samples samples;
    /* Weights in use. */
    num_t lambda[GMV_LOOPS];
    /* Below it the loops are solved one by one. */
    num_t determinant;
    /* Parameters in use. */
    num_t used[GMV_LOOPS][GMV_PARAMETERS];
    struct gmv_learner learner;
};

#endif
