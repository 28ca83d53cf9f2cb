#include "supervise/serve.h"

#include <string.h>

#include "exchange/block_settings.h"
#include "exchange/block_setup.h"
#include "exchange/numbered_setup.h"
#include "exchange/span.h"
#include "supervise/blocks.h"
#include "supervise/compensate.h"
#include "supervise/numbered.h"
#include "supervise/raised.h"
#include "supervise/switch_offs.h"
#include "supervise/validate.h"

/* ---- plans ---- */

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
static void loops_moved(struct supervisor *s, const struct plan *of, uint8_t slot)
{
    const struct numbered_plan *r = &of->numbered[slot - SLOT_NUMBERED];
    for (uint8_t k = 0; k < r->members && plan_has(of, slot, STAGE_COMPENSATE); k++)
        if (r->member[k] < s->placed[PLACED_LOOPS])
            s->loop[r->member[k]].moved = true;
    for (uint8_t k = 0; k < r->points && plan_has(of, slot, STAGE_FEED_FORWARD); k++)
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
            loops_moved(s, old, slot);
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
            loops_moved(s, s->plan, slot);
    }
}

void serve_place(struct supervisor *s, const struct plan *old)
{
    for (uint8_t slot = SLOT_NUMBERED; slot < PLAN_BLOCKS; slot++)
        place_record(s, old, slot);
}

/* ---- giving up and coming back ---- */

static void come_on(struct supervisor *s, uint8_t slot)
{
    uint8_t n = (uint8_t)(slot - SLOT_NUMBERED);
    s->served[n].on_pending = false;
    if (!block_is(s, slot, STAGE_CONTROL)) /* the reason for giving up may be in its state */
        block_give_settings(s, slot, false);
    s->block[slot].off = false;
    s->block[slot].must_follow = true;
    raised_forget(s, slot);
    event_put(s->events, s->time_ms, EVENT_BLOCK_ON, s->plan->config.block[n].kind, (float)(n + 1u),
              0);
}

/* The main loop may be in the midst of a piece of the block's work, which the tick has interrupted. The tick clears
 * the block's state only after the end of that piece. */
static void come_on_when_idle(struct supervisor *s, uint8_t slot)
{
    if (job_is_working(&s->work[slot - SLOT_NUMBERED]))
        s->served[slot - SLOT_NUMBERED].on_pending = true;
    else
        come_on(s, slot);
}

bool serve_switch(struct supervisor *s, uint8_t n, bool on)
{
    uint8_t slot = (uint8_t)(SLOT_NUMBERED + n);
    if (n >= CONFIG_BLOCKS || s->block[slot].kind == PLAN_NONE || block_is(s, slot, STAGE_ESTIMATE))
        return false;
    s->served[n].on_pending = false;
    if (s->block[slot].off != on)
        return true;
    if (!on) {
        block_give_up(s, slot, "asked");
        raised_forget(s, slot);
        if (block_is(s, slot, STAGE_FEED_FORWARD))
            loops_moved(s, s->plan, slot);
        s->block[slot].running = false;
        return true;
    }
    come_on_when_idle(s, slot);
    return true;
}

static void members_to_manual(struct supervisor *s, uint8_t slot)
{
    const struct numbered_plan *r = numbered_at(s, slot);
    for (uint8_t k = 0; k < r->members; k++)
        loop_to_manual(s, r->member[k]);
}

void serve_check_inputs(struct supervisor *s)
{
    for (uint8_t slot = SLOT_NUMBERED; slot < numbered_end(s); slot++) {
        const struct numbered_plan *r = numbered_at(s, slot);
        if (s->served[slot - SLOT_NUMBERED].on_pending)
            come_on_when_idle(s, slot);
        if (!s->plan->config.block[slot - SLOT_NUMBERED].kind[0])
            continue;
        if (s->block[slot].kind == PLAN_NONE) { /* this build cannot run it */
            members_to_manual(s, slot);
            continue;
        }
        bool acts = false;
        for (uint8_t k = 0; k < r->members; k++)
            acts = acts || loop_drives(s, r->member[k]);
        if (s->block[slot].off || !acts || block_kind_at(s, slot)->bad_input == BAD_INPUT_IS_TOLD)
            continue;
        uint8_t bad = first_bad_input(s, slot);
        if (bad == PLAN_NONE)
            continue;
        if (block_kind_at(s, slot)->bad_input == BAD_INPUT_MANUAL)
            members_to_manual(s, slot);
        else
            block_give_up_without(s, slot, bad);
    }
}

/* ---- steps ---- */

/* Returns true if the input has given a number, or has been found bad: an estimator does not wait for a sensor that
 * is dead from the start. It waits for an analyser until the analyser's first turn. */
static bool input_has_come(const struct supervisor *s, uint8_t input)
{
    if (input & INPUT_IS_MV)
        return s->mv[input & ~INPUT_IS_MV].bound;
    const struct measurement_state *m = &s->measurement[input];
    return m->bound && (m->seen || m->alarm);
}

static void give_points(struct supervisor *s, uint8_t slot, const struct gathered *g)
{
    const struct numbered_plan *r = numbered_at(s, slot);
    bool there = true;
    for (uint8_t k = 0; k < r->inputs; k++)
        there = there && input_has_come(s, r->input[k]);
    for (uint8_t k = 0; k < r->points; k++) {
        uint8_t i = r->point[k];
        const struct measurement_config *m = &s->plan->config.measurement[i];
        struct reading reading = {span_to_eu(g->point[k], m->lo, m->hi),
                                  (enum quality)g->numbered.point_quality[k]};
        /* A point is bound once all inputs of its block have come, and stays so as long as they are bound. */
        s->measurement[i].bound = there || s->measurement[i].bound;
        validate_measurement(s, i, &reading);
    }
}

