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
static bool same_spans(const struct plan *a, const struct plan *b, uint8_t slot)
{
    struct block_setup x, y;
    plan_setup_numbered(a, (uint8_t)(slot - SLOT_NUMBERED), &x);
    plan_setup_numbered(b, (uint8_t)(slot - SLOT_NUMBERED), &y);
    return same_signals(x.pv, y.pv, x.members) && same_signals(x.input, y.input, x.inputs) &&
           same_signals(x.point, y.point, x.points);
}

static bool same_record(const struct supervisor *s, const struct plan *old, uint8_t slot)
{
    const struct numbered_plan *r = numbered_at(s, slot);
    const struct numbered_plan *before = old ? &old->numbered[slot - SLOT_NUMBERED] : NULL;
    return before && old->block[slot].kind == s->plan->block[slot].kind &&
           old->block[slot].grains == s->plan->block[slot].grains && /* the arena keeps no other */
           old->block[slot].spare == s->plan->block[slot].spare && s->tick_s == s->plan->tick_s &&
           same_list(r->member, r->members, before->member, before->members) &&
           same_list(r->input, r->inputs, before->input, before->inputs) &&
           same_list(r->point, r->points, before->point, before->points) &&
           same_spans(old, s->plan, slot);
}

/* Returns true if the settings have the same effect. If the kind does not compare settings itself, they are
 * compared byte by byte. */
static bool same_settings(const struct supervisor *s, const struct plan *old, uint8_t slot)
{
    uint8_t n = (uint8_t)(slot - SLOT_NUMBERED);
    if (plan_named(old, n) != plan_named(s->plan, n)) /* another place means another table */
        return false;
    if (block_kind_at(s, slot)->same)
        return block_same_settings(s, old, slot);
    return plan_divisor(old, n) == plan_divisor(s->plan, n) &&
           memcmp(config_record(&old->config, n), config_record(&s->plan->config, n),
                  block_kind_at(s, slot)->settings_bytes) == 0;
}

static bool plan_has(const struct plan *plan, uint8_t slot, enum block_stage stage)
{
    return plan->block[slot].kind != PLAN_NONE && plan_kind(plan, slot)->stage == stage;
}

/* Makes loops continue from the outputs they find, because the blocks between them and their MVs, or the values
 * added there, have changed. */
void numbered_moves_loops(struct supervisor *s, const struct plan *plan, uint8_t slot)
{
    const struct numbered_plan *r = &plan->numbered[slot - SLOT_NUMBERED];
    for (uint8_t k = 0; k < r->members && plan_has(plan, slot, STAGE_COMPENSATE); k++)
        if (r->member[k] < s->placed[PLACED_LOOPS])
            s->loop[r->member[k]].moved = true;
    for (uint8_t k = 0; k < r->points && plan_has(plan, slot, STAGE_FEED_FORWARD); k++)
        if (s->plan->owner[r->point[k]] != PLAN_NONE)
            s->loop[s->plan->owner[r->point[k]]].moved = true;
}

/* Returns true if the terms of an element are the same ones, though their settings may differ. */
static bool same_terms(const struct plan *plan, const struct plan *old, uint8_t slot)
{
    const struct numbered_plan *r = &plan->numbered[slot - SLOT_NUMBERED];
    const struct numbered_plan *before = old ? &old->numbered[slot - SLOT_NUMBERED] : NULL;
    return before && plan->block[slot].kind != PLAN_NONE &&
           old->block[slot].kind == plan->block[slot].kind &&
           same_list(r->input, r->inputs, before->input, before->inputs) &&
           same_list(r->point, r->points, before->point, before->points);
}

static void place_record(struct supervisor *s, const struct plan *old, uint8_t slot)
{
    struct block_state *b = &s->block[slot];
    uint8_t n = (uint8_t)(slot - SLOT_NUMBERED);
    bool same = same_record(s, old, slot);
    switch_off_forget_terms(s, old, slot, same_terms(s->plan, old, slot));
    if (!same) { /* clear everything of the block that was here before */
        job_give_up(&s->work[n]);
        s->served[n].on_pending = false;
        raised_forget(s, slot);
        if (old)
            numbered_moves_loops(s, old, slot);
    }
    /* A kind that the build lacks is reported when it is loaded. */
    if (b->kind == PLAN_NONE)
        return;
    if (!same) {
        b->off = b->stepped = b->retune = b->running = false;
        b->acting = 0;
        b->must_follow = true;
        block_give_settings(s, slot, false);
    } else if (!same_settings(s, old, slot)) {
        block_give_settings(s, slot, true);
        if (block_is(s, slot, STAGE_COMPENSATE))
            b->must_follow = true;
        else
            numbered_moves_loops(s, s->plan, slot);
    }
}

void numbered_place(struct supervisor *s, const struct plan *old)
{
    for (uint8_t slot = SLOT_NUMBERED; slot < PLAN_BLOCKS; slot++)
        place_record(s, old, slot);
}
