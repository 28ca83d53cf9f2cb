#include "supervise/alarms.h"

#include <string.h>

#include "base/elapsed.h"
#include "exchange/alarm_names.h"
#include "exchange/sampling.h"
#include "exchange/span.h"
#include "supervise/alarms_of_blocks.h"
#include "supervise/deviations.h"

static void tell_alarm(struct supervisor *s, uint8_t i, enum event_code code, float value)
{
    char name[CHANNEL_NAME_SIZE];
    alarm_name(&s->plan->config, i, name);
    event_put(s->events, s->time_ms, code, name, value, i);
}

/* Reads the value that entry i looks at, EU. Returns false if it is not valid; then the entry stays as it is. */
static bool look(const struct supervisor *s, uint8_t i, float *value)
{
    const struct alarm_config *c = &s->plan->config.alarm[i];
    uint8_t at = s->plan->alarm[i];
    if (alarm_is_of_block(s, i)) {
        *value = alarm_event_value(s, i);
        return true;
    }
    uint8_t pv = c->side == ALARM_DEVIATION ? s->plan->loop[at].pv : at;
    const struct measurement_state *m = &s->measurement[pv];
    const struct measurement_config *mc = &s->plan->config.measurement[pv];
    bool idle = c->side == ALARM_DEVIATION && s->loop[at].mode == LOOP_MANUAL;
    /* A loop that does not act has no deviation. */
    if (!idle && (!m->bound || !m->seen || m->alarm))
        return false;
    *value = span_to_eu(m->value, mc->lo, mc->hi);
    if (c->side == ALARM_DEVIATION) {
        float distance = *value - span_to_eu(s->loop[at].setpoint, mc->lo, mc->hi);
        *value = distance < 0.0f ? -distance : distance;
    }
    return true;
}

static bool past_limit(const struct supervisor *s, uint8_t i, float value)
{
    const struct alarm_config *c = &s->plan->config.alarm[i];
    if (alarm_is_of_block(s, i))
        return alarm_event_is_raised(s, s->plan->alarm[i]);
    float band = s->alarm[i].condition ? c->hysteresis : 0.0f;
    if (c->side == ALARM_DEVIATION && s->loop[s->plan->alarm[i]].mode == LOOP_MANUAL)
        return false;
    if (c->side == ALARM_LO || c->side == ALARM_LO_LO)
        return value < c->limit + band;
    return value > c->limit - band;
}

/* Returns true if the value is new in this tick. Between two samples of an analyser the value stands: then neither
 * a limit is passed, nor does time count towards the delay. */
static bool comes_now(const struct supervisor *s, uint8_t i)
{
    bool deviation = s->plan->config.alarm[i].side == ALARM_DEVIATION;
    uint8_t at = s->plan->alarm[i];
    if (alarm_is_of_block(s, i))
        return true;
    if (deviation && s->loop[at].mode == LOOP_MANUAL)
        return true;
    return !sampling_stands(s, deviation ? s->plan->loop[at].pv : at);
}

/* Returns true if no other alarm of its group is on the list. */
static bool first_of_group(const struct supervisor *s, uint8_t i)
{
    const struct config *c = &s->plan->config;
    if (c->alarm[i].group == 0)
        return false;
    for (uint8_t k = 0; k < s->placed[PLACED_ALARMS]; k++)
        if (k != i && c->alarm[k].on[0] && c->alarm[k].group == c->alarm[i].group &&
            s->alarm[k].listed)
            return false;
    return true;
}

