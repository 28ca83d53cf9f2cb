/* The setpoint that an outer loop gives. The outer loop may act on the estimate of a block. */
#include "supervise/setpoint_cascade.h"
#include "exchange/block_settings.h"
#include "exchange/span.h"
#include "supervise/blocks.h"

/* Returns the rules for the loop below `outer` when `outer` loses the estimate it acts on; NULL if it acts on no
 * such estimate. */
static const struct block_return *return_of(const struct supervisor *s, uint8_t outer)
{
    uint8_t pv = s->plan->loop[outer].pv, n = s->plan->writer[pv];
    if (n == PLAN_NONE)
        return NULL;
    uint16_t place = plan_kind(s->plan, (uint8_t)(BLOCK_NUMBERED + n))->returns;
    const struct numbered_plan *r = &s->plan->numbered[n];
    if (!place)
        return NULL;
    const uint8_t *settings = config_block_settings(&s->plan->config, n);
    const struct block_return *back = (const void *)(settings + place);
    for (uint8_t k = 0; k + 1u < r->points && r->point[k] != pv; k++)
        back++;
    return back;
}

/* Returns true if the outer loop acts on a measurement that is not good. */
static bool is_doubtful(const struct supervisor *s, uint8_t outer)
{
    return loop_acts(s, outer) && s->measurement[s->plan->loop[outer].pv].quality != QUALITY_GOOD;
}

/* In cascade the ramp stands at the last setpoint that came from a good measurement, and the filter at the setpoint
 * with which the cascade began, because neither is needed for anything else. */
num_t setpoint_taken(const struct supervisor *s, uint8_t i, num_t given)
{
    uint8_t outer = s->plan->loop[i].outer;
    const struct block_return *back = return_of(s, outer);
    const struct measurement_config *m = &s->plan->config.measurement[s->plan->loop[i].pv];
    if (back && back->within > 0.0f && is_doubtful(s, outer)) {
        num_t good = ramp_position(&s->loop[i].ramp);
        num_t reach = num_from_float(back->within / (m->hi - m->lo));
        given = num_clamp(given, num_sub(good, reach), num_add(good, reach));
    }
    return setpoint_clamp(s, i, given);
}

void setpoint_return(struct supervisor *s, uint8_t outer)
{
    uint8_t i = s->plan->loop[outer].inner;
    const struct block_return *back = return_of(s, outer);
    if (i == PLAN_NONE || s->loop[i].mode != LOOP_CASCADE || !back || !loop_acts(s, outer))
        return;
    const struct measurement_config *m = &s->plan->config.measurement[s->plan->loop[i].pv];
    bool is_set = back->setpoint != 0.0f || back->within != 0.0f;
    num_t to = is_set ? span_to_fraction(back->setpoint, m->lo, m->hi)
                      : accumulator_get(&s->loop[i].filter.y);
    s->loop[outer].v = setpoint_clamp(s, i, to);
}

void setpoint_from_outer(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    uint8_t outer = s->plan->loop[i].outer;
    l->target = setpoint_taken(s, i, s->loop[outer].v);
    if (!is_doubtful(s, outer))
        ramp_reset(&l->ramp, l->target);
    l->setpoint = l->target;
}
