#ifndef REFLUX_GMV_GMV_CYCLE_STATE_H
#define REFLUX_GMV_GMV_CYCLE_STATE_H

#include "kinds/gmv/gmv_cycle.h"

struct gmv_cycle {
    /* Setpoint; last control error that is not small. */
    float setpoint, last;
    /* Steps since the setpoint moved or the law began. */
    uint32_t steps_at_rest;
    /* Steps of this window. */
    uint32_t window_steps;
    uint32_t crossings;
    /* Windows in a row that have swung. */
    uint8_t swinging_windows;
    /* Sums of squares: control errors of both halves, prediction errors. */
    float first, second, surprise;
};

#endif
