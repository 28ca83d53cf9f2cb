#ifndef REFLUX_GMV_GMV_RECORD_STATE_H
#define REFLUX_GMV_GMV_RECORD_STATE_H

#include "kinds/gmv/gmv_record.h"

/* Answers to setpoints: means over the steps until the setpoint has settled. */
struct gmv_answers {
    /* |setpoint - PV|, |change of the setpoint| */
    float error, move;
    /* Share of the changes that came before the PV was near the setpoint. */
    float cut_share;
    uint16_t samples;
};

struct gmv_record {
    bool has_setpoint;
    /* A setpoint has moved since the controller changed. */
    bool answers;
    /* The window of the law, or of the PI until it has enough: samples at rest, and windows in a row that were worse. */
    uint8_t window_samples, worse_windows;
    float setpoint;
    /* Steps since the setpoint moved or the controller changed. */
    uint32_t steps_at_rest;
    /* Mean squares of the PI at rest, of all its samples until enough of these are at rest. */
    float error, moves;
    /* Samples at rest; 0: not enough yet. */
    uint16_t samples;
    /* Samples of any kind, until enough are at rest. */
    uint16_t any_samples;
    /* Sums of squares in the window. */
    float error_sum, moves_sum;
    /* Sensor noise at rest: the last two control errors, and the mean size of second differences. */
    float before[2], jitter;
    uint16_t jitters;
    /* Answers of the PI and of the law. */
    struct gmv_answers pi, law;
};

#endif
