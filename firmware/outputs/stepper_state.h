/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_OUTPUTS_STEPPER_STATE_H
#define REFLUX_OUTPUTS_STEPPER_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/pin.h"

/* Owner: stepper.c. Speeds are 2^-48 steps a millisecond, positions 2^-48 steps. */
struct output_stepper {
    hal_pin pin;
    bool high;     /* the step pin */
    uint32_t full; /* speed at command 1, 2^-32 steps a millisecond: at most half a step */
    uint32_t ramp; /* change of speed in a millisecond, 2^-32 steps a millisecond */
    uint32_t command;
    int64_t speed; /* 0 to full */
    int64_t phase; /* part of the next step that is done, below 2^48 */
    int64_t owed;  /* what the command has asked for, less what was done */
};

#endif
