/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_OUTPUTS_ANALOG_STATE_H
#define REFLUX_OUTPUTS_ANALOG_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/pin.h"
#include "outputs/output_span.h"

/* Owner: analog.c. */
struct output_analog {
    hal_pin pin;
    uint32_t command; /* that the pin has; above OUTPUT_FULL: the pin is off */
    struct output_span span;
};

#endif
