/* State of the temperatures. For its owner composition_sensors.c and for composition_block.h, which allocates it. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_SENSORS_STATE_H
#define REFLUX_COMPOSITION_COMPOSITION_SENSORS_STATE_H

#include "kinds/composition/composition_settings.h"

#if CONFIG_BLOCKS

struct composition_sensor {
    uint8_t input;     /* of the block */
    uint8_t stage;     /* from 0 */
    uint8_t component; /* from 0 */
    bool moves;        /* it moves the model; else it is only compared */
    bool present;      /* the reading is good, and not gated, in this step */
    real_t kp, ki;     /* 1/s, 1/s2 */
    real_t time;       /* s, 1/lambda */
    real_t e;          /* K, measured less predicted, before the step */
    real_t sum;        /* K s, integral of what the step leaves of e */
    real_t variance;   /* reduced EKF: variance of its mole fraction */
    real_t slope;      /* K, dT/dx of its component at the estimate */
    real_t spread;     /* K2, EKF: expected variance of e */
    uint32_t outside;  /* consecutive steps outside the gate */
    real_t correction; /* K/s, by which it drew the temperature in this step */
    real_t noise2;     /* K2, variance of a reading's noise */
};

struct composition_sensors {
    struct composition_sensor sensor[SENSORS_MAX];
    real_t model2; /* 1/s, variance that a mole fraction gathers in a second */
    real_t gate;   /* K; 0: none */
    uint32_t gate_steps;
    uint8_t n;
    uint8_t method;   /* enum composition_method */
    bool finds_noise; /* noise2 of each sensor is estimated */
};

#endif
#endif
