#include "supervise/raise_gain.h"

void supervisor_raise_gain(struct supervisor *s, uint8_t i, float factor)
{
    uint8_t before = s->raised.factor > 0.0f ? s->raised.loop : PLAN_NONE;
    if (before == i)
        return;
    s->raised.factor = i == PLAN_NONE ? 0.0f : factor;
    s->raised.loop = i;
    /* The settings come with the next step, or before the controller takes over. */
    if (before != PLAN_NONE)
        s->block[before].retune = true;
    if (i != PLAN_NONE)
        s->block[i].retune = true;
}

void raised_gain_take(const struct supervisor *s, uint8_t block, struct block_instance *b)
{
    if (!(s->raised.factor > 0.0f) || block != s->raised.loop)
        return;
    b->settings.raised.loop = *(const struct loop_settings *)b->setup.settings;
    b->settings.raised.loop.gain *= s->raised.factor;
    b->setup.settings = &b->settings.raised.loop;
}
