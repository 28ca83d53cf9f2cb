/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_OUTPUTS_WINDOW_STATE_H
#define REFLUX_OUTPUTS_WINDOW_STATE_H

#include "outputs/output_switch_state.h"

/* Owner: window.c. owed: time on that the command has asked for, less the time on; 1/65536 ms. */
struct output_window {
    struct output_switch contact;
    int64_t owed;
    int64_t least_on, least_off; /* 1/65536 ms */
    int64_t quarter;             /* of the period, 1/65536 ms */
    uint32_t period_ms;
    uint32_t left_ms; /* to the end of this period, at least 1 */
    uint32_t command; /* in force since the last turn */
};

#endif
