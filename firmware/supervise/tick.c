/* The tick behind validate.c: control, compensate, feed forward, excite, constrain, and back-calculation. */
#include <string.h>

#include "base/elapsed.h"
#include "supervise/alarms.h"
#include "supervise/blocks.h"
#include "supervise/histories.h"
#include "supervise/serve.h"
#include "supervise/supervisor.h"

/* A command beyond this, in spans, may have ended with the range of num_t. */
#define COMMAND_MAX 100.0f

/* A new plan may name channels the plant does not have, or with another unit: nothing acts on those. */
static void drop_unbound(struct supervisor *s)
{
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++) {
        const struct loop_plan *p = &s->plan->loop[i];
        if (!loop_acts(s, i))
            continue;
        if (s->measurement[p->pv].bound && (p->output == PLAN_NONE || s->output[p->output].bound))
            continue;
        s->loop[i].mode = LOOP_MANUAL;
        event_put(s->events, s->time_ms, EVENT_MODE, s->plan->config.loop[i].name,
                  (float)LOOP_MANUAL, LOOP_MANUAL);
    }
}

/* What feedforward k looks at, fraction of span; false: there is nothing to look at yet. Of a manipulated variable it is
 * what the tick before has made of it, whatever moved it: limits, interlocks and hands included. So no correction depends
 * on the order in which loops or corrections are computed. */
static bool feedforward_input(const struct supervisor *s, uint8_t k, num_t *d)
{
    uint8_t from = s->plan->feedforward[k].from;
    if (!s->plan->config.feedforward[k].from[0] || from == PLAN_NONE)
        return false;
    bool output = s->plan->feedforward[k].from_output;
    *d = output ? s->output[from].applied : s->measurement[from].value;
    return output ? s->output[from].bound : s->measurement[from].seen;
}

/* `before`: what was added in the tick before, for each loop. */
static void feed_forward(struct supervisor *s, num_t *before)
{
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++) {
        before[i] = s->loop[i].feedforward;
        s->loop[i].feedforward = num_zero();
    }
    for (uint8_t k = 0; k < CONFIG_FEEDFORWARDS; k++) {
        struct block_state *b = &s->block[SLOT_ELEMENTS + k];
        num_t d = num_zero(), added;
        bool runs = feedforward_input(s, k, &d), ran = b->running;
        if (!runs && !ran)
            continue; /* no number yet: no correction */
        struct loop_state *l = &s->loop[s->plan->owner[s->plan->feedforward[k].to]];
        /* New or gone, or what it looks at is: it begins at rest, and the loop makes room for it or fills its place. */
        l->moved = l->moved || runs != ran;
        b->running = runs;
        if (!runs)
            continue;
        const struct block_kind *kind = block_kinds[b->kind];
        void *state = supervisor_block(s, (uint8_t)(SLOT_ELEMENTS + k));
        struct block_io io = {.acting = 1, .in = &d, .out = &added};
        if (!ran)
            kind->follow(state, &io);
        kind->step(state, &io);
        l->feedforward = num_add(l->feedforward, added);
    }
}

static num_t clamp_setpoint(const struct supervisor *s, uint8_t i, num_t setpoint)
{
    const struct measurement_config *m = &s->plan->config.measurement[s->plan->loop[i].pv];
    float lo, hi;
    plan_setpoint_limits(s->plan, i, &lo, &hi);
    return num_clamp(setpoint, span_to_fraction(lo, m->lo, m->hi),
                     span_to_fraction(hi, m->lo, m->hi));
}

static void setpoint_from_outer(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    l->target = clamp_setpoint(s, i, s->loop[s->plan->loop[i].outer].v);
    ramp_reset(&l->ramp, l->target);
    lag_reset(&l->filter, l->target);
    l->setpoint = l->target;
}

static void advance_setpoint(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    if (l->mode == LOOP_CASCADE)
        setpoint_from_outer(s, i);
    else
        l->setpoint = lag_step(&l->filter, ramp_step(&l->ramp, l->target));
}

