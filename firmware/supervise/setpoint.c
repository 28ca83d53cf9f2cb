/* Limits, ramp and filter of setpoints, and the source of a setpoint in each mode. */
#include "supervise/setpoint.h"
#include "exchange/block_settings.h"
#include "exchange/span.h"
#include "supervise/block_excitation.h"
#include "supervise/blocks.h"
#include "supervise/setpoint_cascade.h"
#include "supervise/setpoint_limits.h"

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

/* In manual the setpoint waits where automatic will begin. That is at the measurement, unless the operator wants
 * the given setpoint kept and a jump to it. */
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
