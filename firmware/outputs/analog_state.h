/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_OUTPUTS_ANALOG_STATE_H
#define REFLUX_OUTPUTS_ANALOG_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/pin.h"

/* Owner: analog.c. */
struct output_analog {
    hal_pin pin;
    uint32_t command;      /* that the pin has; above OUTPUT_FULL: the pin is off */
    uint32_t gain, offset; /* 1/65536 of the output's span; gain without its sign */
    bool falls;            /* the gain is below 0 */
};

#endif