/* In manual the setpoint waits where automatic will begin: at the measurement, unless the operator wants
 * his own setpoint kept and a jump there. */
static void idle_setpoint(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    const struct loop_config *c = &s->plan->config.loop[i];
    num_t pv = s->measurement[s->plan->loop[i].pv].value;
    if (c->sp_track || !l->sp_given)
        l->target = clamp_setpoint(s, i, pv);
    bool jump = c->sp_ramp_per_min == 0.0f && c->sp_filter_s == 0.0f;
    l->setpoint = jump ? l->target : pv;
}

void supervisor_start_setpoint(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    if (l->mode == LOOP_CASCADE) {
        setpoint_from_outer(s, i);
        return;
    }
    idle_setpoint(s, i);
    ramp_reset(&l->ramp, l->setpoint);
    lag_reset(&l->filter, l->setpoint);
}

/* Where a loop finds output j when it takes over: the limits of what acts count from here on. */
static num_t output_found(const struct supervisor *s, uint8_t j)
{
    const struct output_config *c = &s->plan->config.output[j];
    return num_clamp(s->output[j].manual, span_to_fraction(c->min, c->lo, c->hi),
                     span_to_fraction(c->max, c->lo, c->hi));
}

/* Which loops take part in the compensator now. A change to one of them concerns them all: then those loops are returned,
 * else none. */
static uint8_t regroup(struct supervisor *s)
{
    struct block_state *b = &s->block[SLOT_MATRIX];
    if (b->kind == PLAN_NONE)
        return 0;
    uint8_t acting = 0;
    bool changed = false;
    for (uint8_t i = 0; i < DECOUPLER_MAX && i < s->placed[PLACED_LOOPS]; i++) {
        if (!loop_drives(s, i) || !s->plan->loop[i].decouple)
            continue;
        acting = (uint8_t)(acting | (1u << i));
        changed = changed || s->loop[i].join || s->loop[i].moved;
    }
    if (acting != b->acting || b->must_follow) {
        const struct matrix_settings matrix = {s->plan->config.decoupler};
        changed = block_kinds[b->kind]->select(supervisor_block(s, SLOT_MATRIX), &matrix, acting) ||
                  changed;
    }
    b->acting = acting;
    b->must_follow = false;
    return changed ? acting : 0;
}

/* Loops that act from this tick on, and all decoupled loops when their company changes, take over the
 * outputs they find: v = D^-1 (output - feedforward). Those that acted before go on with what they have under way:
 * a derivative that dies away must not become part of the integral because another loop comes or goes. Nor must what
 * their feedforward calls for in this tick: the output they find has the one before in it. */
static void take_over(struct supervisor *s, const num_t *before)
{
    num_t v[CONFIG_LOOPS];
    const uint8_t n = s->placed[PLACED_LOOPS];
    uint8_t together = regroup(s);
    for (uint8_t i = 0; i < n; i++) {
        const struct loop_plan *p = &s->plan->loop[i];
        const struct loop_state *l = &s->loop[i];
        bool moves = l->join || l->moved;
        v[i] = l->v;
        if (p->used && p->output != PLAN_NONE && (moves || together))
            /* The value last sent, or just asked for by hand: a read-back is one sample old, and a valve
             * that still moves would start the loop from where it was. */
            v[i] = num_sub(output_found(s, p->output), moves ? l->feedforward : before[i]);
    }
    if (together) {
        num_t u[DECOUPLER_MAX];
        memcpy(u, v, sizeof u);
        struct block_io io = {.acting = together, .in = u, .out = v};
        block_kinds[s->block[SLOT_MATRIX].kind]->back_calculate(supervisor_block(s, SLOT_MATRIX),
                                                                &io);
    }
    for (uint8_t i = 0; i < n; i++) {
        struct loop_state *l = &s->loop[i];
        if (!loop_drives(s, i))
            continue;
        uint8_t server = loop_server(s, i);
        bool moves = l->join || l->moved || (i < DECOUPLER_MAX && (together & (1u << i)));
        if (server != PLAN_NONE && moves)
            serve_must_follow(s, server);
        if (l->join || (server != PLAN_NONE && moves)) {
            l->v = v[i];
            block_follow(s, i);
        } else if (moves) {
            block_shift(s, i, v[i]);
        }
        l->join = l->moved = false;
    }
    serve_follow(s);
}

