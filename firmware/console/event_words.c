/* An event as a line of text. */
#include "console/event_words.h"

#include "console/block_words.h"
#include "console/loop_guard_words.h"
#include "console/phrases.h"
#include "console/sensor_words.h"
#include "console/sequence_words.h"
#include "console/startup_words.h"
#include "exchange/alarm_names.h"

void event_reasons(const struct event *e, struct text *line)
{
    if (e->code == EVENT_MEASUREMENT_BAD) {
        put_reason(line, measurement_fault_text(e->detail));
    }
    if (CONFIG_LINK && e->code == EVENT_PLANT_REFUSED) {
        put_reason(line, plant_fault_text(e->detail));
    }
    sensor_event_words(e, line);
    sequence_event_words(e, line);
    startup_event_words(e, line);
    block_event_words(e, line);
    guard_event_words(e, line);
    if (event_level(e->code) == EVENT_ACTION)
        text_str(line, e->detail & EVENT_ENGINEER ? ", by engineer" : ", by operator");
}

void event_line(const struct event *e, struct text *line)
{
    uint8_t code = e->code & (uint8_t)~EVENT_REPEATED;
    text_seconds(line, e->time_ms);
    put_word(line, event_level_name(event_level(code)));
    put_word(line, event_name(code));
    put_word(line, e->subject[0] ? e->subject : "-");
    text_char(line, ' ');
    text_float(line, e->value);
    text_char(line, ' ');
    if (code != e->code) {
        text_str(line, "times so far, this is the latest");
        return;
    }
    text_str(line, event_text(e->code));
    if ((e->code == EVENT_MODE || e->code == EVENT_DO_MODE) && e->value >= 0.0f &&
        e->value < (float)MODE_NAMES)
        put_word(line, mode_names[(unsigned)e->value]);
    event_reasons(e, line);
}
