/* Replaces plan_numbered.c on a board without blocks. */
#include "plan/plan_parts.h"

bool plan_setpoint_ready(const struct plan *plan, uint8_t i, const bool *taken)
{
    return plan->loop[i].outer == PLAN_NONE || taken[plan->loop[i].outer];
}