static void run_loops(struct supervisor *s)
{
    for (uint8_t k = 0; k < s->plan->n_order; k++) {
        uint8_t i = s->plan->order[k];
        struct loop_state *l = &s->loop[i];
        if (l->mode == LOOP_MANUAL) {
            idle_setpoint(s, i);
        } else if (loop_due(s, i, s->ticks)) {
            advance_setpoint(s, i);
            if (loop_drives(s, i) && loop_server(s, i) == PLAN_NONE) {
                block_close(s, i);
                block_step(s, i);
            }
        }
        if (loop_server(s, i) != PLAN_NONE)
            serve_step(s, i);
    }
}

static void command_outputs(struct supervisor *s)
{
    num_t v[CONFIG_LOOPS], u[CONFIG_LOOPS];
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++)
        v[i] = u[i] = s->loop[i].v;
    const struct block_state *b = &s->block[SLOT_MATRIX];
    if (b->kind != PLAN_NONE) {
        struct block_io io = {.acting = b->acting, .in = v, .out = u};
        block_kinds[b->kind]->step(supervisor_block(s, SLOT_MATRIX), &io);
    }
    for (uint8_t j = 0; j < s->placed[PLACED_OUTPUTS]; j++) {
        if (!s->plan->config.output[j].name[0])
            continue;
        uint8_t i = s->plan->owner[j];
        bool drives = i != PLAN_NONE && loop_drives(s, i);
        num_t wanted = drives ? num_add(u[i], s->loop[i].feedforward) : s->output[j].manual;
        s->output[j].commanded = num_add(wanted, s->output[j].excitation);
    }
}

static bool heard_within(const struct supervisor *s, uint8_t k, float seconds)
{
    return (float)((uint32_t)s->time_ms - s->interlock[k].heard_ms) <= seconds * 1000.0f;
}

/* The condition of entry k now. It begins on any number the plant vouches for, whatever came before it or stands in
 * for it; it ends only on a believed one. */
static bool interlock_condition(const struct supervisor *s, uint8_t k)
{
    const struct interlock_config *c = &s->plan->config.interlock[k];
    const struct interlock_state *state = &s->interlock[k];
    uint8_t i = s->plan->interlock[k].measurement;
    const struct measurement_state *m = &s->measurement[i];
    bool vouched = measurement_vouched(m);
    float band = state->active ? c->hysteresis : 0.0f;
    bool outside = c->side == INTERLOCK_ABOVE ? m->raw > c->limit - band : m->raw < c->limit + band;
    if (vouched && outside)
        return true;
    if (state->active)
        return !vouched || m->fault != MEASUREMENT_FINE;
    /* A substituted or inferred value is no evidence that all is well. */
    bool bad = !m->bound || !m->seen || m->lost || !quality_usable(m->quality);
    if (c->on_bad && bad)
        return true;
    /* The last number stands for as long as a value is held. */
    return !vouched && m->bound && m->delivered && outside && state->pending &&
           heard_within(s, k, s->plan->config.measurement[i].hold_s);
}

/* A missing sample does not begin the delay anew, when others are heard meanwhile; it takes one past the limit to end
 * the delay. */
static bool interlock_waits(const struct supervisor *s, uint8_t k)
{
    const struct measurement_state *m = &s->measurement[s->plan->interlock[k].measurement];
    return s->interlock[k].pending && !measurement_vouched(m) &&
           heard_within(s, k, s->plan->config.interlock[k].delay_s);
}

