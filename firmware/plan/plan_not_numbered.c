/* Replaces plan_numbered.c on a board without blocks. */
#include "plan/plan_parts.h"

bool plan_setpoint_ready(const struct plan *plan, uint8_t i, const bool *taken)
{
    return plan->loop[i].outer == PLAN_NONE || taken[plan->loop[i].outer];
}

uint8_t plan_list_controllers(struct plan *plan, uint8_t i, const bool *taken, uint8_t n)
{
    (void)taken;
    plan->listed[n++] = i;
    return n;
}
