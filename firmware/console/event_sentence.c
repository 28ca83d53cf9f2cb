/* Events as sentences for people. Most sentences follow from the text of the event (base/event_list.h): the subject, the text, and
 * the value behind the words that say what it means. The others have a pattern of their own. */
#include "console/event_sentence.h"

#include <string.h>

#include "console/phrases.h"
#include "exchange/alarm_names.h"

/* In a pattern, %s stands for the subject, %v for the value in the unit of the subject, %n for the value alone, %m for a mode, %b for
 * "block 2: settle" of the subject "block2.settle", and %i for the measurement that an interlock watches, with the value. Where the
 * value is 0 (of RESTART_DONE: 1), the part behind a bar replaces the part before it. */
struct pattern {
    uint8_t code;
    const char *words;
};

static const struct pattern patterns[] = {
    {EVENT_STARTED, "started in the safe state: %s"},
    {EVENT_MODE, "%s %m"},
    {EVENT_SETPOINT, "%s setpoint %v"},
    {EVENT_OUTPUT, "%s output %v"},
    {EVENT_SAMPLE_TWICE, "sample %n repeated or out of order"},
    {EVENT_SAMPLE_EARLY, "sample %n s early"},
    {EVENT_SAMPLE_LATE, "sample %n s late"},
    {EVENT_SAMPLE_MISSING, "%n samples missing"},
    {EVENT_MEASUREMENT_BAD, "%s not usable at %v, last value held"},
    {EVENT_MEASUREMENT_GOOD, "%s usable again, %v"},
    {EVENT_INTERLOCK_ON, "interlock holds %s, %i"},
    {EVENT_INTERLOCK_OFF, "interlock releases %s, %i"},
    {EVENT_MANUAL_BY_BOARD, "the board has put %s into manual"},
    {EVENT_TELEMETRY_LOST, "%n telemetry rows lost"},
    {EVENT_ALARM_ON, "%s: %v, beyond its limit"},
    {EVENT_ALARM_OFF, "%s: %v, the alarm is over"},
    {EVENT_ALARM_SHELVED, "alarm %s silent for %n s|alarm %s no longer silent"},
    {EVENT_RESTART_DONE,
     "as before the reset: outputs, modes, setpoints|as before the reset: outputs"},
    {EVENT_PLANT_REFUSED, "plant %s refused (%n)"},
    {EVENT_STORAGE_REFUSED, "%s: stored set %n refused, `load` says why"},
    {EVENT_SAME_READING, "%s sends the same numbers as meas%n"},
    {EVENT_SEQUENCE_CONFIRMED, "%s: step %n confirmed"},
    {EVENT_SEQUENCE_SKIPPED, "%s: wait of step %n skipped"},
    {EVENT_SEQUENCE_TIMEOUT, "%s: step %n took longer than allowed"},
    {EVENT_OFFSET, "%v subtracted from %s|%s: no offset any more"},
    {EVENT_BLOCK_VERB, "%b done"},
    {EVENT_BLOCK_EVENT, "%b %n"},
    {EVENT_BLOCK_ALARM, "%b %n"},
    {EVENT_DO_MODE, "%s %m requested"},
    {EVENT_DO_SETPOINT, "%s setpoint %v requested"},
    {EVENT_DO_OUTPUT, "%s output %v requested"},
    {EVENT_DO_SET, "%s set to %n|%s set"},
};

enum unit { PLAIN, OF_LOOP, OF_MEASUREMENT, OF_OUTPUT, OF_ALARM, OF_INTERLOCK };
#define EVENT_ROW(name, text, level, unit)    unit,
#define EVENT_ABSENT(name, text, level, unit) PLAIN,
#define EVENT_NO_ROW(name, text, level, unit)
static const uint8_t units[] = {EVENT_LIST(EVENT_ROW, EVENT_OF_SEQUENCE, EVENT_OF_START_UP,
                                           EVENT_OF_GUARD, EVENT_OF_JOB, EVENT_OF_BLOCK,
                                           EVENT_OF_CHECK, EVENT_OF_PINS)};
_Static_assert(sizeof units == EVENT_COUNT, "every event has a unit");

static const char *pattern_of(const struct event *e)
{
    for (unsigned i = 0; i < sizeof patterns / sizeof patterns[0]; i++)
        if (patterns[i].code == e->code)
            return patterns[i].words;
    return NULL;
}

