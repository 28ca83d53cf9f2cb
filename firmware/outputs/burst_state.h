/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_OUTPUTS_BURST_STATE_H
#define REFLUX_OUTPUTS_BURST_STATE_H

#include "outputs/mains.h"
#include "outputs/output_switch_state.h"

/* Owner: burst.c. owed: as in window_state.h. */
struct output_burst {
    struct output_switch contact;
    int64_t owed;
    uint32_t group_ms; /* whole cycles of the mains */
    uint32_t left_ms;  /* to the end of this group, at least 1 */
    uint32_t command;  /* in force since the last turn */
    uint8_t cycles;    /* of a group */
    uint8_t
        wait_ms; /* from the crossing at which a group begins until the pin switches; 0: it has */
    uint16_t crossings; /* to the beginning of the next group, at least 1 */
    struct mains mains;
};

#endif
