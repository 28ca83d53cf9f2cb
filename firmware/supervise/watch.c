#include "supervise/watch.h"

#include <string.h>

#include "exchange/sampling.h"

#define YOUNG        3u    /* readings after the first valid one */
#define FAR          0.1f  /* distance, fraction of the span */
#define AGREE        0.25f /* distance, fraction of the distance from the first reading */
#define TWIN_CHANGES 10u

static float apart(float a, float b)
{
    return a > b ? a - b : b - a;
}

bool watch_first_is_wrong(struct supervisor *s, uint8_t i, float value, float before, bool too_fast)
{
    struct measurement_state *m = &s->measurement[i];
    const struct measurement_config *c = &s->plan->config.measurement[i];
    float jump = apart(value, m->last_valid);
    /* One reading that is too fast may be a spike; two that agree are not. */
    bool wrong = too_fast ? apart(value, before) < AGREE * jump : jump > FAR * (c->hi - c->lo);
    if (!m->watch.young || !wrong)
        return false;
    event_put(s->events, s->time_ms, EVENT_FIRST_READING, c->name, m->last_valid, 0);
    return true;
}

void watch_age(struct measurement_state *m, float value)
{
    bool fine = m->fault == MEASUREMENT_FINE;
    if (fine && !m->valid)
        m->watch.young = YOUNG;
    else if (fine && value != m->last_valid)
        m->watch.young = 0;
    else if (m->watch.young)
        m->watch.young--;
}

/* Returns true if a new number came in this tick that differs from the one before. */
static bool changed(const struct supervisor *s, uint8_t i)
{
    const struct measurement_state *m = &s->measurement[i];
    return s->plan->config.measurement[i].name[0] && !plan_is_estimate(s->plan, i) &&
           sampling_every(&s->plan->config.measurement[i]) == 1 && measurement_is_good(m) &&
           m->delivered && m->changed_ms == s->time_ms;
}

static uint8_t twin_of(const struct supervisor *s, uint8_t i)
{
    const struct measurement_config *c = s->plan->config.measurement;
    for (uint8_t k = 0; k < i; k++)
        if (changed(s, k) && s->measurement[k].last == s->measurement[i].last &&
            strcmp(c[k].unit, c[i].unit) == 0)
            return k;
    return PLAN_NONE;
}

void watch_twins(struct supervisor *s)
{
    for (uint8_t i = 1; i < s->placed[PLACED_MEASUREMENTS]; i++) {
        struct measurement_state *m = &s->measurement[i];
        if (!changed(s, i))
            continue;
        uint8_t twin = twin_of(s, i);
        if (twin == PLAN_NONE || twin != m->watch.twin)
            m->watch.twin_changes = 0;
        m->watch.twin = twin;
        if (twin == PLAN_NONE || m->watch.twin_changes == TWIN_CHANGES)
            continue;
        if (++m->watch.twin_changes == TWIN_CHANGES)
            event_put(s->events, s->time_ms, EVENT_SAME_READING,
                      s->plan->config.measurement[i].name, (float)(twin + 1), twin);
    }
}
