#include "supervise/law.h"

#include <stddef.h>
#include <string.h>

bool loop_due(const struct supervisor *s, uint8_t i, uint32_t tick)
{
    const struct loop_config *c = &s->plan->config.loop[i];
    return tick % c->divisor == c->phase;
}

bool loop_acts(const struct supervisor *s, uint8_t i)
{
    return s->plan->loop[i].used && s->loop[i].mode != LOOP_MANUAL;
}

bool loop_forced(const struct supervisor *s, uint8_t i)
{
    uint8_t j = s->plan->loop[i].output;
    return j != PLAN_NONE && s->output[j].forced;
}

bool loop_drives(const struct supervisor *s, uint8_t i)
{
    return loop_acts(s, i) && !loop_forced(s, i);
}

/* ---- settings ---- */

/* Settings were checked with the plan: what remains is an interval no block can keep. */
static void settings(struct supervisor *s, uint8_t i, bool anew)
{
    struct loop_state *l = &s->loop[i];
    float h = s->plan->tick_s * (float)s->plan->config.loop[i].divisor;
    enum err err;
    if (plan_is_two_position(s->plan, i)) {
        struct two_position_config two = plan_two_position(s->plan, i);
        err = anew ? two_position_init(&l->two, &two) : two_position_retune(&l->two, &two);
    } else {
        struct pid_config pid = plan_pid(s->plan, i);
        err = anew ? pid_init(&l->pid, &pid, h) : pid_retune(&l->pid, &pid, h);
    }
    if (err)
        event_put(s->events, s->time_ms, EVENT_CONFIG_REFUSED, s->plan->config.loop[i].name, h, 0);
}

void law_place(struct supervisor *s, uint8_t i)
{
    settings(s, i, true);
}

/* Settings that have waited. */
static void settle(struct supervisor *s, uint8_t i)
{
    if (s->loop[i].retune)
        settings(s, i, false);
    s->loop[i].retune = false;
}

static bool same_settings(const struct supervisor *s, const struct plan *old, uint8_t i)
{
    if (plan_is_two_position(s->plan, i) || s->plan->tick_s != s->tick_s ||
        s->plan->config.loop[i].divisor != old->config.loop[i].divisor)
        return false;
    const struct pid_config a = plan_pid(s->plan, i), b = plan_pid(old, i);
    /* All before `action` are floats; behind it there may be bytes that mean nothing. */
    return memcmp(&a, &b, offsetof(struct pid_config, action)) == 0 && a.action == b.action &&
           a.form == b.form;
}

void law_replace(struct supervisor *s, const struct plan *old, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    l->retune = l->retune || !same_settings(s, old, i);
    if (l->mode == LOOP_MANUAL || l->join || plan_is_two_position(s->plan, i))
        settle(s, i);
}

/* ---- step, follow and back ---- */

num_t law_step(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    num_t pv = s->measurement[s->plan->loop[i].pv].value;
    num_t v = plan_is_two_position(s->plan, i) ? two_position_step(&l->two, l->setpoint, pv)
                                               : pid_step(&l->pid, l->setpoint, pv);
    l->stepped = true;
    settle(s, i);
    return v;
}

void law_follow(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    settle(s, i);
    l->stepped = false;
    if (plan_is_two_position(s->plan, i))
        two_position_follow(&l->two, l->v);
    else
        pid_follow(&l->pid, l->setpoint, s->measurement[s->plan->loop[i].pv].value, l->v);
}

void law_shift(struct supervisor *s, uint8_t i, num_t v)
{
    struct loop_state *l = &s->loop[i];
    l->v = v;
    if (plan_is_two_position(s->plan, i))
        two_position_follow(&l->two, v);
    else
        pid_shift(&l->pid, v);
}

void law_back(struct supervisor *s, uint8_t i, num_t applied, uint8_t hold)
{
    s->loop[i].stepped = false;
    if (!plan_is_two_position(s->plan, i)) /* two positions have nothing to bring in line */
        pid_back(&s->loop[i].pid, applied, hold);
}

bool law_closes(const struct supervisor *s, uint8_t i)
{
    return s->loop[i].stepped && loop_due(s, i, s->ticks + 1u);
}

void law_close(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    if (l->stepped)
        law_back(s, i, l->v, l->hold);
}
