#include "exchange/reach.h"

#include <string.h>

float plan_own_reach(const struct plan *plan, uint8_t i)
{
    float below = 0.0f, above = 1.0f;
    for (uint8_t k = 0; k < CONFIG_FEEDFORWARDS; k++) {
        const struct ff_config *f = &plan->config.feedforward[k];
        if (!f->from[0] || strcmp(f->to, plan->config.loop[i].out) != 0)
            continue;
        below += f->hi > 0.0f ? f->hi : 0.0f;
        above -= f->lo < 0.0f ? f->lo : 0.0f;
    }
    below += plan_added_reach(plan, plan->loop[i].mv);
    above += plan_added_reach(plan, plan->loop[i].mv);
    return below > above ? below : above;
}

float plan_added_reach(const struct plan *plan, uint8_t output)
{
    float reach = 0.0f;
    for (uint8_t n = 0; CONFIG_BLOCKS && n < plan->numbered_end; n++)
        for (uint8_t k = 0; k < plan->numbered[n].points; k++)
            if (plan_has_stage(plan, n, STAGE_FEED_FORWARD) && plan->numbered[n].point[k] == output)
                reach += PLAN_ADDED_MOST;
    return reach;
}

/* A compensator has no bound if another one stands behind it, because nobody knows what that one makes of its
 * outputs. */
float plan_member_reach(const struct plan *plan, uint8_t n, uint8_t i)
{
    for (uint8_t behind = (uint8_t)(n + 1u); CONFIG_BLOCKS && behind < plan->numbered_end; behind++)
        for (uint8_t k = 0; k < plan->numbered[behind].members; k++)
            if (plan_has_stage(plan, behind, STAGE_COMPENSATE) &&
                plan->numbered[behind].member[k] == i)
                return NUM_MAX_MAGNITUDE;
    return plan_own_reach(plan, i);
}
