/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_OUTPUTS_RELAY_STATE_H
#define REFLUX_OUTPUTS_RELAY_STATE_H

#include "outputs/output_switch_state.h"

/* Owner: relay.c. */
struct output_relay {
    struct output_switch contact;
    uint32_t upper, lower; /* commands: on from here, off below here */
};

#endif
