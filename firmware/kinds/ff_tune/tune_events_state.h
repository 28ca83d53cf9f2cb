/* The state behind tune_events.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_FF_TUNE_TUNE_EVENTS_STATE_H
#define REFLUX_FF_TUNE_TUNE_EVENTS_STATE_H

#include <stdbool.h>
#include <stdint.h>

struct tune_events {
    /* Steps without a reading. */
    uint32_t sensor_away;
    /* %, of `worse` and of `changed` */
    float worse_by, changed_to;
    /* Bits of enum tune_event; enum tune_verdict. Both are for the end of this step. */
    uint8_t pending, ended;
};

#endif
