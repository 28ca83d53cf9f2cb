#include "supervise/raise_gain.h"

void supervisor_raise_gain(struct supervisor *s, uint8_t i, float factor)
{
    uint8_t before = s->raised_gain > 0.0f ? s->raised_loop : PLAN_NONE;
    if (before == i)
        return;
    s->raised_gain = i == PLAN_NONE ? 0.0f : factor;
    s->raised_loop = i;
    /* The settings come with the next step, or before the controller takes over. */
    if (before != PLAN_NONE)
        s->block[before].retune = true;
    if (i != PLAN_NONE)
        s->block[i].retune = true;
}
