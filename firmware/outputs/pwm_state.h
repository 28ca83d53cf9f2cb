/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_OUTPUTS_PWM_STATE_H
#define REFLUX_OUTPUTS_PWM_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/pin.h"

/* Owner: pwm.c. */
struct output_pwm {
    hal_pin pin;
    uint32_t command; /* that the pin has */
};

#endif
