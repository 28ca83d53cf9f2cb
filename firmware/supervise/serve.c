#include "supervise/serve.h"

#include "supervise/block_excitation.h"
#include "supervise/blocks.h"
#include "supervise/histories.h"
#include "supervise/plan_parts.h"
#include "supervise/proposals.h"
#include "supervise/raised.h"
#include "supervise/sampling.h"
#include "supervise/span.h"
#include "supervise/validate.h"

#if CONFIG_BLOCKS

/* What a block is given, member by member and input by input. */
struct signals {
    struct block_io io;
    num_t setpoint[BLOCK_MEMBERS_MAX], in[BLOCK_MEMBERS_MAX], out[BLOCK_MEMBERS_MAX];
    uint8_t clamp[BLOCK_MEMBERS_MAX], limited[BLOCK_MEMBERS_MAX];
    num_t input[BLOCK_INPUTS_MAX], point[BLOCK_POINTS_MAX];
    uint8_t quality[BLOCK_INPUTS_MAX], point_quality[BLOCK_POINTS_MAX];
    float event_value[BLOCK_EVENTS_MAX];
    struct block_excitation excite[BLOCK_EXCITES_MAX];
    const struct applied_history *member_applied[BLOCK_MEMBERS_MAX],
        *input_applied[BLOCK_INPUTS_MAX];
    float age_s[BLOCK_INPUTS_MAX];
};

static const struct block_kind *kind_at(const struct supervisor *s, uint8_t slot)
{
    return block_kinds[s->block[slot].kind];
}

static const struct record_plan *record_at(const struct supervisor *s, uint8_t slot)
{
    return &s->plan->record[slot - SLOT_RECORDS];
}

/* The slot behind the last record in use. */
static uint8_t records_end(const struct supervisor *s)
{
    return (uint8_t)(SLOT_RECORDS + s->plan->records);
}

static bool is_stage(const struct supervisor *s, uint8_t slot, enum block_stage stage)
{
    return s->block[slot].kind != PLAN_NONE && kind_at(s, slot)->stage == stage;
}

static uint8_t input_quality(const struct supervisor *s, uint8_t input, bool measured)
{
    if (input & INPUT_IS_MV)
        return s->output[input & ~INPUT_IS_MV].bound ? QUALITY_GOOD : QUALITY_MISSING;
    const struct measurement_state *m = &s->measurement[input];
    if (!m->bound || !m->seen)
        return QUALITY_MISSING;
    /* What stands in for a reading tells an estimator nothing. */
    return measured && m->fault != MEASUREMENT_FINE ? QUALITY_BAD : (uint8_t)m->quality;
}

/* Since the last valid reading was sampled. */
static float input_age_s(const struct supervisor *s, uint8_t input)
{
    return input & INPUT_IS_MV ? 0.0f : elapsed_ms(s->time_ms, sampling_at_ms(s, input)) / 1000.0f;
}

static void gather_inputs(const struct supervisor *s, uint8_t slot, struct signals *g)
{
    const struct record_plan *r = record_at(s, slot);
    bool estimates = is_stage(s, slot, STAGE_ESTIMATE);
    for (uint8_t k = 0; k < r->inputs; k++) {
        uint8_t at = r->input[k];
        g->input[k] =
            at & INPUT_IS_MV ? s->output[at & ~INPUT_IS_MV].applied : s->measurement[at].value;
        g->quality[k] = input_quality(s, at, estimates);
        g->input_applied[k] = at & INPUT_IS_MV ? history_of(s, at & (uint8_t)~INPUT_IS_MV) : NULL;
        g->age_s[k] = input_age_s(s, at);
    }
    for (uint8_t k = 0; k < r->points; k++) {
        g->point[k] = num_zero();
        g->point_quality[k] = QUALITY_MISSING;
    }
}

/* Its members, with their present outputs. */
static void gather(const struct supervisor *s, uint8_t slot, struct signals *g)
{
    const struct record_plan *r = record_at(s, slot);
    g->io =
        (struct block_io){.setpoint = g->setpoint,
                          .in = g->in,
                          .out = g->out,
                          .clamp = g->clamp,
                          .limited = g->limited,
                          .input = g->input,
                          .quality = g->quality,
                          .age_s = g->age_s,
                          .point = g->point,
                          .point_quality = g->point_quality,
                          .event_value = g->event_value,
                          .member_applied = g->member_applied,
                          .input_applied = g->input_applied,
                          .divisor = plan_record_divisor(s->plan, (uint8_t)(slot - SLOT_RECORDS))};
    for (uint8_t k = 0; k < r->members; k++) {
        uint8_t i = r->member[k];
        const struct loop_state *l = &s->loop[i];
        g->setpoint[k] = l->setpoint;
        g->in[k] = s->measurement[s->plan->loop[i].pv].value;
        g->out[k] = l->v;
        g->clamp[k] = l->clamp;
        g->limited[k] = INTEGRAL_FREE;
        g->member_applied[k] = history_of(s, s->plan->loop[i].output);
        if (loop_drives(s, i))
            g->io.acting = (uint8_t)(g->io.acting | (1u << k));
    }
    for (uint8_t k = 0; k < BLOCK_EVENTS_MAX; k++)
        g->event_value[k] = 0.0f;
    gather_inputs(s, slot, g);
}

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

