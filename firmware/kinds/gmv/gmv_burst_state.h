#ifndef REFLUX_GMV_GMV_BURST_STATE_H
#define REFLUX_GMV_GMV_BURST_STATE_H

#include "kinds/gmv/gmv_burst.h"

struct gmv_burst {
    float setpoint;
    /* Steps since the setpoint moved or the law began. */
    uint32_t steps_at_rest;
    /* Steps in the long mean. */
    uint32_t mean_steps;
    /* Mean squares of the last few moves and of many, spans of the MV squared. */
    float recent, usual;
    /* Last move that is not small; number of recent turns, which fades. */
    float last, turns;
};

#endif
