#include "base/event.h"

#include <string.h>

/* Each event is one text: level, name, zero, description. So it takes one pointer. */
#define INFO    "\0"
#define WARNING "\1"
#define ALARM   "\2"
#define ACTION  "\3"
_Static_assert(EVENT_INFO == 0 && EVENT_WARNING == 1 && EVENT_ALARM == 2 && EVENT_ACTION == 3,
               "levels are as above");
#define EVENT_ROW(name, text, level, unit)    level #name "\0" text,
#define EVENT_ABSENT(name, text, level, unit) INFO "?\0?",
#define EVENT_NO_ROW(name, text, level, unit)

static const char *const table[] = {EVENT_LIST(EVENT_ROW, EVENT_OF_SEQUENCE, EVENT_OF_START_UP,
                                               EVENT_OF_GUARD, EVENT_OF_JOB, EVENT_OF_BLOCK,
                                               EVENT_OF_CHECK, EVENT_OF_PINS)};
_Static_assert(sizeof table / sizeof table[0] == EVENT_COUNT, "every event has a name and a text");

const char *event_name(uint8_t code)
{
    return code < EVENT_COUNT ? table[code] + 1 : "?";
}

const char *event_text(uint8_t code)
{
    return code < EVENT_COUNT ? strchr(event_name(code), 0) + 1 : "?";
}

enum event_level event_level(uint8_t code)
{
    return code < EVENT_COUNT ? (enum event_level)table[code][0] : EVENT_ALARM;
}

bool event_may_repeat(uint8_t code)
{
    bool of_test = code >= EVENT_SEQUENCE_STEP && code <= EVENT_TRIAL_FAILED;
    enum event_level level = event_level(code);
    if (level == EVENT_WARNING || level == EVENT_ALARM)
        return !of_test && code != EVENT_SENSOR_POOR &&
               code != EVENT_WRONG_KEY; /* WRONG_KEY carries a count of its own */
    return code == EVENT_LINK_UP || code == EVENT_MEASUREMENT_GOOD || code == EVENT_INTERLOCK_OFF ||
           code == EVENT_FOLLOWING || code == EVENT_ALARM_OFF || code == EVENT_DEVIATION_OVER ||
           code == EVENT_DOUBTFUL_OVER || code == EVENT_BLOCK_EVENT;
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
