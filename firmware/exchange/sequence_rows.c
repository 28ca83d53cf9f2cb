#include "exchange/sequence_rows.h"

#include <string.h>

uint8_t sequence_next(const struct config *config, enum sequence_kind kind, int after)
{
    for (int k = after + 1; k < CONFIG_STEPS; k++)
        if (config->step[k].sequence == kind)
            return (uint8_t)k;
    return PLAN_NONE;
}

/* Equal settings have equal bits: unused characters of names are zero, and no number is -0. */
static bool same(const void *a, const void *b, size_t n)
{
    return memcmp(a, b, n) == 0;
}

bool sequence_differs(const struct plan *plan, const struct plan *old)
{
    if (!same(plan->config.step, old->config.step, sizeof plan->config.step) ||
        !same(plan->step, old->step, sizeof plan->step))
        return true;
    /* Loops and outputs it has in its hands are known by their place. */
    for (unsigned i = 0; i < CONFIG_LOOPS; i++)
        if (strcmp(plan->config.loop[i].name, old->config.loop[i].name) != 0 ||
            plan->loop[i].mv != old->loop[i].mv)
            return true;
    return false;
}
