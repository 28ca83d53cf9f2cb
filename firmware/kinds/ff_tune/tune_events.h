/* Events of a block of the kind `ff_tune`: collected while it works, raised at the end of the step. */
#ifndef REFLUX_FF_TUNE_TUNE_EVENTS_H
#define REFLUX_FF_TUNE_TUNE_EVENTS_H

#include "kinds/ff_tune/tune_settings.h"
#include "kinds/ff_tune/tune_stage.h"

enum tune_event {
    TUNE_EVENT_ADOPTED,
    TUNE_EVENT_NOT,
    TUNE_EVENT_WORSE,
    TUNE_EVENT_CHANGED,
    TUNE_EVENT_STILL,
    TUNE_EVENT_SENSOR,
    TUNE_EVENT_WEAK,
    TUNE_EVENTS
};
extern const struct block_event tune_event_rows[TUNE_EVENTS];

struct tune_events;

/* Values of this step. */
struct tune_event_values {
    /* The disturbance stands still where the stage needs it to move. */
    bool still;
    /* r.m.s. of the disturbance, fraction; part of the squares that the candidate takes off. */
    float d, promised;
    /* `step` that the last identification lacked, EU; 0: its test signal was large enough, or not the reason. */
    float step_wanted;
};

void tune_events_adopted(struct tune_events *e);
/* The loop was worse than without its feedforward, by %. */
void tune_events_worse(struct tune_events *e, float by);
/* The element does less than half of what was tested; it does %. */
void tune_events_changed(struct tune_events *e, float does);
/* An identification has ended with that; TUNE_NONE: it is nothing to report. */
void tune_events_ended(struct tune_events *e, enum tune_verdict verdict);
/* Counts steps in which a reading is missing. */
void tune_events_readings(struct tune_events *e, bool good);
void tune_events_raise(struct tune_events *e, const struct tune_context *c, struct block_io *io,
                       const struct tune_event_values *v);

#endif
