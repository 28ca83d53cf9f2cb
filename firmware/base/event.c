#include "base/event.h"

#include <string.h>

static const struct {
    const char *name;
    const char *text;
    enum event_level level;
} table[] = {
    {"STARTED", "firmware started in its safe state; why it started", EVENT_INFO},
    {"LINK_UP", "plant connected", EVENT_INFO},
    {"LINK_DOWN", "plant silent, s", EVENT_ALARM},
    {"LINK_VERSION", "plant speaks another protocol version", EVENT_ALARM},
    {"CHANNEL_MISSING", "configured channel not announced by the plant", EVENT_WARNING},
    {"CHANNEL_UNIT", "plant announces another unit than configured", EVENT_WARNING},
    {"SAFE_STATE", "all loops manual, outputs at safe values", EVENT_ALARM},
    {"CONFIG_APPLIED", "configuration in force; base tick, s", EVENT_INFO},
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
    {"ALARM_ON", "alarm limit passed; measurement, or distance from the setpoint", EVENT_ALARM},
    {"ALARM_OFF", "alarm condition is over; measurement, or distance from the setpoint",
     EVENT_INFO},
    {"ALARM_ACK", "alarm acknowledged", EVENT_INFO},
    {"ALARM_SHELVED", "alarm silent for, s; 0: no longer", EVENT_INFO},
    {"SAMPLE_OVERDUE", "the plant is there but sends no sample, s", EVENT_ALARM},
    {"RESTART_DONE", "outputs as before the reset (1), modes and setpoints as well (2)",
     EVENT_WARNING},
    {"RESTART_REFUSED", "the safe state stays after this reset", EVENT_WARNING},
    {"WRONG_KEY", "somebody tried to unlock the console with a wrong key", EVENT_WARNING},
    {"PLANT_REFUSED",
     "plant has more channels of a kind, or bytes of their names, than this board takes",
     EVENT_ALARM},
    {"STORAGE_LOADED", "stored settings are asked into force; set", EVENT_INFO},
    {"STORAGE_OLDER", "a newer stored set is not whole, an older one is used; set", EVENT_WARNING},
    {"STORAGE_CLIPPED", "stored value replaced: not allowed, or of another type; value now",
     EVENT_WARNING},
    {"STORAGE_REFUSED", "stored settings are not in force; `load` says why", EVENT_ALARM},
    {"STORAGE_DAMAGED", "no whole set is stored, defaults are in force", EVENT_ALARM},
    {"SEQUENCE_STEP", "sequence waits at step", EVENT_INFO},
    {"SEQUENCE_HELD", "sequence held at step", EVENT_WARNING},
    {"SEQUENCE_GOES_ON", "sequence goes on at step", EVENT_INFO},
    {"SEQUENCE_CONFIRMED", "step confirmed", EVENT_INFO},
    {"SEQUENCE_SKIPPED", "step no longer waited for", EVENT_WARNING},
    {"SEQUENCE_TIMEOUT", "step took longer than allowed", EVENT_WARNING},
    {"SEQUENCE_DONE", "sequence done, last step", EVENT_INFO},
    {"SEQUENCE_ABORTED", "sequence aborted into the safe state at step", EVENT_ALARM},
    {"OFFSET", "subtracted from the readings from now on", EVENT_INFO},
    {"DO_MODE", "mode asked for (0 manual, 1 auto, 2 cascade)", EVENT_ACTION},
    {"DO_SETPOINT", "setpoint asked for", EVENT_ACTION},
    {"DO_OUTPUT", "output asked for", EVENT_ACTION},
    {"DO_SET", "parameter set; 0 for a word", EVENT_ACTION},
    {"DO_APPLY", "transaction applied; parameters it changes", EVENT_ACTION},
    {"DO_STORAGE", "stored settings saved, loaded or replaced", EVENT_ACTION},
    {"DO_ALARM", "alarm acknowledged or shelved", EVENT_ACTION},
    {"DO_SEQUENCE", "sequence started, stopped or told what to do", EVENT_ACTION},
    {"DO_KEY", "key changed", EVENT_ACTION},
    {"DO_UNLOCK", "engineer level unlocked", EVENT_ACTION},
    {"DO_LOCK", "engineer level locked", EVENT_ACTION},
    {"DO_REBOOT", "restart asked for", EVENT_ACTION},
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
    static const char *const names[] = {"info", "warning", "alarm", "action"};
    return level <= EVENT_ACTION ? names[level] : "?";
}

struct event event_make(uint64_t time_ms, enum event_code code, const char *subject, float value,
                        uint8_t detail)
{
    struct event e;
    memset(&e, 0, sizeof e);
    e.time_ms = time_ms;
    e.code = (uint8_t)code;
    e.detail = detail;
    e.value = value;
    if (subject)
        strncpy(e.subject, subject, sizeof e.subject - 1);
    return e;
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
    queue->slot[spsc_write_index(&queue->index)] =
        event_make(time_ms, code, subject, value, detail);
    spsc_write_done(&queue->index);
}
