/* Limits, ramp and filter of setpoints, and where they come from in each mode. */
#include "supervise/setpoint.h"
#include "exchange/block_settings.h"
#include "exchange/span.h"
#include "supervise/block_excitation.h"
#include "supervise/blocks.h"

num_t setpoint_clamp(const struct supervisor *s, uint8_t i, num_t setpoint)
{
    const struct measurement_config *m = &s->plan->config.measurement[s->plan->loop[i].pv];
    float lo, hi;
    plan_setpoint_limits(s->plan, i, &lo, &hi);
    return num_clamp(setpoint, span_to_fraction(lo, m->lo, m->hi),
                     span_to_fraction(hi, m->lo, m->hi));
}

void setpoint_rest(struct loop_state *l, num_t at)
{
    ramp_reset(&l->ramp, at);
    lag_reset(&l->filter, at);
}

#if CONFIG_BLOCKS

/* What holds for the loop below `outer` when the estimate that `outer` acts on is lost; NULL: it acts on no such estimate. */
static const struct block_return *return_of(const struct supervisor *s, uint8_t outer)
{
    uint8_t pv = s->plan->loop[outer].pv, n = s->plan->writer[pv];
    if (n == PLAN_NONE)
        return NULL;
    uint16_t place = plan_kind(s->plan, (uint8_t)(SLOT_RECORDS + n))->returns;
    const struct record_plan *r = &s->plan->record[n];
    if (!place)
        return NULL;
    const uint8_t *settings = config_record(&s->plan->config, n);
    const struct block_return *back = (const void *)(settings + place);
    for (uint8_t k = 0; k + 1u < r->points && r->point[k] != pv; k++)
        back++;
    return back;
}

/* It acts on a measurement that is not good. */
static bool is_doubtful(const struct supervisor *s, uint8_t outer)
{
    return loop_acts(s, outer) && s->measurement[s->plan->loop[outer].pv].quality != QUALITY_GOOD;
}

/* In cascade the ramp stands at the last setpoint that came from a good measurement, and the filter at the one with which the cascade
 * began: neither is needed for anything else. */
num_t setpoint_taken(const struct supervisor *s, uint8_t i, num_t given)
{
    uint8_t outer = s->plan->loop[i].outer;
    const struct block_return *back = return_of(s, outer);
    const struct measurement_config *m = &s->plan->config.measurement[s->plan->loop[i].pv];
    if (back && back->within > 0.0f && is_doubtful(s, outer)) {
        num_t good = accumulator_get(&s->loop[i].ramp.at);
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

static void setpoint_from_outer(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    uint8_t outer = s->plan->loop[i].outer;
    l->target = setpoint_taken(s, i, s->loop[outer].v);
    if (!is_doubtful(s, outer))
        ramp_reset(&l->ramp, l->target);
    l->setpoint = l->target;
}

#else

static void setpoint_from_outer(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    l->target = l->setpoint = setpoint_clamp(s, i, s->loop[s->plan->loop[i].outer].v);
    setpoint_rest(l, l->setpoint);
}

#endif

num_t setpoint_found(const struct supervisor *s, uint8_t i)
{
    const struct loop_state *l = &s->loop[i];
    return l->mode == LOOP_AUTO ? loop_own_setpoint(l) : s->measurement[s->plan->loop[i].pv].value;
}

void setpoint_advance(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    if (l->mode == LOOP_CASCADE)
        setpoint_from_outer(s, i);
    else
        l->setpoint = lag_step(&l->filter, ramp_step(&l->ramp, l->target));
    excitation_add(s, i);
}

/* In manual the setpoint waits where automatic will begin: at the measurement, unless the operator wants
 * his own setpoint kept and a jump there. */
void setpoint_idle(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    const struct loop_config *c = &s->plan->config.loop[i];
    num_t pv = s->measurement[s->plan->loop[i].pv].value;
    if (c->sp_track || !l->sp_given)
        l->target = setpoint_clamp(s, i, pv);
    bool jump = c->sp_ramp_per_min == 0.0f && c->sp_filter_s == 0.0f;
    l->setpoint = jump ? l->target : pv;
}

void setpoint_start(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    if (l->mode == LOOP_CASCADE) {
        setpoint_from_outer(s, i);
        return;
    }
    setpoint_idle(s, i);
    setpoint_rest(l, l->setpoint);
}