void serve_forget(struct supervisor *s)
{
    for (uint8_t slot = SLOT_NUMBERED; slot < PLAN_BLOCKS; slot++) {
        s->block[slot].must_follow = true;
        s->block[slot].running = false;
    }
}

void serve_estimate(struct supervisor *s)
{
    uint8_t end = plan_stage_end(s->plan, STAGE_ESTIMATE);
    for (uint8_t k = plan_stage_begin(s->plan, STAGE_ESTIMATE); k < end; k++) {
        uint8_t slot = s->plan->listed[k];
        struct gathered g;
        gather(s, slot, &g);
        if (s->block[slot].must_follow && block_kind_at(s, slot)->follow)
            block_kind_at(s, slot)->follow(supervisor_block(s, slot), &g.io);
        s->block[slot].must_follow = false;
        numbered_step(s, slot, &g);
        numbered_grant(s, slot, &g);
        give_points(s, slot, &g);
    }
}

void serve_must_follow(struct supervisor *s, uint8_t slot)
{
    s->block[slot].must_follow = true;
}

void serve_follow(struct supervisor *s)
{
    uint8_t end = plan_stage_end(s->plan, STAGE_CONTROL);
    for (uint8_t k = plan_stage_begin(s->plan, STAGE_CONTROL); k < end; k++) {
        uint8_t slot = s->plan->listed[k];
        struct block_state *b = &s->block[slot];
        if (!b->must_follow)
            continue;
        struct gathered g;
        gather(s, slot, &g);
        block_kind_at(s, slot)->follow(supervisor_block(s, slot), &g.io);
        b->must_follow = b->stepped = false;
    }
}

/* Steps the loops' own controllers, which act now, in this tick. */
static void own_step(struct supervisor *s, uint8_t slot, uint8_t acting)
{
    const struct numbered_plan *r = numbered_at(s, slot);
    for (uint8_t k = 0; k < r->members; k++)
        if (acting & (1u << k))
            block_step(s, r->member[k]);
}

/* Returns true if the outputs are plausible. An output of a hundred spans means a controller that runs away: in
 * floating point it would go on to infinity. */
static bool gives_numbers(const struct gathered *g, uint8_t members)
{
    for (uint8_t k = 0; k < members; k++)
        if ((g->io.members.acting & (1u << k)) &&
            (!is_a_number(g->out[k]) || !num_lt(num_abs(g->out[k]), num_from_float(COMMAND_MAX))))
            return false;
    return true;
}

void serve_step(struct supervisor *s, uint8_t i)
{
    uint8_t slot = loop_server(s, i);
    if (slot == PLAN_NONE || numbered_at(s, slot)->last != i || !block_is(s, slot, STAGE_CONTROL) ||
        !loop_due(s, i, s->ticks))
        return;
    const struct numbered_plan *r = numbered_at(s, slot);
    const struct block_kind *kind = block_kind_at(s, slot);
    struct gathered g;
    gather(s, slot, &g);
    if (!g.io.members.acting) {
        raised_forget(s, slot);
        return;
    }
    /* The last step had no back-calculation yet: as if nothing had limited its outputs. */
    if (s->block[slot].stepped)
        kind->back_calculate(supervisor_block(s, slot), &g.io);
    numbered_step(s, slot, &g);
    if (!g.io.requests.gives_up && !gives_numbers(&g, r->members))
        g.io.requests.gives_up = NOT_A_NUMBER;
    if (g.io.requests.gives_up) {
        block_give_up(s, slot, g.io.requests.gives_up);
        own_step(s, slot, g.io.members.acting);
        return;
    }
    numbered_grant(s, slot, &g);
    for (uint8_t k = 0; k < r->members; k++) {
        if (!(g.io.members.acting & (1u << k)))
            continue;
        s->loop[r->member[k]].v = g.out[k];
        s->loop[r->member[k]].limited = g.numbered.limited[k];
    }
    s->block[slot].stepped = true;
}

void serve_back_calculate(struct supervisor *s)
{
    uint8_t end = plan_stage_end(s->plan, STAGE_CONTROL);
    for (uint8_t listed = plan_stage_begin(s->plan, STAGE_CONTROL); listed < end; listed++) {
        uint8_t slot = s->plan->listed[listed];
        struct block_state *b = &s->block[slot];
        const struct numbered_plan *r = numbered_at(s, slot);
        struct gathered g;
        gather(s, slot, &g);
        if (b->off || !g.io.members.acting || b->must_follow) {
            b->must_follow = !b->off; /* it follows before it acts again */
            continue;
        }
        if (!b->stepped || !loop_due(s, r->member[0], s->ticks + 1u))
            continue;
        for (uint8_t k = 0; k < r->members; k++)
            if (g.io.members.acting & (1u << k))
                g.out[k] = s->loop[r->member[k]].served.applied;
        b->stepped = false;
        block_kind_at(s, slot)->back_calculate(supervisor_block(s, slot), &g.io);
        for (uint8_t k = 0; k < r->members; k++)
            if (g.io.members.acting & (1u << k))
                s->loop[r->member[k]].limited = g.numbered.limited[k];
    }
}
