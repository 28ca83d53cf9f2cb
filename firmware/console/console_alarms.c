/* Console commands on what is wrong: alarm, alarm ack, alarm shelve. */
#include <string.h>

#include "base/assertion.h"
#include "console/block_words.h"
#include "console/command_table.h"
#include "console/loop_guard_words.h"
#include "console/phrases.h"
#include "console/sequence_words.h"
#include "exchange/alarm_names.h"
#include "exchange/span.h"
#include "hal/tick.h"
#include "supervise/alarms.h"

static void entry_line(const struct service *s, uint8_t i, struct text *line)
{
    REFLUX_ASSERT(i < CONFIG_ALARMS);
    static const char *const priorities[] = {"low", "medium", "high"};
    const struct config *config = &service_in_force(s)->config;
    const struct alarm_config *c = &config->alarm[i];
    const struct alarm_state *a = &s->supervisor->alarm[i];
    char name[CHANNEL_NAME_SIZE];
    if (i >= s->supervisor->placed[PLACED_ALARMS] ||
        !(a->listed || a->first || a->shelved_until_ms))
        return;
    alarm_name(config, i, name);
    text_str(line, a->shelved_until_ms ? "SHELVED " : a->condition ? "ALARM_ON " : "ALARM_OFF ");
    text_str(line, name);
    text_str(line, " alarm");
    text_u32(line, i + 1u);
    put_word(line, priorities[c->priority]);
    if (a->shelved_until_ms) {
        text_str(line, " until ");
        text_seconds(line, a->shelved_until_ms);
        return;
    }
    text_str(line, a->acknowledged || !a->listed ? " acknowledged" : " unacknowledged");
    if (a->first)
        text_str(line, " first of its group");
}

static void plant_line(const struct service *s, struct text *line)
{
    const struct pins_config *pins = &service_in_force(s)->config.pins;
    if (!pins_leave_link(pins))
        return;
    if (CONFIG_LINK && s->link->refused) {
        text_str(line, "PLANT_REFUSED ");
        text_str(line, s->link->name[0] ? s->link->name : "-");
        put_word(line, plant_fault_text((uint8_t)s->link->refused));
    } else if (!CONFIG_LINK || s->link->state != IO_READY) {
        text_str(line, "LINK_DOWN ");
        text_str(line, pins_are_source(pins) ? "the board's own pins go on alone" : NO_PLANT);
    }
}

static void safe_state_line(const struct service *s, struct text *line)
{
    const struct supervisor *sup = s->supervisor;
    bool there = pins_are_source(&service_in_force(s)->config.pins) ||
                 (CONFIG_LINK && s->link->state == IO_READY);
    if (!there || sup->state != SUPERVISOR_SAFE || !sup->safe_reason[0])
        return;
    text_str(line, "SAFE_STATE loops in manual, outputs at safe values because of: ");
    hal_tick_lock(); /* the tick may be about to say another */
    text_str(line, sup->safe_reason);
    hal_tick_unlock();
}

static void bad_measurement_line(const struct service *s, unsigned n, struct text *line)
{
    const struct supervisor *sup = s->supervisor;
    if (n >= sup->placed[PLACED_MEASUREMENTS] || !sup->measurement[n].alarm)
        return;
    text_str(line, "MEASUREMENT_BAD ");
    text_str(line, service_in_force(s)->config.measurement[n].name);
    put_word(line, sup->measurement[n].bound ? measurement_fault_text(sup->measurement[n].fault)
                                             : not_announced(s));
}

static void not_following_line(const struct service *s, unsigned n, struct text *line)
{
    const struct supervisor *sup = s->supervisor;
    if (n >= sup->placed[PLACED_MVS] || !sup->mv[n].alarm)
        return;
    text_str(line, "NOT_FOLLOWING ");
    text_str(line, service_in_force(s)->config.mv[n].name);
}

static void interlock_line(const struct service *s, unsigned n, struct text *line)
{
    const struct supervisor *sup = s->supervisor;
    if (n >= sup->placed[PLACED_INTERLOCKS] || !sup->interlock[n].active)
        return;
    text_str(line, "INTERLOCK_ON lock");
    text_u32(line, n + 1u);
    text_str(line, " holds ");
    text_str(line, service_in_force(s)->config.interlock[n].mv);
}

/* Writes ", T10 = 112.3 degC, limit 110 degC". */
static void reading_and_limit(const struct client *c, const struct measurement_config *m,
                              float value, float limit, struct text *line)
{
    text_str(line, ", ");
    text_str(line, m->name);
    text_str(line, " = ");
    reply_amount(c, line, value, m->unit);
    text_str(line, ", limit ");
    reply_amount(c, line, limit, m->unit);
}

