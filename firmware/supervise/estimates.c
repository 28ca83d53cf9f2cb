#include "supervise/estimates.h"

#include "exchange/span.h"

void estimates_keep(struct supervisor *s)
{
    for (uint8_t i = 0; s->plan->numbered_end && i < s->placed[PLACED_MEASUREMENTS]; i++) {
        struct measurement_state *m = &s->measurement[i];
        const struct measurement_config *c = &s->plan->config.measurement[i];
        if (!plan_is_estimate(s->plan, i))
            continue;
        /* An estimate that is held or substituted itself stands in for nothing. */
        m->estimate.stands_in =
            m->bound && m->seen && m->fault == MEASUREMENT_FINE && quality_usable(m->quality);
        m->estimate.value = span_to_eu(m->value, c->lo, c->hi);
    }
}

bool estimate_stands_in(const struct measurement_state *m, float *value)
{
    *value = m->estimate.value;
    return m->estimate.stands_in;
}