/* Nothing overrides an interlock: it is applied last, over limits, rates and manual alike. */
static void run_interlocks(struct supervisor *s)
{
    bool interlocked[CHANNEL_MAX] = {false};
    for (uint8_t k = 0; k < s->placed[PLACED_INTERLOCKS]; k++) {
        const struct interlock_config *c = &s->plan->config.interlock[k];
        struct interlock_state *state = &s->interlock[k];
        if (!c->measurement[0] || s->plan->interlock[k].measurement == PLAN_NONE)
            continue;
        const struct measurement_state *m = &s->measurement[s->plan->interlock[k].measurement];
        bool condition = interlock_condition(s, k);
        if (condition && !state->pending)
            state->since_ms = s->time_ms;
        if (condition && (!state->pending || measurement_vouched(m)))
            state->heard_ms = (uint32_t)s->time_ms;
        state->pending = condition || interlock_waits(s, k);
        bool active = condition && (state->active || elapsed_ms(s->time_ms, state->since_ms) >=
                                                         c->delay_s * 1000.0f);
        if (active != state->active)
            event_put(s->events, s->time_ms, active ? EVENT_INTERLOCK_ON : EVENT_INTERLOCK_OFF,
                      c->output, m->raw, k);
        state->active = active;
        uint8_t j = s->plan->interlock[k].output;
        if (!active || interlocked[j] || !s->output[j].bound)
            continue; /* the first entry of the table wins */
        interlocked[j] = true;
        const struct output_config *o = &s->plan->config.output[j];
        s->output[j].constrained = span_to_fraction(c->value, o->lo, o->hi);
    }
    for (uint8_t j = 0; j < s->placed[PLACED_OUTPUTS]; j++)
        s->output[j].interlocked = interlocked[j];
}

/* An interlock may have left the output outside lo..hi. In manual it stays there until somebody moves it; whatever moves
 * it finds it at the nearest limit. Returns whether it stays. */
static bool stays_beyond(struct output_state *o, num_t lo, num_t hi, bool acts)
{
    num_t nearest = num_clamp(o->constrained, lo, hi);
    o->beyond = o->beyond && !num_eq(nearest, o->constrained);
    if (o->beyond && !acts && num_eq(o->commanded, o->constrained))
        return true;
    if (o->beyond)
        o->constrained = nearest;
    o->beyond = false;
    return false;
}

/* The limits of a loop hold for what reaches its output, after decoupler and feedforward. An output found outside enters
 * them at the loop's rate, at once where there is none. */
static void loop_limits(const struct supervisor *s, uint8_t i, num_t at, num_t *lo, num_t *hi)
{
    const struct loop_config *l = &s->plan->config.loop[i];
    num_t least = num_from_float(l->own.out_lo), most = num_from_float(l->own.out_hi);
    if (l->own.out_rate_per_s > 0.0f) {
        /* A step of num_t at least: it arrives. */
        num_t reach = num_max(num_from_float(l->own.out_rate_per_s * s->plan->tick_s),
                              num_from_float(1.0f / 16777216.0f));
        least = num_min(least, num_add(at, reach));
        most = num_max(most, num_sub(at, reach));
    }
    *lo = num_min(num_max(*lo, least), *hi);
    *hi = num_max(num_min(*hi, most), *lo);
}

