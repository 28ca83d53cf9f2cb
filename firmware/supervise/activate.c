/* Puts a plan into force: decides which states stay, and which begin anew. */
#include <string.h>

#include "exchange/arena_sizes.h"
#include "exchange/block_setup.h"
#include "exchange/calibration.h"
#include "supervise/alarms.h"
#include "supervise/arena.h"
#include "supervise/blocks.h"
#include "supervise/by_board.h"
#include "supervise/excitation_plan.h"
#include "supervise/histories.h"
#include "supervise/numbered_place.h"
#include "supervise/raise_gain.h"
#include "supervise/sampling.h"
#include "supervise/sequence.h"
#include "supervise/setpoint.h"
#include "supervise/setpoint_cascade.h"
#include "supervise/setpoint_limits.h"
#include "supervise/supervisor.h"
#include "supervise/switch_offs.h"

/* Returns true if loop i of both plans is the same loop; old may be NULL. The numbers in its state are fractions,
 * which keep their meaning only while names, spans and control law stay. */
static bool same_loop(const struct plan *plan, const struct plan *old, uint8_t i)
{
    if (!old || !old->loop[i].used)
        return false;
    const struct loop_config *c = &plan->config.loop[i];
    const struct loop_config *before = &old->config.loop[i];
    uint8_t pv = plan->loop[i].pv, output = plan->loop[i].mv;
    if (strcmp(c->name, before->name) != 0 || strcmp(c->pv, before->pv) != 0 ||
        strcmp(c->out, before->out) != 0 || old->loop[i].pv != pv || old->loop[i].mv != output ||
        old->block[i].kind != plan->block[i].kind)
        return false;
    const struct measurement_config *m = &plan->config.measurement[pv];
    const struct measurement_config *m_before = &old->config.measurement[pv];
    if (m->lo != m_before->lo || m->hi != m_before->hi)
        return false;
    if (output == PLAN_NONE)
        return true;
    const struct mv_config *o = &plan->config.mv[output];
    const struct mv_config *o_before = &old->config.mv[output];
    return o->lo == o_before->lo && o->hi == o_before->hi;
}

static void place_setpoint(struct supervisor *s, const struct plan *old, uint8_t i, float h)
{
    struct loop_state *l = &s->loop[i];
    const struct loop_config *c = &s->plan->config.loop[i];
    const struct measurement_config *m = &s->plan->config.measurement[s->plan->loop[i].pv];
    /* The plan's check covered both: rates and times cannot be refused here. */
    (void)!ramp_retune(&l->ramp, c->sp_ramp_per_min / 60.0f / (m->hi - m->lo), h);
    (void)!lag_retune(&l->filter, c->sp_filter_s, h);
    /* The setpoint rests anew in two cases: it is the loop's first one, or the filter has been switched off, so
     * that the ramp must continue from the filter's end. */
    if (old && (c->sp_filter_s > 0.0f || !(old->config.loop[i].sp_filter_s > 0.0f)))
        return;
    if (CONFIG_BLOCKS && l->mode == LOOP_CASCADE) /* setpoint_taken() */
        return;
    setpoint_rest(l, l->setpoint);
}

static void place_loop(struct supervisor *s, const struct plan *old, uint8_t i)
{
    const struct plan *plan = s->plan;
    struct loop_state *l = &s->loop[i];
    const char *before = old ? old->config.loop[i].name : NULL;
    if (!plan->loop[i].used) {
        if (l->mode != LOOP_MANUAL)
            event_put(s->events, s->time_ms, EVENT_MODE, before, (float)LOOP_MANUAL, LOOP_MANUAL);
        by_board_place(s, old, i, false);
        memset(l, 0, sizeof *l);
        return;
    }
    const struct loop_config *c = &plan->config.loop[i];
    uint8_t pv = plan->loop[i].pv;
    const struct measurement_config *m = &plan->config.measurement[pv];
    float h = plan->tick_s * (float)c->divisor;
    bool same = same_loop(plan, old, i);
    num_t pv_value = s->measurement[pv].value;
    if (!same) {
        if (l->mode != LOOP_MANUAL)
            event_put(s->events, s->time_ms, EVENT_MODE, before, (float)LOOP_MANUAL, LOOP_MANUAL);
        by_board_place(s, old, i, l->mode != LOOP_MANUAL);
        memset(l, 0, sizeof *l);
        l->target = l->setpoint = pv_value;
    }
    if (same)
        block_configure(s, old, i);
    else
        block_begin(s, i);
    if (same && plan->loop[i].decouple != old->loop[i].decouple)
        l->moved = true;
    uint8_t outer = plan->loop[i].outer;
    if (l->mode == LOOP_CASCADE && (outer == PLAN_NONE || !same_loop(plan, old, outer))) {
        l->mode = LOOP_AUTO; /* at the setpoint in force, because the old outer loop is gone */
        if (CONFIG_BLOCKS)
            setpoint_rest(l, l->setpoint);
        event_put(s->events, s->time_ms, EVENT_MODE, c->name, (float)LOOP_AUTO, LOOP_AUTO);
    }
    float lo, hi;
    plan_setpoint_limits(plan, i, &lo, &hi);
    if (l->mode != LOOP_MANUAL)
        l->target = num_clamp(l->target, span_to_fraction(lo, m->lo, m->hi),
                              span_to_fraction(hi, m->lo, m->hi));
    place_setpoint(s, same ? old : NULL, i, h);
}

