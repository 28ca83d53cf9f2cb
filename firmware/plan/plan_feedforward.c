/* Feedforward elements ffN of a plan: resolves their sources, and checks that none drives itself. */
#include <string.h>

#include "exchange/block_setup.h"
#include "plan/plan_parts.h"

_Static_assert(CONFIG_FEEDFORWARDS <= 8, "a bit for each in check_feedforward_rings");

/* Feedforward elements that pass an MV on in a ring would drive themselves; one that adds to its own source is the
 * shortest ring. reach[i] has a bit for each element that element i reaches, through any number of others. */
static enum err check_feedforward_rings(const struct plan *plan, struct config_fault *fault)
{
    uint8_t reach[CONFIG_FEEDFORWARDS];
    for (uint8_t i = 0; i < CONFIG_FEEDFORWARDS; i++) {
        reach[i] = 0;
        for (uint8_t k = 0; k < CONFIG_FEEDFORWARDS; k++)
            if (plan->feedforward[i].input != PLAN_NONE &&
                plan->feedforward[k].input == (INPUT_IS_MV | plan->feedforward[i].point))
                reach[i] = (uint8_t)(reach[i] | 1u << k);
    }
    for (uint8_t through = 0; through < CONFIG_FEEDFORWARDS; through++)
        for (uint8_t i = 0; i < CONFIG_FEEDFORWARDS; i++)
            if ((reach[i] & (1u << through)) != 0u)
                reach[i] = (uint8_t)(reach[i] | reach[through]);
    for (uint8_t i = 0; i < CONFIG_FEEDFORWARDS; i++)
        if ((reach[i] & (1u << i)) != 0u)
            return plan_refuse(fault, ERR_CYCLE, "ff", i + 1u, "from",
                               plan->config.feedforward[i].from, "makes a ring of feedforwards");
    return ERR_OK;
}

/* Resolves the source: a measurement of that name, or else a manipulated variable. */
static void resolve_source(struct plan *plan, uint8_t i)
{
    const char *from = plan->config.feedforward[i].from;
    uint8_t input = config_find_measurement(&plan->config, from);
    if (input == PLAN_NONE) {
        input = config_find_mv(&plan->config, from);
        if (input != PLAN_NONE)
            input = (uint8_t)(INPUT_IS_MV | input);
    }
    plan->feedforward[i].input = input;
}

enum err plan_resolve_feedforwards(struct plan *plan, struct config_fault *fault)
{
    for (uint8_t i = 0; i < CONFIG_FEEDFORWARDS; i++) {
        const struct ff_config *f = &plan->config.feedforward[i];
        plan->feedforward[i].input = PLAN_NONE;
        if (!f->from[0])
            continue;
        resolve_source(plan, i);
        if (plan->feedforward[i].input == PLAN_NONE)
            return plan_refuse(fault, ERR_UNKNOWN, "ff", i + 1u, "from", f->from,
                               "must be a configured measurement or manipulated variable");
        plan->feedforward[i].point = config_find_mv(&plan->config, f->to);
        if (plan->feedforward[i].point == PLAN_NONE ||
            plan->owner[plan->feedforward[i].point] == PLAN_NONE)
            return plan_refuse(fault, ERR_UNKNOWN, "ff", i + 1u, "to", f->to,
                               "must be a manipulated variable that a loop drives");
        enum err err = plan_check_feedforward(plan, i, fault);
        if (err)
            return err;
    }
    enum err rings = check_feedforward_rings(plan, fault);
    return rings ? rings : plan_check_rings(plan, fault);
}
