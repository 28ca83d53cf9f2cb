#include "supervise/setpoint_limits.h"

#include "exchange/span.h"

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
