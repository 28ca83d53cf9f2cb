#include "supervise/sampling.h"

#include <string.h>

/* Returns how long ago the newest sample came, ms. *turn gets the base tick of that, since the plant began. */
static uint64_t came_ago_ms(const struct supervisor *s, uint8_t i, uint32_t *turn)
{
    const struct measurement_config *c = &s->plan->config.measurement[i];
    uint32_t tick_ms = sampling_tick_ms(s->plan);
    /* The nearest tick counts, because a plant's clock need not hit the base tick to the millisecond. */
    uint64_t now = (s->time_ms + tick_ms / 2u) / tick_ms;
    uint32_t since = (uint32_t)((now + c->analyser.every - c->analyser.phase) % c->analyser.every);
    *turn = (uint32_t)(now - since);
    return (uint64_t)since * tick_ms;
}

bool sampling_is_due(struct supervisor *s, uint8_t i)
{
    struct measurement_state *m = &s->measurement[i];
    uint32_t turn;
    uint64_t ago_ms = came_ago_ms(s, i, &turn);
    bool news = !m->seen || turn != m->analyser.turn;
    /* The first reading after lost ticks or after a start counts as well, because it belongs to that turn. */
    if (news) {
        m->analyser.turn = turn;
        m->analyser.sample_ms = ago_ms < s->time_ms ? s->time_ms - ago_ms : 0;
    }
    m->analyser.fresh = news || m->fault != MEASUREMENT_FINE;
    return m->analyser.fresh;
}

static uint16_t pv_every(const struct plan *plan, uint8_t loop)
{
    return sampling_every(&plan->config.measurement[plan->loop[loop].pv]);
}

static bool divisor_fits(const struct plan *plan, uint8_t loop)
{
    return !plan->loop[loop].used || plan->config.loop[loop].divisor % pv_every(plan, loop) == 0;
}

void sampling_tell(struct supervisor *s, const struct plan *old)
{
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++) {
        const struct plan *plan = s->plan;
        if (divisor_fits(plan, i))
            continue;
        uint16_t every = pv_every(plan, i);
        bool told = old && old->loop[i].used && pv_every(old, i) == every &&
                    old->config.loop[i].divisor == plan->config.loop[i].divisor &&
                    strcmp(old->config.loop[i].name, plan->config.loop[i].name) == 0;
        if (!told)
            event_put(s->events, s->time_ms, EVENT_LOOP_DIVISOR, plan->config.loop[i].name,
                      (float)every, 0);
    }
}
