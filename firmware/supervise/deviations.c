#include "supervise/deviations.h"

#include "exchange/span.h"
#include "supervise/blocks.h"

/* Runs the timer. Returns true if the alarm comes or goes. */
static bool lasting_changes(struct lasting *l, bool holds, float delay_s, uint64_t time_ms)
{
    if (holds && !l->holds)
        l->since_ms = (uint32_t)time_ms & LASTING_MS;
    l->holds = holds;
    float lasted_ms = (float)(((uint32_t)time_ms - l->since_ms) & LASTING_MS);
    bool active = holds && (l->active || lasted_ms >= delay_s * 1000.0f);
    bool changes = active != (bool)l->active;
    l->active = active;
    return changes;
}

static bool has_own_deviation(const struct supervisor *s, uint8_t i)
{
    for (uint8_t k = 0; k < s->placed[PLACED_ALARMS]; k++) {
        const struct alarm_config *c = &s->plan->config.alarm[k];
        if (c->on[0] && c->side == ALARM_DEVIATION && s->plan->alarm[k] == i)
            return true;
    }
    return false;
}

static void run_deviation(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    const struct config *c = &s->plan->config;
    const struct measurement_state *m = &s->measurement[s->plan->loop[i].pv];
    bool acts = loop_acts(s, i) && c->deviation.width > 0.0f && !has_own_deviation(s, i);
    /* The deviation is unknown, or an interlock is the reason and has its own alarm. */
    if (acts && (!m->bound || !m->seen || m->alarm || loop_interlocked(s, i)))
        return;
    float width = l->deviation.lasting.active ? 0.8f * c->deviation.width : c->deviation.width;
    num_t distance = num_abs(num_sub(m->value, l->setpoint));
    bool far = acts && num_lt(num_from_float(width), distance);
    if (!lasting_changes(&l->deviation.lasting, far, c->deviation.delay_s, s->time_ms))
        return;
    const struct measurement_config *mc = &c->measurement[s->plan->loop[i].pv];
    event_put(s->events, s->time_ms,
              l->deviation.lasting.active ? EVENT_DEVIATION : EVENT_DEVIATION_OVER, c->loop[i].name,
              num_to_float(distance) * (mc->hi - mc->lo), 0);
}

/* The value that stands in for a lost reading is uncertain too, but the loss itself has its own alarm. */
static void run_doubt(struct supervisor *s, uint8_t i)
{
    struct measurement_state *m = &s->measurement[i];
    const struct measurement_config *c = &s->plan->config.measurement[i];
    bool doubtful = loop_acts_on(s, i) && m->quality == QUALITY_UNCERTAIN && !m->alarm;
    if (lasting_changes(&m->doubt.lasting, doubtful, c->sensor_hold_s, s->time_ms))
        event_put(s->events, s->time_ms,
                  m->doubt.lasting.active ? EVENT_DOUBTFUL : EVENT_DOUBTFUL_OVER, c->name,
                  span_to_eu(m->value, c->lo, c->hi), 0);
}

void deviations_run(struct supervisor *s)
{
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++)
        if (s->plan->loop[i].used)
            run_deviation(s, i);
    for (uint8_t i = 0; i < s->placed[PLACED_MEASUREMENTS]; i++)
        run_doubt(s, i);
}

void deviations_time_back(struct supervisor *s)
{
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++)
        s->loop[i].deviation.lasting.holds = false;
    for (uint8_t i = 0; i < s->placed[PLACED_MEASUREMENTS]; i++)
        s->measurement[i].doubt.lasting.holds = false;
}