/* Writes the reading of interlock n, which holds, its limit, and that its latch alone holds it. */
static void interlock_words(const struct client *c, unsigned n, struct text *line)
{
    const struct plan *plan = service_in_force(c->service);
    if (!CONFIG_LOOP_GUARD || !line->n)
        return;
    uint8_t i = plan->interlock[n].measurement;
    reading_and_limit(c, &plan->config.measurement[i], c->service->supervisor->measurement[i].raw,
                      plan->config.interlock[n].limit, line);
    latched_words(c->service, n, line);
}

/* Writes the reading that a listed alarm looks at, and its limit: ", T10 = 112.3 degC, limit 110 degC". Events of blocks have none. */
static void reading_words(const struct client *c, uint8_t i, struct text *line)
{
    const struct plan *plan = service_in_force(c->service);
    const struct alarm_config *a = &plan->config.alarm[i];
    uint8_t at = plan->alarm[i];
    bool deviation = a->side == ALARM_DEVIATION;
    if (!CONFIG_PEOPLE || !line->n || at == PLAN_NONE || alarm_is_on_event(a))
        return;
    uint8_t pv = deviation ? plan->loop[at].pv : at;
    const struct measurement_config *m = &plan->config.measurement[pv];
    num_t value = c->service->supervisor->measurement[pv].value;
    reading_and_limit(c, m, span_to_eu(value, m->lo, m->hi), a->limit, line);
    if (deviation)
        text_str(line, " from the setpoint");
}

/* True: line *n is one of these; else *n counts from behind them. */
static bool is_among(unsigned *n, unsigned lines)
{
    if (*n < lines)
        return true;
    *n -= lines;
    return false;
}

/* Lists active alarms, a line each: link, measurements, outputs, interlocks, loops, blocks, sequence, limits. */
static bool alarm_line(struct client *c, unsigned n, struct text *line)
{
    const struct service *s = c->service;
    if (is_among(&n, 1)) {
        plant_line(s, line);
    } else if (is_among(&n, 1)) {
        safe_state_line(s, line);
    } else if (is_among(&n, 1)) {
        if (s->samples.stalled)
            text_str(line, "SAMPLE_STALLED samples arrive, but plant time does not advance");
    } else if (is_among(&n, CHANNEL_MAX)) {
        bad_measurement_line(s, n, line);
        doubtful_line(s, n, line);
    } else if (is_among(&n, CHANNEL_MAX)) {
        not_following_line(s, n, line);
    } else if (is_among(&n, CONFIG_INTERLOCKS)) {
        interlock_line(s, n, line);
        interlock_words(c, n, line);
    } else if (is_among(&n, DEVIATION_LINES)) {
        deviation_line(s, n, line);
    } else if (is_among(&n, BLOCK_ALARM_LINES)) {
        block_alarm_line(&c->session, n, line);
    } else if (is_among(&n, SEQUENCE_ALARM_LINES)) {
        sequence_alarm_line(s, line);
    } else if (is_among(&n, CONFIG_ALARMS)) {
        entry_line(s, (uint8_t)n, line);
        reading_words(c, (uint8_t)n, line);
    } else {
        return false;
    }
    return true;
}

#define ALARM_USAGE                                                                                \
    (CONFIG_LOOP_GUARD                                                                             \
         ? "expected: alarm, alarm ack ALARM|all, alarm shelve ALARM SECONDS, or alarm release "   \
           "lockN"                                                                                 \
         : "expected: alarm, alarm ack ALARM|all, or alarm shelve ALARM SECONDS")

void command_alarm(struct client *c, unsigned n, char **word)
{
    struct answer a;
    float seconds = 0.0f;
    if (n == 0) {
        reply_list(c, alarm_line, "");
        return;
    }
    if (CONFIG_LOOP_GUARD && n == 2 && strcmp(word[0], "release") == 0) {
        reply_answer(c, operate_release(&c->session, word[1], &a), &a);
        return;
    }
    bool ack = strcmp(word[0], "ack") == 0;
    if (n != (ack ? 2u : 3u) || !(ack || strcmp(word[0], "shelve") == 0)) {
        reply_err_about(c, ERR_PARSE, word[0], ALARM_USAGE);
        return;
    }
    if (ack) {
        const char *name = strcmp(word[1], "all") == 0 ? NULL : word[1];
        reply_answer(c, operate_acknowledge(&c->session, name, &a), &a);
        return;
    }
    enum err number = text_parse_float(word[2], &seconds);
    if (number)
        seconds = -1.0f;
    enum err err = operate_shelve(&c->session, word[1], seconds, &a);
    if (err == ERR_RANGE) {
        a.subject = word[2];
        err = number ? number : err;
    }
    reply_answer(c, err, &a);
}
