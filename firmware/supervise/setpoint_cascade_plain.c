/* Replaces setpoint_cascade.c on a board without blocks, which has no estimates. */
#include "supervise/setpoint_cascade.h"

void setpoint_from_outer(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    l->target = l->setpoint = setpoint_clamp(s, i, s->loop[s->plan->loop[i].outer].v);
    setpoint_rest(l, l->setpoint);
}