/* Of lists that are the same. */
static bool same_spans(const struct plan *a, const struct plan *b, uint8_t slot)
{
    struct block_setup x, y;
    plan_setup_record(a, (uint8_t)(slot - SLOT_RECORDS), &x);
    plan_setup_record(b, (uint8_t)(slot - SLOT_RECORDS), &y);
    return same_signals(x.pv, y.pv, x.members) && same_signals(x.input, y.input, x.inputs) &&
           same_signals(x.point, y.point, x.points);
}

static bool same_record(const struct supervisor *s, const struct plan *old, uint8_t slot)
{
    const struct record_plan *r = record_at(s, slot);
    const struct record_plan *before = old ? &old->record[slot - SLOT_RECORDS] : NULL;
    return before && old->block[slot].kind == s->plan->block[slot].kind &&
           old->block[slot].grains == s->plan->block[slot].grains && /* the arena keeps no other */
           s->tick_s == s->plan->tick_s &&
           same_list(r->member, r->members, before->member, before->members) &&
           same_list(r->input, r->inputs, before->input, before->inputs) &&
           same_list(r->point, r->points, before->point, before->points) &&
           same_spans(old, s->plan, slot);
}

static void place_record(struct supervisor *s, const struct plan *old, uint8_t slot)
{
    struct block_state *b = &s->block[slot];
    uint8_t n = (uint8_t)(slot - SLOT_RECORDS);
    bool same = same_record(s, old, slot);
    if (!same) { /* of whatever was here before */
        job_give_up(&s->work[n]);
        raised_forget(s, slot);
    }
    if (b->kind == PLAN_NONE)
        return; /* what a build lacks is told when it is loaded */
    if (!same) {
        b->off = b->stepped = b->retune = false;
        b->must_follow = true;
        block_give_settings(s, slot, false);
    } else if (!block_same_settings(s, old, slot)) {
        block_give_settings(s, slot, true);
    }
}

void serve_place(struct supervisor *s, const struct plan *old)
{
    for (uint8_t slot = SLOT_RECORDS; slot < PLAN_BLOCKS; slot++)
        place_record(s, old, slot);
}

/* ---- giving up and coming back ---- */

static void give_up_block(struct supervisor *s, uint8_t slot, const char *reason)
{
    struct block_state *b = &s->block[slot];
    b->off = true;
    b->stepped = false;
    s->served[slot - SLOT_RECORDS].gave_up = reason;
    job_give_up(&s->work[slot - SLOT_RECORDS]);
    event_put(s->events, s->time_ms, EVENT_BLOCK_GAVE_UP, reason, (float)(slot - SLOT_RECORDS + 1),
              0);
    excitation_end_of(s, slot, EXCITE_GAVE_UP);
}

bool serve_switch(struct supervisor *s, uint8_t n, bool on)
{
    uint8_t slot = (uint8_t)(SLOT_RECORDS + n);
    if (n >= CONFIG_BLOCKS || !is_stage(s, slot, STAGE_CONTROL))
        return false;
    if (s->block[slot].off != on)
        return true;
    if (!on) {
        give_up_block(s, slot, "asked");
        raised_forget(s, slot);
        return true;
    }
    s->block[slot].off = false;
    s->block[slot].must_follow = true;
    raised_forget(s, slot);
    event_put(s->events, s->time_ms, EVENT_BLOCK_ON, s->plan->config.block[n].kind, (float)(n + 1u),
              0);
    return true;
}

static void members_to_manual(struct supervisor *s, uint8_t slot)
{
    const struct record_plan *r = record_at(s, slot);
    for (uint8_t k = 0; k < r->members; k++)
        if (loop_acts(s, r->member[k])) {
            s->loop[r->member[k]].mode = LOOP_MANUAL;
            s->loop[r->member[k]].drives = false;
            event_put(s->events, s->time_ms, EVENT_MODE, s->plan->config.loop[r->member[k]].name,
                      (float)LOOP_MANUAL, LOOP_MANUAL);
        }
}

