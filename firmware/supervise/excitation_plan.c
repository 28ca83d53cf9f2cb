#include "supervise/excitation_plan.h"

#include <string.h>

#include "exchange/block_settings.h"
#include "exchange/block_setup.h"
#include "exchange/numbered_setup.h"
#include "supervise/block_excitation.h"

/* Compares parts of a configuration as a whole, unused bytes too, as the checksum does. */
static bool same_bytes(const void *a, const void *b, size_t n)
{
    return memcmp(a, b, n) == 0;
}

static bool same_block_in(const struct plan *a, const struct plan *b, uint8_t n)
{
    const struct block_config *x = &a->config.block[n], *y = &b->config.block[n];
    return same_bytes(x->kind, y->kind, sizeof x->kind) && x->bytes == y->bytes &&
           same_bytes(&a->numbered[n], &b->numbered[n], sizeof a->numbered[n]) &&
           same_bytes(config_block_settings(&a->config, n), config_block_settings(&b->config, n),
                      x->bytes) &&
           (!x->bytes || plan_named(a, n) == plan_named(b, n));
}

static bool same_mv_in(const struct plan *a, const struct plan *b, uint8_t j)
{
    return a->owner[j] == b->owner[j] &&
           same_bytes(&a->config.mv[j], &b->config.mv[j], sizeof a->config.mv[j]);
}

static bool same_loops_in(const struct plan *a, const struct plan *b, uint8_t i)
{
    for (unsigned depth = 0; depth < CONFIG_LOOPS && i != PLAN_NONE; depth++) {
        uint8_t pv = a->loop[i].pv;
        if (!same_bytes(&a->config.loop[i], &b->config.loop[i], sizeof a->config.loop[i]) ||
            !same_bytes(&a->config.measurement[pv], &b->config.measurement[pv],
                        sizeof a->config.measurement[pv]))
            return false;
        i = a->loop[i].inner;
    }
    return true;
}

static bool plan_keeps(const struct supervisor *s, const struct plan *next)
{
    const struct excitation_state *e = &s->excitation;
    if (s->plan->tick_s != next->tick_s || s->tick_s != next->tick_s)
        return false;
    bool same = same_block_in(s->plan, next, (uint8_t)(e->holder - 1u));
    for (uint8_t k = 0; k < e->targets; k++) {
        const struct excited *t = &e->target[k];
        same = same && same_mv_in(s->plan, next, excited_mv(s, t)) &&
               same_loops_in(s->plan, next, excited_loop(s, t));
    }
    return same;
}

void excitation_meet_plan(struct supervisor *s, const struct plan *next)
{
    struct excitation_state *e = &s->excitation;
    if (e->holder && !plan_keeps(s, next))
        excitation_end(s, EXCITE_PLAN);
    /* A block of another kind has not asked for anything yet. */
    for (uint8_t n = 0; s->plan && n < CONFIG_BLOCKS; n++)
        if (!same_bytes(s->plan->config.block[n].kind, next->config.block[n].kind,
                        CHANNEL_NAME_SIZE))
            e->answer[n] = (struct excite_answer){EXCITE_OFF, EXCITE_FINE};
}
