#ifndef REFLUX_GMV_GMV_MONITORS_STATE_H
#define REFLUX_GMV_GMV_MONITORS_STATE_H

#include "kinds/gmv/gmv_burst_state.h"
#include "kinds/gmv/gmv_cycle_state.h"
#include "kinds/gmv/gmv_monitors.h"
#include "kinds/gmv/gmv_record_state.h"

struct gmv_monitors {
    struct gmv_burst burst[GMV_LOOPS];
    struct gmv_cycle cycle[GMV_LOOPS];
    struct gmv_record record[GMV_LOOPS];
    /* Steps for which an MV has been pushed against a limit that its loop needs it to leave. */
    uint32_t jammed_steps[GMV_LOOPS];
    /* Steps for which the estimated g_ii,0 has been wrong. */
    uint32_t wrong_steps[GMV_LOOPS];
};

/* Records of the PIs, one for each loop. */
static inline const struct gmv_record *gmv_monitors_records(const struct gmv_monitors *m)
{
    return m->record;
}

#endif