/* Whole numbers, which may count something, keep all digits. */
static void sentence_number(struct text *line, float x)
{
    if (x >= 0.0f && x < 1e6f && (float)(uint32_t)x == x)
        text_u32(line, (uint32_t)x);
    else
        text_float4(line, x);
}

static const char *measurement_unit(const struct config *config, const char *name)
{
    uint8_t i = config_find_measurement(config, name);
    return i == PLAN_NONE ? "" : config->measurement[i].unit;
}

/* Returns the unit of the PV of a loop. */
static const char *loop_unit(const struct config *config, const char *name)
{
    uint8_t i = config_find_loop(config, name);
    return i == PLAN_NONE ? "" : measurement_unit(config, config->loop[i].pv);
}

/* Returns the unit of what a loop drives. */
static const char *output_unit(const struct config *config, const char *name)
{
    uint8_t loop = config_find_loop(config, name);
    if (loop == PLAN_NONE)
        return "";
    uint8_t mv = config_find_mv(config, config->loop[loop].out);
    return mv == PLAN_NONE ? loop_unit(config, config->loop[loop].out) : config->mv[mv].unit;
}

/* Returns the unit of what an alarm watches; "" of an event. */
static const char *alarm_unit(const struct config *config, const char *name)
{
    uint8_t i = alarm_find(config, name);
    if (i == PLAN_NONE || alarm_is_on_event(&config->alarm[i]))
        return "";
    const struct alarm_config *alarm = &config->alarm[i];
    return alarm->side == ALARM_DEVIATION ? loop_unit(config, alarm->on)
                                          : measurement_unit(config, alarm->on);
}

/* Returns the unit of the value, as base/event_list.h says; "" of what is not in the settings. */
static const char *unit_of(const struct config *config, const struct event *e)
{
    uint8_t mv;
    switch (units[e->code]) {
    case OF_LOOP:
        return loop_unit(config, e->subject);
    case OF_MEASUREMENT:
        return measurement_unit(config, e->subject);
    case OF_OUTPUT:
        mv = config_find_mv(config, e->subject);
        return mv == PLAN_NONE ? output_unit(config, e->subject) : config->mv[mv].unit;
    case OF_ALARM:
        return alarm_unit(config, e->subject);
    default: /* put_watched() knows that of an interlock */
        return "";
    }
}

static void sentence_value(const struct config *config, const struct event *e, struct text *line)
{
    const char *unit = unit_of(config, e);
    text_float4(line, e->value);
    if (unit[0])
        put_word(line, unit);
}

/* Writes the measurement of an interlock, whose number is the event's detail. Where the settings have changed since, the value alone is
 * known. */
static void put_watched(const struct config *config, const struct event *e, struct text *line)
{
    uint8_t m = PLAN_NONE;
    if (e->detail < CONFIG_INTERLOCKS && strcmp(config->interlock[e->detail].mv, e->subject) == 0)
        m = config_find_measurement(config, config->interlock[e->detail].measurement);
    text_str(line, m == PLAN_NONE ? "measurement" : config->measurement[m].name);
    text_char(line, ' ');
    text_float4(line, e->value);
    if (m != PLAN_NONE)
        put_word(line, config->measurement[m].unit);
}

static void put_mode(struct text *line, float value)
{
    const char *mode =
        value >= 0.0f && value < (float)MODE_NAMES ? mode_names[(unsigned)value] : "?";
    for (; *mode; mode++)
        text_char(line, (char)(*mode >= 'a' && *mode <= 'z' ? *mode - 'a' + 'A' : *mode));
}

/* "block2.settle" as "block 2: settle" */
static void put_block_word(struct text *line, const char *subject)
{
    for (; *subject && *subject != '.'; subject++) {
        if (*subject >= '0' && *subject <= '9')
            text_char(line, ' ');
        text_char(line, *subject);
    }
    if (*subject)
        text_str(line, ": ");
    text_str(line, *subject ? subject + 1 : "");
}

