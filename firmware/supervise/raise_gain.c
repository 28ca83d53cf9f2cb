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

void raised_gain_take(const struct supervisor *s, uint8_t block, struct block_instance *b)
{
    if (!(s->raised_gain > 0.0f) || block != s->raised_loop)
        return;
    b->settings.own = *(const struct loop_settings *)b->setup.settings;
    b->settings.own.gain *= s->raised_gain;
    b->setup.settings = &b->settings.own;
}
