#include "supervise/numbered_place.h"

#include <string.h>

#include "exchange/block_settings.h"
#include "exchange/block_setup.h"
#include "exchange/numbered_setup.h"
#include "supervise/blocks.h"
#include "supervise/numbered.h"
#include "supervise/raised.h"
#include "supervise/switch_offs.h"

static bool same_list(const uint8_t *a, uint8_t n, const uint8_t *b, uint8_t m)
{
    for (uint8_t k = 0; k < n && k < m; k++)
        if (a[k] != b[k])
            return false;
    return n == m;
}

static bool same_signals(const struct block_signal *a, const struct block_signal *b, uint8_t n)
{
    for (uint8_t k = 0; k < n; k++)
        if (a[k].lo != b[k].lo || a[k].hi != b[k].hi)
            return false;
    return true;
}

/* Compares the spans of the signals of a block whose lists of signals are the same. */
static bool same_spans(const struct plan *a, const struct plan *b, uint8_t block)
{
    struct block_setup x, y;
    plan_setup_numbered(a, (uint8_t)(block - BLOCK_NUMBERED), &x);
    plan_setup_numbered(b, (uint8_t)(block - BLOCK_NUMBERED), &y);
    return same_signals(x.pv, y.pv, x.members) && same_signals(x.input, y.input, x.inputs) &&
           same_signals(x.point, y.point, x.points);
}

static bool same_block(const struct supervisor *s, const struct plan *old, uint8_t block)
{
    const struct numbered_plan *r = numbered_at(s, block);
    const struct numbered_plan *before = old ? &old->numbered[block - BLOCK_NUMBERED] : NULL;
    return before && old->block[block].kind == s->plan->block[block].kind &&
           old->block[block].grains ==
               s->plan->block[block].grains && /* the arena keeps no other */
           old->block[block].spare == s->plan->block[block].spare &&
           s->tick_s == s->plan->tick_s &&
           same_list(r->member, r->members, before->member, before->members) &&
           same_list(r->input, r->inputs, before->input, before->inputs) &&
           same_list(r->point, r->points, before->point, before->points) &&
           same_spans(old, s->plan, block);
}

/* Returns true if the settings have the same effect. If the kind does not compare settings itself, they are
 * compared byte by byte. */
static bool same_settings(const struct supervisor *s, const struct plan *old, uint8_t block)
{
    uint8_t n = (uint8_t)(block - BLOCK_NUMBERED);
    if (plan_named(old, n) != plan_named(s->plan, n)) /* another place means another table */
        return false;
    if (block_kind_at(s, block)->same)
        return block_same_settings(s, old, block);
    return plan_divisor(old, n) == plan_divisor(s->plan, n) &&
           memcmp(config_block_settings(&old->config, n),
                  config_block_settings(&s->plan->config, n),
                  block_kind_at(s, block)->settings_bytes) == 0;
}

static bool plan_has(const struct plan *plan, uint8_t block, enum block_stage stage)
{
    return plan->block[block].kind != PLAN_NONE && plan_kind(plan, block)->stage == stage;
}

/* Makes loops continue from the outputs they find, because the blocks between them and their MVs, or the values
 * added there, have changed. */
void numbered_moves_loops(struct supervisor *s, const struct plan *plan, uint8_t block)
{
    const struct numbered_plan *r = &plan->numbered[block - BLOCK_NUMBERED];
    for (uint8_t k = 0; k < r->members && plan_has(plan, block, STAGE_COMPENSATE); k++)
        if (r->member[k] < s->placed[PLACED_LOOPS])
            s->loop[r->member[k]].moved = true;
    for (uint8_t k = 0; k < r->points && plan_has(plan, block, STAGE_FEED_FORWARD); k++)
        if (s->plan->owner[r->point[k]] != PLAN_NONE)
            s->loop[s->plan->owner[r->point[k]]].moved = true;
}

/* Returns true if the terms of a feedforward element are the same ones, though their settings may differ. */
static bool same_terms(const struct plan *plan, const struct plan *old, uint8_t block)
{
    const struct numbered_plan *r = &plan->numbered[block - BLOCK_NUMBERED];
    const struct numbered_plan *before = old ? &old->numbered[block - BLOCK_NUMBERED] : NULL;
    return before && plan->block[block].kind != PLAN_NONE &&
           old->block[block].kind == plan->block[block].kind &&
           same_list(r->input, r->inputs, before->input, before->inputs) &&
           same_list(r->point, r->points, before->point, before->points);
}

static void place_block(struct supervisor *s, const struct plan *old, uint8_t block)
{
    struct block_state *b = &s->block[block];
    uint8_t n = (uint8_t)(block - BLOCK_NUMBERED);
    bool same = same_block(s, old, block);
    switch_off_forget_terms(s, old, block, same_terms(s->plan, old, block));
    if (!same) { /* clear everything of the block that was here before */
        job_give_up(&s->work[n]);
        s->numbered[n].on_pending = false;
        raised_forget(s, block);
        if (old)
            numbered_moves_loops(s, old, block);
    }
    /* A kind that the build lacks is reported when it is loaded. */
    if (b->kind == PLAN_NONE)
        return;
    if (!same) {
        b->off = b->stepped = b->retune = b->running = false;
        b->acting = 0;
        b->must_follow = true;
        block_give_settings(s, block, false);
    } else if (!same_settings(s, old, block)) {
        block_give_settings(s, block, true);
        if (block_is(s, block, STAGE_COMPENSATE))
            b->must_follow = true;
        else
            numbered_moves_loops(s, s->plan, block);
    }
}

void numbered_place(struct supervisor *s, const struct plan *old)
{
    for (uint8_t block = BLOCK_NUMBERED; block < PLAN_BLOCKS; block++)
        place_block(s, old, block);
}
