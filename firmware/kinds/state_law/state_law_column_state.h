/* State of the job for a column's table. It stands in the leased workspace. For its owner state_law_column.c, for
 * state_law_kind.c, which leases it, and for tests. */
#ifndef REFLUX_STATE_LAW_STATE_LAW_COLUMN_STATE_H
#define REFLUX_STATE_LAW_STATE_LAW_COLUMN_STATE_H

#include "kinds/state_law/state_law_linear.h"
#include "law/state_law_job_state.h"

#if CONFIG_BLOCKS

enum state_law_column_phase {
    STATE_LAW_COLUMN_TABLE,
    STATE_LAW_COLUMN_LINEAR,
    STATE_LAW_COLUMN_LAW /* phases of the law's job */
};

struct state_law_column {
    uint8_t phase; /* enum state_law_column_phase */
    const struct column_record *record;
    struct state_law_linear linear;
    struct state_law_job job;
};

#endif
#endif