static void run_one(struct supervisor *s, uint8_t i)
{
    struct alarm_state *a = &s->alarm[i];
    const struct alarm_config *c = &s->plan->config.alarm[i];
    float value;
    if (a->shelved_until_ms) {
        if (s->time_ms < a->shelved_until_ms)
            return;
        a->shelved_until_ms = 0;
        tell_alarm(s, i, EVENT_ALARM_SHELVED, 0.0f);
    }
    if (!comes_now(s, i))
        return;
    if (!look(s, i, &value)) {
        /* The delay stands still meanwhile. */
        uint64_t since_ms = a->since_ms + (uint32_t)(s->plan->tick_s * 1000.0f);
        a->since_ms = since_ms < s->time_ms ? since_ms : s->time_ms;
        return;
    }
    bool now = past_limit(s, i, value);
    if (now && !a->pending)
        a->since_ms = s->time_ms;
    a->pending = now;
    bool condition =
        now && (a->condition || elapsed_ms(s->time_ms, a->since_ms) >= c->delay_s * 1000.0f);
    if (condition && !a->condition) {
        a->first = a->listed ? a->first : first_of_group(s, i);
        a->listed = true;
        a->acknowledged = false;
        tell_alarm(s, i, EVENT_ALARM_ON, value);
    } else if (!condition && a->condition) {
        a->listed = c->latch && !a->acknowledged;
        tell_alarm(s, i, EVENT_ALARM_OFF, value);
    }
    a->condition = condition;
}

/* The mark of the first alarm outlives it, until the whole group is off the list. */
static void forget_firsts(struct supervisor *s)
{
    for (uint8_t i = 0; i < s->placed[PLACED_ALARMS]; i++)
        if (s->alarm[i].first && !s->alarm[i].listed && first_of_group(s, i))
            s->alarm[i].first = false;
}

void alarms_run(struct supervisor *s)
{
    for (uint8_t i = 0; i < s->placed[PLACED_ALARMS]; i++)
        if (s->plan->config.alarm[i].on[0] && s->plan->alarm[i] != PLAN_NONE)
            run_one(s, i);
    forget_firsts(s);
    deviations_run(s);
}

void alarms_time_back(struct supervisor *s)
{
    for (uint8_t i = 0; i < s->placed[PLACED_ALARMS]; i++) {
        s->alarm[i].pending = false;
        s->alarm[i].shelved_until_ms = 0;
    }
    deviations_time_back(s);
}

static void acknowledge(struct supervisor *s, uint8_t i)
{
    struct alarm_state *a = &s->alarm[i];
    if (!a->listed || a->acknowledged)
        return;
    a->acknowledged = true;
    a->listed = a->condition;
    tell_alarm(s, i, EVENT_ALARM_ACK, 0.0f);
}

static void shelve(struct supervisor *s, uint8_t i, float seconds)
{
    struct alarm_state *a = &s->alarm[i];
    memset(a, 0, sizeof *a); /* whatever holds after the shelving counts as new */
    if (seconds > 0.0f)
        a->shelved_until_ms = s->time_ms + (uint32_t)(seconds * 1000.0f); /* at most a day */
    tell_alarm(s, i, EVENT_ALARM_SHELVED, seconds);
}

void alarms_request(struct supervisor *s, const struct request *r)
{
    const struct config *c = &s->plan->config;
    if (r->output == PLAN_NONE && r->kind == REQUEST_ACK) {
        for (uint8_t i = 0; i < s->placed[PLACED_ALARMS]; i++)
            if (c->alarm[i].on[0])
                acknowledge(s, i);
        return;
    }
    if (r->output >= s->placed[PLACED_ALARMS] || !c->alarm[r->output].on[0])
        event_put(s->events, s->time_ms, EVENT_REQUEST_REFUSED, "alarm", r->value, 0);
    else if (r->kind == REQUEST_ACK)
        acknowledge(s, r->output);
    else
        shelve(s, r->output, r->value);
}

void alarms_place(struct supervisor *s, const struct plan *old, uint8_t i)
{
    const struct alarm_config *a = &s->plan->config.alarm[i];
    const struct alarm_config *before = old ? &old->config.alarm[i] : NULL;
    if (!before || strcmp(a->on, before->on) != 0 || a->side != before->side ||
        a->group != before->group)
        memset(&s->alarm[i], 0, sizeof s->alarm[i]);
}
