#include "kinds/ff_tune/tune_events.h"

#include "base/channel.h"
#include "kinds/ff_tune/tune_events_state.h"

/* A reading that stays away for more samples than this is reported. */
#define SENSOR_AWAY 10u

const struct block_event tune_event_rows[TUNE_EVENTS] = {
    [TUNE_EVENT_ADOPTED] = {"adopted", BLOCK_INFO,
                            "a feedforward was taken; what it takes off the squares, tested, %"},
    [TUNE_EVENT_NOT] = {"not", BLOCK_INFO,
                        "none: 2 disturbance still, 3 loop still, 4 slow, 5 no band, 6 unsure, "
                        "7 no model, 8 no better, 9 untested, 10 rejected, 12 stopped, 13+ signal"},
    [TUNE_EVENT_WORSE] = {"worse", BLOCK_ALARM,
                          "the loop was worse than without its feedforward, which is off; by %"},
    [TUNE_EVENT_CHANGED] = {"changed", BLOCK_INFO,
                            "it does less than half of what was tested; it is identified anew; %"},
    [TUNE_EVENT_STILL] =
        {"still", BLOCK_INFO,
         "the disturbance stands still: step it, or set disturb; r.m.s., % of span"},
    [TUNE_EVENT_SENSOR] = {"sensor", BLOCK_ALARM,
                           "a reading is missing; 1 the PV, 2 the disturbance"},
    [TUNE_EVENT_WEAK] = {"weak", BLOCK_INFO,
                         "the test signal is small beside what else moves the PV; set step to, EU"},
};

void tune_events_adopted(struct tune_events *e)
{
    e->pending |= 1u << TUNE_EVENT_ADOPTED;
}

void tune_events_worse(struct tune_events *e, float by)
{
    e->pending |= 1u << TUNE_EVENT_WORSE;
    e->worse_by = by;
}

void tune_events_changed(struct tune_events *e, float does)
{
    e->pending |= 1u << TUNE_EVENT_CHANGED;
    e->changed_to = does;
}

void tune_events_ended(struct tune_events *e, enum tune_verdict verdict)
{
    e->ended = (uint8_t)verdict;
}

void tune_events_readings(struct tune_events *e, bool good)
{
    e->sensor_away = good ? 0 : e->sensor_away + 1u;
}

void tune_events_raise(struct tune_events *e, const struct tune_context *c, struct block_io *io,
                       const struct tune_event_values *v)
{
    bool away = e->sensor_away > SENSOR_AWAY * c->ticks;
    if (e->ended)
        e->pending |= 1u << TUNE_EVENT_NOT;
    io->requests.raised = (uint16_t)(e->pending | (v->still ? 1u << TUNE_EVENT_STILL : 0u) |
                                     (away ? 1u << TUNE_EVENT_SENSOR : 0u));
    if (e->ended && v->step_wanted > 0)
        io->requests.raised |= 1u << TUNE_EVENT_WEAK;
    io->requests.event_value[TUNE_EVENT_WEAK] = v->step_wanted;
    io->requests.event_value[TUNE_EVENT_ADOPTED] = 100 * v->promised;
    io->requests.event_value[TUNE_EVENT_NOT] = e->ended;
    io->requests.event_value[TUNE_EVENT_WORSE] = e->worse_by;
    io->requests.event_value[TUNE_EVENT_CHANGED] = e->changed_to;
    io->requests.event_value[TUNE_EVENT_STILL] = 100 * v->d;
    io->requests.event_value[TUNE_EVENT_SENSOR] = io->inputs.quality[0] == QUALITY_GOOD ? 2 : 1;
    e->pending = 0;
    e->ended = TUNE_NONE;
}