static const char *input_name(const struct supervisor *s, uint8_t input)
{
    const struct config *c = &s->plan->config;
    return input & INPUT_IS_MV ? c->output[input & ~INPUT_IS_MV].name : c->measurement[input].name;
}

static void give_up_without_input(struct supervisor *s, uint8_t slot, uint8_t k)
{
    give_up_block(s, slot, input_name(s, record_at(s, slot)->input[k]));
    /* Not the name, which is in a plan that is written over later. */
    s->served[slot - SLOT_RECORDS].gave_up = NULL;
    s->served[slot - SLOT_RECORDS].input = k;
    raised_forget(s, slot);
}

void serve_check_inputs(struct supervisor *s)
{
    for (uint8_t slot = SLOT_RECORDS; slot < records_end(s); slot++) {
        const struct record_plan *r = record_at(s, slot);
        if (!s->plan->config.block[slot - SLOT_RECORDS].kind[0])
            continue;
        if (s->block[slot].kind == PLAN_NONE) { /* this build cannot run it */
            members_to_manual(s, slot);
            continue;
        }
        bool acts = false;
        for (uint8_t k = 0; k < r->members; k++)
            acts = acts || loop_drives(s, r->member[k]);
        if (s->block[slot].off || !acts || kind_at(s, slot)->bad_input == BAD_INPUT_IS_TOLD)
            continue;
        for (uint8_t k = 0; k < r->inputs; k++) {
            if (quality_usable((enum quality)input_quality(s, r->input[k], false)))
                continue;
            if (kind_at(s, slot)->bad_input == BAD_INPUT_MANUAL)
                members_to_manual(s, slot);
            else
                give_up_without_input(s, slot, k);
            break;
        }
    }
}

/* ---- steps ---- */

static void take_work(struct supervisor *s, uint8_t slot, struct block_io *io)
{
    struct job *work = &s->work[slot - SLOT_RECORDS];
    if (!job_is_asked(work)) {
        io->work_wanted = job_is_working(work); /* given up in the midst of a piece */
        return;
    }
    io->work_done = job_take(work, s->events, s->time_ms);
    io->work_wanted = !io->work_done;
}

static void ask_work(struct supervisor *s, uint8_t slot, const struct block_io *io)
{
    struct job *work = &s->work[slot - SLOT_RECORDS];
    if (io->ask_work && kind_at(s, slot)->work && !job_is_asked(work) && !job_is_working(work))
        job_ask(work, io->ask_work);
}

static bool work_piece(void *context)
{
    struct supervisor_work *w = context;
    const struct supervisor *s = w->supervisor;
    const struct block_kind *kind = kind_at(s, w->slot);
    return kind->work(supervisor_block(s, w->slot));
}

void serve_init(struct supervisor *s)
{
    for (uint8_t n = 0; n < CONFIG_BLOCKS; n++) {
        s->worker[n] = (struct supervisor_work){s, (uint8_t)(SLOT_RECORDS + n)};
        job_init(&s->work[n], "block", work_piece, &s->worker[n]);
    }
}

static void give_points(struct supervisor *s, uint8_t slot, const struct signals *g)
{
    const struct record_plan *r = record_at(s, slot);
    bool there = true;
    for (uint8_t k = 0; k < r->inputs; k++)
        there = there && g->quality[k] != QUALITY_MISSING;
    for (uint8_t k = 0; k < r->points; k++) {
        uint8_t i = r->point[k];
        const struct measurement_config *m = &s->plan->config.measurement[i];
        struct reading reading = {span_to_eu(g->point[k], m->lo, m->hi),
                                  (enum quality)g->point_quality[k]};
        /* It is there from when its inputs first are, and as long as they are bound. */
        s->measurement[i].bound = there || s->measurement[i].bound;
        validate_measurement(s, i, &reading);
    }
}

void serve_forget(struct supervisor *s)
{
    for (uint8_t slot = SLOT_RECORDS; slot < PLAN_BLOCKS; slot++)
        s->block[slot].must_follow = true;
}