static void constrain_output(struct supervisor *s, uint8_t j)
{
    struct output_state *o = &s->output[j];
    const struct output_config *c = &s->plan->config.output[j];
    num_t safe = span_to_fraction(c->safe, c->lo, c->hi);
    if (s->state == SUPERVISOR_SAFE || !o->bound) {
        /* What is not there waits at its safe value too, and begins there when it comes. */
        o->constrained = o->manual = safe;
        return;
    }
    num_t lo = span_to_fraction(c->min, c->lo, c->hi);
    num_t hi = span_to_fraction(c->max, c->lo, c->hi);
    uint8_t i = s->plan->owner[j];
    bool acts = i != PLAN_NONE && loop_acts(s, i);
    if (!acts) {
        /* The safe value may lie outside the operating limits; manual may stay there. */
        lo = num_min(lo, safe);
        hi = num_max(hi, safe);
    }
    if (stays_beyond(o, lo, hi, acts))
        return;
    /* What is not sent now is not sent later either, when the limits are wider again. */
    o->manual = num_clamp(o->manual, lo, hi);
    if (acts && loop_drives(s, i) && !plan_kind(s->plan, i)->positions)
        loop_limits(s, i, o->constrained, &lo, &hi);
    /* From where the output is, whatever put it there. The ramp is wide, so that slow rates do not stall. */
    if (!num_eq(accumulator_get(&o->rate.at), o->constrained))
        ramp_reset(&o->rate, o->constrained);
    o->constrained = ramp_step(&o->rate, num_clamp(o->commanded, lo, hi));
}

static void constrain(struct supervisor *s)
{
    for (uint8_t j = 0; j < s->placed[PLACED_OUTPUTS]; j++)
        if (s->plan->config.output[j].name[0])
            constrain_output(s, j);
    run_interlocks(s);
    loops_find_driving(s);
    for (uint8_t j = 0; j < s->placed[PLACED_OUTPUTS]; j++) {
        struct output_state *o = &s->output[j];
        uint8_t i = s->plan->owner[j];
        if (!s->plan->config.output[j].name[0])
            continue;
        o->applied = o->not_following ? o->readback : o->constrained;
        o->sent = true;
        o->beyond = o->beyond || o->interlocked;
        /* Manual begins where automatic or an interlock left the output. */
        if (o->interlocked || (i != PLAN_NONE && loop_drives(s, i)))
            o->manual = num_sub(o->constrained, o->excitation);
    }
}

/* Directions in which the setpoint of loop i should not be pushed, because its own output is at a limit. */
static uint8_t saturation(const struct supervisor *s, uint8_t i)
{
    const struct loop_state *l = &s->loop[i];
    const struct loop_plan *p = &s->plan->loop[i];
    if (loop_interlocked(s, i))
        return INTEGRAL_CLAMP_UP | INTEGRAL_CLAMP_DOWN;
    bool up = (l->limited & INTEGRAL_CLAMP_UP) != 0;
    bool down = (l->limited & INTEGRAL_CLAMP_DOWN) != 0;
    if (p->output != PLAN_NONE) {
        const struct output_state *o = &s->output[p->output];
        up = up || num_lt(o->applied, o->commanded);
        down = down || num_lt(o->commanded, o->applied);
    } else { /* whether or not it has been told already */
        num_t taken = clamp_setpoint(s, p->inner, l->v);
        up = up || num_lt(taken, l->v);
        down = down || num_lt(l->v, taken);
    }
    up = up || (l->clamp & INTEGRAL_CLAMP_UP);
    down = down || (l->clamp & INTEGRAL_CLAMP_DOWN);
    if (s->plan->config.loop[i].own.action == LOOP_DIRECT) {
        bool swap = up;
        up = down;
        down = swap;
    }
    return (uint8_t)((up ? INTEGRAL_CLAMP_UP : 0) | (down ? INTEGRAL_CLAMP_DOWN : 0));
}

/* Whoever acts for loop i is told what took effect of its output; its own controller follows another's. */
static void tell_applied(struct supervisor *s, uint8_t i, num_t told, uint8_t clamp)
{
#if CONFIG_BLOCKS
    if (loop_server(s, i) != PLAN_NONE) {
        s->loop[i].told = told;
        s->loop[i].clamp = clamp;
        block_follow_at(s, i, told);
        return;
    }
#endif
    if (block_closes(s, i))
        block_back_calculate(s, i, told, clamp);
}

static void back_direct(struct supervisor *s, uint8_t i, num_t told)
{
    struct loop_state *l = &s->loop[i];
    const struct loop_plan *p = &s->plan->loop[i];
    if (loop_interlocked(s, i))
        l->join = true; /* whenever the interlock lets go */
    if (l->mode != LOOP_MANUAL && !l->join) {
        tell_applied(s, i, told, INTEGRAL_FREE);
        return;
    }
    const struct output_state *o = &s->output[p->output];
    l->v = num_sub(num_sub(o->applied, o->excitation), l->feedforward);
    block_follow(s, i);
}

