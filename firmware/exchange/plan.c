#include "exchange/plan.h"

#include <string.h>

uint8_t config_find_measurement(const struct config *config, const char *name)
{
    for (uint8_t i = 0; name[0] && i < CHANNEL_MAX; i++)
        if (strcmp(config->measurement[i].name, name) == 0)
            return i;
    return PLAN_NONE;
}

uint8_t config_find_mv(const struct config *config, const char *name)
{
    for (uint8_t i = 0; name[0] && i < CHANNEL_MAX; i++)
        if (strcmp(config->mv[i].name, name) == 0)
            return i;
    return PLAN_NONE;
}

uint8_t config_find_loop(const struct config *config, const char *name)
{
    for (uint8_t i = 0; name[0] && i < CONFIG_LOOPS; i++)
        if (strcmp(config->loop[i].name, name) == 0)
            return i;
    return PLAN_NONE;
}

void plan_setpoint_limits(const struct plan *plan, uint8_t loop, float *lo, float *hi)
{
    const struct loop_config *l = &plan->config.loop[loop];
    const struct measurement_config *m = &plan->config.measurement[plan->loop[loop].pv];
    bool open = l->sp_lo == 0.0f && l->sp_hi == 0.0f;
    *lo = open ? m->lo : l->sp_lo;
    *hi = open ? m->hi : l->sp_hi;
}

void plan_manual_limits(const struct plan *plan, uint8_t output, float *lo, float *hi)
{
    const struct mv_config *o = &plan->config.mv[output];
    *lo = o->min < o->safe ? o->min : o->safe;
    *hi = o->max > o->safe ? o->max : o->safe;
}
