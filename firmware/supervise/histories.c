#include "supervise/histories.h"

#include <string.h>

#include "supervise/arena.h"

static struct applied_history *history_at(const struct supervisor *s, uint8_t j)
{
    return j < CHANNEL_MAX && s->plan->history[j] ? arena_history(s, j) : NULL;
}

const struct applied_history *history_of(const struct supervisor *s, uint8_t j)
{
    return history_at(s, j);
}

static void begin_history(struct supervisor *s, uint8_t j)
{
    struct applied_history *h = history_at(s, j);
    if (h)
        applied_history_begin(h, s->plan->history[j], s->mv[j].applied);
}

void histories_begin(struct supervisor *s)
{
    for (uint8_t j = 0; s->plan && j < s->plan->histories; j++)
        begin_history(s, j);
}

static bool same_mv(const struct supervisor *s, const struct plan *old, uint8_t j)
{
    const struct mv_config *o = &s->plan->config.mv[j];
    const struct mv_config *before = old ? &old->config.mv[j] : NULL;
    return before && strcmp(o->name, before->name) == 0 && o->lo == before->lo &&
           o->hi == before->hi && s->tick_s == s->plan->tick_s;
}

static void turn_round(num_t *value, uint16_t n)
{
    for (uint16_t k = 0; k < n / 2u; k++) {
        num_t other = value[n - 1u - k];
        value[n - 1u - k] = value[k];
        value[k] = other;
    }
}

static void oldest_first(struct applied_history *h)
{
    uint16_t first = (uint16_t)(h->newest + 1u);
    turn_round(h->value, first);
    turn_round(h->value + first, (uint16_t)(h->depth - first));
    turn_round(h->value, h->depth);
    h->newest = (uint16_t)(h->depth - 1u);
}

void histories_fit(struct supervisor *s, const struct plan *next)
{
    for (uint8_t j = 0; j < CHANNEL_MAX; j++) {
        uint16_t was = s->history[j], will = next->history[j];
        if (!was || !will || was == will)
            continue;
        struct applied_history *h = arena_history(s, j);
        oldest_first(h);
        if (will > was)
            continue;
        memmove(h->value, h->value + (was - will), will * sizeof h->value[0]);
        h->depth = will;
        h->newest = (uint16_t)(will - 1u);
    }
}

/* Values from before the old depth become the oldest value that is known. */
static void deepen(struct applied_history *h, uint16_t depth)
{
    for (uint16_t k = h->depth; k < depth; k++)
        h->value[k] = h->value[0];
    h->depth = depth;
}

void histories_place(struct supervisor *s, const struct plan *old)
{
    for (uint8_t j = 0; j < s->plan->histories; j++) {
        struct applied_history *h = history_at(s, j);
        if (h && (!h->depth || !same_mv(s, old, j)))
            begin_history(s, j);
        else if (h)
            deepen(h, s->plan->history[j]);
    }
}

void histories_append(struct supervisor *s)
{
    for (uint8_t j = 0; j < s->plan->histories; j++) {
        struct applied_history *h = history_at(s, j);
        if (h)
            applied_history_append(h, s->mv[j].applied);
    }
}