static void back_outer(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    const struct loop_plan *p = &s->plan->loop[i];
    const struct loop_state *inner = &s->loop[p->inner];
    /* Nobody takes this loop's output: the inner loop is not in cascade, or is but speaks to nobody itself. */
    l->open = inner->mode != LOOP_CASCADE || inner->open;
    if (l->open)
        l->v = inner->mode == LOOP_AUTO ? inner->setpoint
                                        : s->measurement[s->plan->loop[p->inner].pv].value;
    if (l->mode == LOOP_MANUAL || l->open) {
        block_follow(s, i);
        if (l->open && loop_server(s, i) != PLAN_NONE)
            serve_must_follow(s, loop_server(s, i));
        return;
    }
    l->clamp = saturation(s, p->inner);
    /* What the inner loop makes of it does not depend on whose turn comes first. */
    tell_applied(s, i, clamp_setpoint(s, p->inner, l->v), l->clamp);
}

/* What compensated loops are told: v and the way back of (applied - commanded). Where the compensator asks for more than
 * num_t holds, the command does not say by how much the output falls short of it; then the way back of the output itself. */
static void back_compensated(struct supervisor *s, num_t *told)
{
    const struct block_state *b = &s->block[SLOT_MATRIX];
    num_t u[DECOUPLER_MAX];
    bool whole = false;
    for (uint8_t i = 0; i < DECOUPLER_MAX; i++)
        if (b->acting & (1u << i))
            whole = whole || num_lt(num_from_float(COMMAND_MAX),
                                    num_abs(s->output[s->plan->loop[i].output].commanded));
    for (uint8_t i = 0; i < DECOUPLER_MAX; i++) {
        if (!(b->acting & (1u << i)))
            continue;
        const struct output_state *o = &s->output[s->plan->loop[i].output];
        num_t from = whole ? num_add(s->loop[i].feedforward, o->excitation) : o->commanded;
        u[i] = num_sub(o->applied, from);
    }
    struct block_io io = {.acting = b->acting, .in = u, .out = told};
    block_kinds[b->kind]->back_calculate(supervisor_block(s, SLOT_MATRIX), &io);
    for (uint8_t i = 0; !whole && i < DECOUPLER_MAX; i++)
        if (b->acting & (1u << i))
            told[i] = num_add(s->loop[i].v, told[i]);
}

static void back_calculate(struct supervisor *s)
{
    num_t told[CONFIG_LOOPS];
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++) {
        uint8_t j = s->plan->loop[i].output;
        told[i] = s->loop[i].v;
        if (s->plan->loop[i].used && j != PLAN_NONE)
            told[i] = num_add(told[i], num_sub(s->output[j].applied, s->output[j].commanded));
    }
    if (s->block[SLOT_MATRIX].kind != PLAN_NONE)
        back_compensated(s, told);
    /* Inner loops first: what an outer loop may do depends on them. */
    for (uint8_t k = s->plan->n_order; k > 0; k--) {
        uint8_t i = s->plan->order[k - 1u];
        if (s->plan->loop[i].output != PLAN_NONE)
            back_direct(s, i, told[i]);
        else
            back_outer(s, i);
    }
    serve_back_calculate(s);
}

void supervisor_control(struct supervisor *s)
{
#if CONFIG_STEPS
    sequence_run(s);
#endif
    drop_unbound(s);
    loops_find_driving(s);
    serve_check_inputs(s);
    num_t before[CONFIG_LOOPS];
    feed_forward(s, before);
    take_over(s, before);
    run_loops(s);
    command_outputs(s);
    constrain(s);
    back_calculate(s);
    alarms_run(s);
    histories_append(s);
    s->ticks++;
}