static void put_pattern(const struct config *config, const struct event *e, const char *words,
                        struct text *line)
{
    const char *bar = strchr(words, '|');
    if (bar && e->value == (e->code == EVENT_RESTART_DONE ? 1.0f : 0.0f))
        words = bar + 1;
    for (; *words && *words != '|'; words++) {
        if (*words != '%') {
            text_char(line, *words);
            continue;
        }
        switch (*++words) {
        case 's':
            text_str(line, e->subject);
            break;
        case 'v':
            sentence_value(config, e, line);
            break;
        case 'n':
            sentence_number(line, e->value);
            break;
        case 'm':
            put_mode(line, e->value);
            break;
        case 'b':
            put_block_word(line, e->subject);
            break;
        default:
            put_watched(config, e, line);
            break;
        }
    }
}

static bool ends_with(const char *text, size_t n, const char *end)
{
    size_t m = strlen(end);
    return n >= m && memcmp(text + n - m, end, m) == 0;
}

static void put_part(struct text *line, const char *text, size_t n)
{
    for (size_t i = 0; i < n; i++)
        text_char(line, text[i]);
}

/* Writes the words that say what the value means, with the value: "base tick, s" as "base tick 1 s". */
static void put_meaning(const struct config *config, const struct event *e, const char *words,
                        struct text *line)
{
    static const char *const share = ", fraction of span", *const seconds = ", s";
    size_t n = strlen(words);
    bool span = ends_with(words, n, share), time = ends_with(words, n, seconds);
    put_part(line, words, n - (span ? strlen(share) : time ? strlen(seconds) : 0));
    text_char(line, ' ');
    if (span) {
        text_float4(line, 100.0f * e->value);
        text_str(line, " % of span");
    } else if (time) {
        sentence_number(line, e->value);
        text_str(line, " s");
    } else if (units[e->code] != PLAIN) {
        sentence_value(config, e, line);
    } else {
        sentence_number(line, e->value);
    }
}

/* Writes the text of an event that is about a block, whose number is the value. */
static void put_about_block(const struct event *e, const char *head, size_t n, struct text *line)
{
    static const char of_block[] = "a block ";
    size_t begin = sizeof of_block - 1u;
    bool acts = n > begin && memcmp(head, of_block, begin) == 0;
    text_str(line, "block ");
    sentence_number(line, e->value);
    if (e->subject[0]) {
        text_str(line, " (");
        text_str(line, e->subject);
        text_char(line, ')');
    }
    text_str(line, acts ? " " : ": ");
    put_part(line, head + (acts ? begin : 0), n - (acts ? begin : 0));
}

static void put_subject(const struct event *e, struct text *line)
{
    if (!e->subject[0])
        return;
    text_str(line, e->subject);
    text_str(line, ": ");
}

/* The subject, the text of the event, and the value behind the words after its semicolon. */
static void sentence_text(const struct config *config, const struct event *e, struct text *line)
{
    const char *head = event_text(e->code), *tail = strchr(head, ';');
    size_t n = tail ? (size_t)(tail - head) : strlen(head);
    if (tail && strcmp(tail, "; block") == 0) {
        put_about_block(e, head, n, line);
        return;
    }
    put_subject(e, line);
    if (tail) {
        put_part(line, head, n);
        text_str(line, ", ");
        put_meaning(config, e, tail + 2, line);
    } else if (ends_with(head, n, ", s") || ends_with(head, n, " step")) {
        put_meaning(config, e, head, line);
    } else {
        text_str(line, head);
    }
}

/* The latest of a run of repeats, of which the value is the number. */
static void put_repeats(const struct event *e, struct text *line)
{
    const char *head = event_text(e->code & (uint8_t)~EVENT_REPEATED);
    put_subject(e, line);
    put_part(line, head, strcspn(head, ";"));
    text_str(line, ", ");
    sentence_number(line, e->value);
    text_str(line, " times so far, this is the latest");
}

void event_sentence(const struct config *config, const struct event *e, struct text *line)
{
    uint8_t code = e->code & (uint8_t)~EVENT_REPEATED;
    enum event_level level = event_level(code);
    const char *pattern = pattern_of(e);
    text_seconds(line, e->time_ms);
    put_word(line, event_level_name(level));
    text_char(line, ' ');
    if (code != e->code) {
        put_repeats(e, line);
    } else {
        if (pattern)
            put_pattern(config, e, pattern, line);
        else
            sentence_text(config, e, line);
        event_reasons(e, line);
    }
    if (level != EVENT_WARNING && level != EVENT_ALARM && code != EVENT_STARTED)
        return;
    text_str(line, " (");
    text_str(line, event_name(code));
    text_char(line, ')');
}
