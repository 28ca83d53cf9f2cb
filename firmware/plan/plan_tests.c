/* Checks the settings of automatic start-up's tests in a plan. */
#include "plan/plan_parts.h"

enum err plan_check_tests(const struct plan *plan, struct config_fault *fault)
{
    const struct config *c = &plan->config;
    for (uint8_t i = 0; i < CHANNEL_MAX; i++) {
        const struct mv_config *o = &c->mv[i];
        if (o->name[0] && o->start_up.step > 0.5f * (o->hi - o->lo))
            return plan_refuse(fault, ERR_RANGE, "mv", i + 1u, "test_step", o->name,
                               "must be half of the span at most");
    }
    for (uint8_t i = 0; i < CONFIG_PAIRS; i++) {
        const struct pair_config *p = &c->pair[i];
        if (!p->measurement[0] && !p->mv[0])
            continue;
        if (config_find_measurement(c, p->measurement) == PLAN_NONE)
            return plan_refuse(fault, ERR_UNKNOWN, "pair", i + 1u, "meas", p->measurement,
                               "must be the name of a configured measurement");
        if (config_find_mv(c, p->mv) == PLAN_NONE)
            return plan_refuse(fault, ERR_UNKNOWN, "pair", i + 1u, "mv", p->mv,
                               "must be the name of a configured manipulated variable");
    }
    return ERR_OK;
}
