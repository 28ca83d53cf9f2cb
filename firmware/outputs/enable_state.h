/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_OUTPUTS_ENABLE_STATE_H
#define REFLUX_OUTPUTS_ENABLE_STATE_H

#include "outputs/output_switch_state.h"

/* Owner: enable.c. */
struct output_enable {
    struct output_switch contact;
};

#endif
