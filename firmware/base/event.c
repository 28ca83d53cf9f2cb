#include "base/event.h"

#include <string.h>

static const struct {
    const char *name;
    const char *text;
    enum event_level level;
} table[] = {
    {"STARTED", "firmware started in its safe state", EVENT_INFO},
    {"LINK_UP", "plant connected", EVENT_INFO},
    {"LINK_DOWN", "plant silent, s", EVENT_ALARM},
    {"LINK_VERSION", "plant speaks another protocol version", EVENT_ALARM},
    {"CHANNEL_MISSING", "configured channel not announced by the plant", EVENT_WARNING},
    {"CHANNEL_UNIT", "plant announces another unit than configured", EVENT_WARNING},
    {"SAFE_STATE", "all loops manual, outputs at safe values", EVENT_ALARM},
    {"CONFIG_APPLIED", "configuration in force", EVENT_INFO},
    {"CONFIG_REFUSED", "configuration does not fit the plant's base tick", EVENT_ALARM},
    {"MODE", "loop mode is now (0 manual, 1 auto, 2 cascade)", EVENT_INFO},
    {"MODE_REFUSED", "loop stays in manual: measurement or plant not usable", EVENT_WARNING},
    {"SETPOINT", "setpoint is now", EVENT_INFO},
    {"OUTPUT", "manual output is now", EVENT_INFO},
    {"REQUEST_REFUSED", "request came too late for the mode in force", EVENT_WARNING},
    {"SAMPLE_TWICE", "sample repeated or out of order, number", EVENT_WARNING},
    {"SAMPLE_EARLY", "sample before the base tick was over, s early", EVENT_WARNING},
    {"SAMPLE_LATE", "sample after its time, s late", EVENT_WARNING},
    {"SAMPLE_MISSING", "samples missing", EVENT_WARNING},
    {"MEASUREMENT_BAD", "measurement not usable, last value held", EVENT_ALARM},
    {"MEASUREMENT_GOOD", "measurement usable again", EVENT_INFO},
    {"INTERLOCK_ON", "interlock forces its output; measurement", EVENT_ALARM},
    {"INTERLOCK_OFF", "interlock released; measurement", EVENT_INFO},
    {"NOT_FOLLOWING", "output does not follow its command; read-back", EVENT_WARNING},
    {"FOLLOWING", "output follows its command again; read-back", EVENT_INFO},
    {"TELEMETRY_LOST", "telemetry rows lost, the console is too slow", EVENT_WARNING},
};
_Static_assert(sizeof table / sizeof table[0] == EVENT_COUNT, "every event has a name and a text");

const char *event_name(uint8_t code)
{
    return code < EVENT_COUNT ? table[code].name : "?";
}

const char *event_text(uint8_t code)
{
    return code < EVENT_COUNT ? table[code].text : "?";
}

enum event_level event_level(uint8_t code)
{
    return code < EVENT_COUNT ? table[code].level : EVENT_ALARM;
}

const char *event_level_name(enum event_level level)
{
    return level == EVENT_INFO ? "info" : (level == EVENT_WARNING ? "warning" : "alarm");
}

void event_queue_init(struct event_queue *queue)
{
    memset(queue, 0, sizeof *queue);
    spsc_init(&queue->index, EVENT_QUEUE_SIZE);
}

void event_put(struct event_queue *queue, uint64_t time_ms, enum event_code code,
               const char *subject, float value, uint8_t detail)
{
    if (!spsc_can_write(&queue->index)) {
        queue->lost++;
        return;
    }
    struct event *e = &queue->slot[spsc_write_index(&queue->index)];
    memset(e, 0, sizeof *e);
    e->time_ms = time_ms;
    e->code = (uint8_t)code;
    e->detail = detail;
    e->value = value;
    if (subject)
        strncpy(e->subject, subject, sizeof e->subject - 1);
    spsc_write_done(&queue->index);
}