static void place_mv(struct supervisor *s, const struct plan *old, uint8_t j)
{
    const struct mv_config *o = &s->plan->config.mv[j];
    const struct mv_config *before = old ? &old->config.mv[j] : NULL;
    struct mv_state *state = &s->mv[j];
    bool same = before && o->name[0] && strcmp(o->name, before->name) == 0;
    if (!same)
        memset(state, 0, sizeof *state);
    if (o->name[0]) /* checked with the plan */
        (void)!ramp_retune(&state->rate, o->rate_per_s / (o->hi - o->lo), s->plan->tick_s);
    if (same) {
        /* A new span gives the same engineering values new fractions. */
        float manual = span_to_eu(state->manual, before->lo, before->hi);
        float sent = span_to_eu(state->constrained, before->lo, before->hi);
        if (o->lo != before->lo || o->hi != before->hi) {
            state->manual = span_to_fraction(manual, o->lo, o->hi);
            state->constrained = state->applied = span_to_fraction(sent, o->lo, o->hi);
            state->excitation = num_zero(); /* it was a fraction of the old span */
        }
        if (s->state == SUPERVISOR_SAFE)
            state->manual = span_to_fraction(o->safe, o->lo, o->hi);
        return;
    }
    if (o->name[0])
        state->manual = state->constrained = state->applied =
            span_to_fraction(o->safe, o->lo, o->hi);
}

static void place_measurement(struct supervisor *s, const struct plan *old, uint8_t i)
{
    const struct measurement_config *m = &s->plan->config.measurement[i];
    const struct measurement_config *before = old ? &old->config.measurement[i] : NULL;
    struct measurement_state *state = &s->measurement[i];
    bool same = before && m->name[0] && strcmp(m->name, before->name) == 0;
    if (!same && measurement_offset_is_on(state))
        event_put(s->events, s->time_ms, EVENT_OFFSET, before ? before->name : "", 0.0f, 0);
    if (!same)
        *state =
            (struct measurement_state){.quality = QUALITY_MISSING, .fault = MEASUREMENT_MISSING};
    bool moved =
        same && (m->lo != before->lo || m->hi != before->hi || !same_calibration(m, before));
    if (moved) {
        float value = span_to_eu(state->value, before->lo, before->hi);
        state->value = span_to_fraction(recalibrated(m, before, value), m->lo, m->hi);
        state->last_valid = recalibrated(m, before, state->last_valid);
    }
    if (!m->name[0])
        return;
    (void)!lag_retune(&state->filter, m->filter_s, s->plan->tick_s * sampling_every(m));
    if (!same || moved)
        lag_reset(&state->filter, state->value);
}

/* Makes the loop on this output continue from the output it finds at the next tick, because what is added to it
 * changes. */
static void rejoin(struct supervisor *s, const char *output)
{
    uint8_t j = config_find_mv(&s->plan->config, output);
    if (j != PLAN_NONE && s->plan->owner[j] != PLAN_NONE)
        s->loop[s->plan->owner[j]].moved = true;
}

