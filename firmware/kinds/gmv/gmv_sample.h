/* A sample of the self-tuner, and numbers that its parts hand each other. */
#ifndef REFLUX_GMV_GMV_SAMPLE_H
#define REFLUX_GMV_GMV_SAMPLE_H

#include "block/applied_history.h"
#include "kinds/gmv/gmv_shape.h"

/* Measurements of a step. */
struct gmv_sample {
    num_t y[GMV_LOOPS], w[GMV_LOOPS], disturbance[GMV_DISTURBANCES];
    const struct applied_history *applied[GMV_LOOPS];
    /* Base ticks of a step. */
    uint16_t divisor;
};

/* Filters of a loop: P = p_scale (1 - p z^-1), p_scale = 1/(1 - p). */
struct gmv_filter {
    num_t p, p_scale;
    /* R is P. */
    bool weighs_setpoint;
};

/* Predictions of a step with a complete regression: the measured P y; what the parameters in use and the estimated ones had predicted
 * (both of before that step); and the prediction of a standstill: "P y stays as it was a horizon ago". */
struct gmv_predicted {
    num_t measured, used, estimated, standstill;
};

#endif
