/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_OUTPUTS_OUTPUT_SWITCH_STATE_H
#define REFLUX_OUTPUTS_OUTPUT_SWITCH_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/pin.h"

/* Owner: output_switch.c. */
struct output_switch {
    hal_pin pin;
    bool on;
    uint32_t held_ms; /* since the last change; stops at its largest value */
    uint32_t least_on_ms, least_off_ms;
};

#endif