/* Returns true if ffN has the same settings and signals in both plans. */
static bool same_feedforward(const struct plan *plan, const struct plan *old, uint8_t i)
{
    const struct ff_config *a = &plan->config.feedforward[i], *b = &old->config.feedforward[i];
    return strcmp(a->from, b->from) == 0 && strcmp(a->to, b->to) == 0 && a->gain == b->gain &&
           a->lead_s == b->lead_s && a->lag_s == b->lag_s && a->dead_s == b->dead_s &&
           a->reference == b->reference && a->lo == b->lo && a->hi == b->hi &&
           plan->feedforward[i].input == old->feedforward[i].input &&
           plan->feedforward[i].point == old->feedforward[i].point;
}

static void place_feedforward(struct supervisor *s, const struct plan *old, uint8_t i)
{
    const struct plan *plan = s->plan;
    const struct ff_config *f = &plan->config.feedforward[i];
    const struct ff_config *before = old ? &old->config.feedforward[i] : NULL;
    if (!f->from[0] && !(before && before->from[0]))
        return;
    if (before && f->from[0] && same_feedforward(plan, old, i) && plan->tick_s == s->tick_s) {
        float lo, hi, lo_before, hi_before;
        plan_feedforward_span(plan, i, &lo, &hi);
        plan_feedforward_span(old, i, &lo_before, &hi_before);
        if (lo == lo_before && hi == hi_before)
            return;
    }
    if (!before || !same_feedforward(plan, old, i))
        switch_off_forget_ff(s, i);
    if (before)
        rejoin(s, before->to);
    rejoin(s, f->to);
    uint8_t block = (uint8_t)(BLOCK_FEEDFORWARDS + i);
    s->block[block].running = false; /* it begins at rest at the next tick */
    if (!f->from[0])
        return;
    block_give_settings(s, block, false);
}

static void place_matrix(struct supervisor *s)
{
    if (s->block[BLOCK_MATRIX].kind == PLAN_NONE)
        return;
    block_give_settings(s, BLOCK_MATRIX, true);
    /* The matrix may be another one, so its loops are selected again. */
    s->block[BLOCK_MATRIX].must_follow = true;
}

/* An interlock with the same measurement, MV and side keeps its state, and takes its new numbers. */
static void place_interlock(struct supervisor *s, const struct plan *old, uint8_t i)
{
    const struct interlock_config *k = &s->plan->config.interlock[i];
    const struct interlock_config *before = old ? &old->config.interlock[i] : NULL;
    if (!before || strcmp(k->measurement, before->measurement) != 0 ||
        strcmp(k->mv, before->mv) != 0 || k->side != before->side)
        memset(&s->interlock[i], 0, sizeof s->interlock[i]);
}

void supervisor_take_plan(struct supervisor *s, const struct plan *plan)
{
    const struct plan *old = s->plan;
    uint8_t n[PLACED_KINDS];
    excitation_meet_plan(s, plan);
    supervisor_raise_gain(s, PLAN_NONE, 0.0f);
    s->plan = plan;
    arena_count(plan, n);
    /* States that lose their places report events first. */
    for (uint8_t i = n[PLACED_MEASUREMENTS]; i < s->placed[PLACED_MEASUREMENTS]; i++)
        place_measurement(s, old, i);
    for (uint8_t i = n[PLACED_LOOPS]; i < s->placed[PLACED_LOOPS]; i++)
        place_loop(s, old, i);
    histories_fit(s, plan);
    arena_place(s, plan);
    for (uint8_t i = 0; i < n[PLACED_MEASUREMENTS]; i++)
        place_measurement(s, old, i);
    for (uint8_t i = 0; i < n[PLACED_MVS]; i++)
        place_mv(s, old, i);
    for (uint8_t i = 0; i < n[PLACED_LOOPS]; i++)
        place_loop(s, old, i);
    for (uint8_t i = 0; i < CONFIG_FEEDFORWARDS; i++)
        place_feedforward(s, old, i);
    for (uint8_t i = 0; i < n[PLACED_INTERLOCKS]; i++)
        place_interlock(s, old, i);
    for (uint8_t i = 0; i < n[PLACED_ALARMS]; i++)
        alarms_place(s, old, i);
    place_matrix(s);
    histories_place(s, old);
    numbered_place(s, old);
    s->tick_s = plan->tick_s; /* only now, because until here it shows that the base tick changes */
    sequence_place(s, old);
    sampling_tell(s, old);
}
