#include "supervise/deviations.h"

#if CONFIG_LOOP_GUARD

#include "supervise/blocks.h"

static bool has_own_deviation(const struct supervisor *s, uint8_t i)
{
    for (uint8_t k = 0; k < s->placed[PLACED_ALARMS]; k++) {
        const struct alarm_config *c = &s->plan->config.alarm[k];
        if (c->on[0] && c->side == ALARM_DEVIATION && s->plan->alarm[k] == i)
            return true;
    }
    return false;
}

static void run_one(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    const struct config *c = &s->plan->config;
    const struct measurement_state *m = &s->measurement[s->plan->loop[i].pv];
    bool acts = loop_acts(s, i) && c->deviation_width > 0.0f && !has_own_deviation(s, i);
    if (acts && (!m->bound || !m->seen || m->alarm || loop_interlocked(s, i)))
        return; /* it cannot be seen, or an interlock is the reason and has its own alarm */
    float width = l->deviates ? 0.8f * c->deviation_width : c->deviation_width;
    num_t distance = num_abs(num_sub(m->value, l->setpoint));
    bool far = acts && num_lt(num_from_float(width), distance);
    if (far && !l->far)
        l->far_since_ms = (uint32_t)s->time_ms;
    l->far = far;
    bool deviates = far && (l->deviates || (float)((uint32_t)s->time_ms - l->far_since_ms) >=
                                               c->deviation_delay_s * 1000.0f);
    if (deviates != l->deviates) {
        const struct measurement_config *mc = &c->measurement[s->plan->loop[i].pv];
        event_put(s->events, s->time_ms, deviates ? EVENT_DEVIATION : EVENT_DEVIATION_OVER,
                  c->loop[i].name, num_to_float(distance) * (mc->hi - mc->lo), 0);
    }
    l->deviates = deviates;
}

void deviations_run(struct supervisor *s)
{
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++)
        if (s->plan->loop[i].used)
            run_one(s, i);
}

void deviations_time_back(struct supervisor *s)
{
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++)
        s->loop[i].far = false;
}

#endif