void serve_estimate(struct supervisor *s)
{
    for (uint8_t slot = SLOT_RECORDS; slot < records_end(s); slot++) {
        if (!is_stage(s, slot, STAGE_ESTIMATE))
            continue;
        struct signals g;
        gather(s, slot, &g);
        if (s->block[slot].must_follow && kind_at(s, slot)->follow)
            kind_at(s, slot)->follow(supervisor_block(s, slot), &g.io);
        s->block[slot].must_follow = false;
        take_work(s, slot, &g.io);
        excitation_tell(s, slot, &g.io, g.excite);
        g.io.proposal = proposal_room(s);
        kind_at(s, slot)->step(supervisor_block(s, slot), &g.io);
        raised_tell(s, slot, &g.io);
        ask_work(s, slot, &g.io);
        excitation_take(s, slot, &g.io);
        proposal_hand_over(s, slot, &g.io);
        give_points(s, slot, &g);
    }
}

void serve_must_follow(struct supervisor *s, uint8_t slot)
{
    s->block[slot].must_follow = true;
}

void serve_follow(struct supervisor *s)
{
    for (uint8_t slot = SLOT_RECORDS; slot < records_end(s); slot++) {
        struct block_state *b = &s->block[slot];
        if (!b->must_follow || !is_stage(s, slot, STAGE_CONTROL))
            continue;
        struct signals g;
        gather(s, slot, &g);
        kind_at(s, slot)->follow(supervisor_block(s, slot), &g.io);
        b->must_follow = b->stepped = false;
    }
}

/* The loops' own controllers act now, in this tick. */
static void own_step(struct supervisor *s, uint8_t slot, uint8_t acting)
{
    const struct record_plan *r = record_at(s, slot);
    for (uint8_t k = 0; k < r->members; k++)
        if (acting & (1u << k))
            block_step(s, r->member[k]);
}

/* In floating point a block may have come apart: what is no number must reach nobody. */
static bool gives_numbers(const struct signals *g, uint8_t members)
{
    for (uint8_t k = 0; k < members; k++)
        if ((g->io.acting & (1u << k)) && !float_is_finite(num_to_float(g->out[k])))
            return false;
    return true;
}

void serve_step(struct supervisor *s, uint8_t i)
{
    uint8_t slot = loop_server(s, i);
    if (slot == PLAN_NONE || record_at(s, slot)->last != i || !is_stage(s, slot, STAGE_CONTROL) ||
        !loop_due(s, i, s->ticks))
        return;
    const struct record_plan *r = record_at(s, slot);
    const struct block_kind *kind = kind_at(s, slot);
    struct signals g;
    gather(s, slot, &g);
    if (!g.io.acting) {
        raised_forget(s, slot);
        return;
    }
    if (s->block[slot].stepped) /* nobody has told it yet: as if nothing had been in the way */
        kind->back_calculate(supervisor_block(s, slot), &g.io);
    take_work(s, slot, &g.io);
    excitation_tell(s, slot, &g.io, g.excite);
    g.io.proposal = proposal_room(s);
    kind->step(supervisor_block(s, slot), &g.io);
    raised_tell(s, slot, &g.io);
    if (!g.io.gives_up && !gives_numbers(&g, r->members))
        g.io.gives_up = "not_a_number";
    if (g.io.gives_up) {
        give_up_block(s, slot, g.io.gives_up);
        own_step(s, slot, g.io.acting);
        return;
    }
    ask_work(s, slot, &g.io);
    excitation_take(s, slot, &g.io);
    proposal_hand_over(s, slot, &g.io);
    for (uint8_t k = 0; k < r->members; k++) {
        if (!(g.io.acting & (1u << k)))
            continue;
        s->loop[r->member[k]].v = g.out[k];
        s->loop[r->member[k]].limited = g.limited[k];
    }
    s->block[slot].stepped = true;
}

void serve_back_calculate(struct supervisor *s)
{
    for (uint8_t slot = SLOT_RECORDS; slot < records_end(s); slot++) {
        struct block_state *b = &s->block[slot];
        const struct record_plan *r = record_at(s, slot);
        if (!is_stage(s, slot, STAGE_CONTROL))
            continue;
        struct signals g;
        gather(s, slot, &g);
        if (b->off || !g.io.acting || b->must_follow) {
            b->must_follow = !b->off; /* before it acts again */
            continue;
        }
        if (!b->stepped || !loop_due(s, r->member[0], s->ticks + 1u))
            continue;
        for (uint8_t k = 0; k < r->members; k++)
            if (g.io.acting & (1u << k))
                g.out[k] = s->loop[r->member[k]].told;
        b->stepped = false;
        kind_at(s, slot)->back_calculate(supervisor_block(s, slot), &g.io);
        for (uint8_t k = 0; k < r->members; k++)
            if (g.io.acting & (1u << k))
                s->loop[r->member[k]].limited = g.limited[k];
    }
}

#endif
