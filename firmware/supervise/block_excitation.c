#include "supervise/block_excitation.h"

#include <string.h>

#include "exchange/span.h"
#include "supervise/blocks.h"
#include "supervise/constrain.h"

_Static_assert(CONFIG_LOOPS <= 16, "excitation_state.modes has two bits for each loop");

/* Numbers that should be equal may differ by a few roundings: fraction of span. */
#define ROUNDING num_from_float(1e-6f)

/* Words of the events. */
static const char *const reason_words[EXCITE_REASONS] = {
    [EXCITE_FINE] = "",
    [EXCITE_TAKEN] = "taken",
    [EXCITE_ASKED] = "asked",
    [EXCITE_LIMIT] = "limit",
    [EXCITE_INTERLOCK] = "interlock",
    [EXCITE_MODE] = "mode",
    [EXCITE_HAND] = "hand",
    [EXCITE_CHANNEL] = "channel",
    [EXCITE_SAFE] = "safe_state",
    [EXCITE_SEQUENCE] = "sequence",
    [EXCITE_PLAN] = "settings",
    [EXCITE_GAVE_UP] = "gave_up",
    [EXCITE_WRONG] = "wrong",
};

static bool is_at_most(num_t a, num_t b) /* false if one is not a number */
{
    return num_lt(a, b) || num_eq(a, b);
}

/* ---- what is excited ---- */

uint8_t excited_loop(const struct supervisor *s, const struct excited *t)
{
    return t->what == EXCITE_SETPOINT ? t->index : s->plan->owner[t->index];
}

/* Returns the MV at the end of the chain of loops from i on. */
static uint8_t mv_below(const struct plan *plan, uint8_t i)
{
    /* At most CONFIG_LOOPS steps down a chain that plan_build() has proved free of rings. */
    for (unsigned depth = 0; depth < CONFIG_LOOPS && plan->loop[i].mv == PLAN_NONE; depth++)
        i = plan->loop[i].inner;
    return plan->loop[i].mv;
}

uint8_t excited_mv(const struct supervisor *s, const struct excited *t)
{
    return t->what == EXCITE_SETPOINT ? mv_below(s->plan, t->index) : t->index;
}

static uint32_t modes_now(const struct supervisor *s)
{
    uint32_t modes = 0;
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++)
        modes |= (uint32_t)s->loop[i].mode << (2u * i);
    return modes;
}

/* Returns the command or setpoint without the test signal. */
static num_t base_of(const struct supervisor *s, const struct excited *t)
{
    if (t->what == EXCITE_SETPOINT)
        return loop_own_setpoint(&s->loop[t->index]);
    return num_sub(s->mv[t->index].commanded, s->mv[t->index].excitation);
}

/* Finds the limits of the test signal: its own, and those of the MV or setpoint to which it is added. */
static void excitation_limits(const struct supervisor *s, const struct excited *t, num_t *lo,
                              num_t *hi)
{
    const struct config *c = &s->plan->config;
    uint8_t i = excited_loop(s, t);
    *lo = t->lo;
    *hi = t->hi;
    if (t->what == EXCITE_SETPOINT) {
        const struct measurement_config *m = &c->measurement[s->plan->loop[i].pv];
        float least, most;
        plan_setpoint_limits(s->plan, i, &least, &most);
        *lo = num_max(*lo, span_to_fraction(least, m->lo, m->hi));
        *hi = num_min(*hi, span_to_fraction(most, m->lo, m->hi));
        return;
    }
    const struct mv_config *o = &c->mv[t->index];
    *lo = num_max(*lo, span_to_fraction(o->min, o->lo, o->hi));
    *hi = num_min(*hi, span_to_fraction(o->max, o->lo, o->hi));
    if (i == PLAN_NONE || !loop_drives(s, i))
        return;
    *lo = num_max(*lo, num_from_float(c->loop[i].own.out_lo));
    *hi = num_min(*hi, num_from_float(c->loop[i].own.out_hi));
}

static bool is_within_limits(const struct supervisor *s, const struct excited *t, num_t least,
                             num_t most)
{
    num_t lo, hi;
    excitation_limits(s, t, &lo, &hi);
    return is_at_most(num_sub(lo, ROUNDING), least) && is_at_most(most, num_add(hi, ROUNDING));
}

/* ---- what ends it ---- */

static bool pv_is_gone(const struct supervisor *s, uint8_t i)
{
    const struct measurement_state *m = &s->measurement[s->plan->loop[i].pv];
    return !m->bound || m->lost || !quality_usable(m->quality);
}

static enum excite_reason loop_disturbance(const struct supervisor *s, uint8_t i, uint32_t modes)
{
    bool changed = ((modes ^ modes_now(s)) >> (2u * i) & 3u) != 0;
    bool acts = s->loop[i].mode != LOOP_MANUAL;
    if ((changed || acts) && pv_is_gone(s, i))
        return EXCITE_CHANNEL;
    return changed ? EXCITE_MODE : EXCITE_FINE;
}

static enum excite_reason disturbance(const struct supervisor *s, const struct excited *t,
                                      uint32_t modes)
{
    uint8_t j = excited_mv(s, t), i = excited_loop(s, t);
    if (!s->mv[j].bound)
        return EXCITE_CHANNEL;
    /* For a setpoint, all loops below count as well. */
    for (unsigned depth = 0; depth < CONFIG_LOOPS && i != PLAN_NONE; depth++) {
        enum excite_reason reason = loop_disturbance(s, i, modes);
        if (reason != EXCITE_FINE)
            return reason;
        i = s->plan->loop[i].inner;
    }
    if (t->what == EXCITE_SETPOINT &&
        (s->loop[t->index].mode == LOOP_MANUAL || s->loop[t->index].downstream_inactive))
        return EXCITE_MODE;
    return s->mv[j].interlocked || interlock_begins(s, j) ? EXCITE_INTERLOCK : EXCITE_FINE;
}

static enum excite_reason plant_disturbance(const struct supervisor *s)
{
    if (sequence_active(&s->sequence))
        return EXCITE_SEQUENCE;
    return s->state == SUPERVISOR_SAFE ? EXCITE_SAFE : EXCITE_FINE;
}

static bool is_controller(const struct supervisor *s)
{
    return plan_kind(s->plan, (uint8_t)(BLOCK_NUMBERED + s->excitation.holder - 1u))->stage ==
           STAGE_CONTROL;
}

/* Returns true if the block has turns in which it could ask for an end. Blocks that are not controllers have a turn
 * in every tick. */
static bool has_turns(const struct supervisor *s, uint8_t n)
{
    const struct numbered_plan *r = &s->plan->numbered[n];
    if (!is_controller(s))
        return true;
    for (uint8_t k = 0; k < r->members; k++)
        if (loop_drives(s, r->member[k]))
            return true;
    return false;
}

/* ---- beginning and end ---- */

static void tell_end(struct supervisor *s, uint8_t n, enum excite_state state,
                     enum excite_reason reason)
{
    s->excitation.answer[n] = (struct excite_answer){(uint8_t)state, (uint8_t)reason};
}

/* Ends the test signal on a setpoint. If a block serves the loop, the loop's own controller has followed at the
 * setpoint with the signal. It would react to the change if it took over now, so it follows once more. */
static void end_on_setpoint(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    bool moves = !num_eq(l->of_block.excited, num_zero());
    l->setpoint = loop_own_setpoint(l);
    l->of_block.excited = l->of_block.excite = num_zero();
    if (moves && is_controller(s) && loop_acts(s, i))
        block_follow_at(s, i, l->of_block.applied);
}

void excitation_end(struct supervisor *s, enum excite_reason reason)
{
    struct excitation_state *e = &s->excitation;
    if (!e->holder)
        return;
    for (uint8_t k = 0; k < e->targets; k++) {
        const struct excited *t = &e->target[k];
        if (t->what == EXCITE_SETPOINT) {
            end_on_setpoint(s, t->index);
        } else {
            s->mv[t->index].excitation = num_zero();
        }
    }
    uint8_t n = (uint8_t)(e->holder - 1u);
    tell_end(s, n, EXCITE_ENDED, reason);
    e->holder = e->targets = 0;
    event_put(s->events, s->time_ms, EVENT_EXCITATION_ENDED, reason_words[reason], (float)(n + 1u),
              (uint8_t)reason);
}

/* Returns who excites the plant, start-up or a block, or NULL. */
static const char *who_excites(const struct supervisor *s)
{
    return s->testing ? "commission" : supervisor_excited_by(s);
}

static bool is_holder(const struct supervisor *s, uint8_t block)
{
    return s->excitation.holder == block - BLOCK_NUMBERED + 1;
}

void excitation_end_of(struct supervisor *s, uint8_t block, enum excite_reason reason)
{
    if (is_holder(s, block))
        excitation_end(s, reason);
}

void excitation_end_by_hand(struct supervisor *s, uint8_t j)
{
    for (uint8_t k = 0; k < s->excitation.targets; k++)
        if (s->excitation.target[k].what != EXCITE_SETPOINT && s->excitation.target[k].index == j) {
            excitation_end(s, EXCITE_HAND);
            return;
        }
}

/* Resolves a request of blockN. Returns false if there is no such MV or setpoint. */
static bool resolve_target(const struct supervisor *s, uint8_t n, const struct block_excitation *a,
                           struct excited *t)
{
    const struct numbered_plan *r = &s->plan->numbered[n];
    bool input = a->what == EXCITE_INPUT;
    if (a->what > EXCITE_SETPOINT || a->which >= (input ? r->inputs : r->members))
        return false;
    uint8_t i = input ? (uint8_t)PLAN_NONE : r->member[a->which];
    if (a->what == EXCITE_SETPOINT)
        t->index = i;
    else if (!input)
        t->index = s->plan->loop[i].mv;
    else
        t->index = r->input[a->which] & INPUT_IS_MV ? r->input[a->which] & (uint8_t)~INPUT_IS_MV
                                                    : (uint8_t)PLAN_NONE;
    t->what = input ? EXCITE_MV : a->what;
    t->amplitude = a->amplitude;
    t->lo = a->lo;
    t->hi = a->hi;
    return t->index != PLAN_NONE;
}

static bool is_twice(const struct excited *t, uint8_t n)
{
    for (uint8_t k = 0; k < n; k++)
        if (t[k].what == t[n].what && t[k].index == t[n].index)
            return true;
    return false;
}

/* Collects the requests in target[]. Returns their number, or BLOCK_EXCITES_MAX + 1 if one of them is wrong. */
static uint8_t resolve_targets(const struct supervisor *s, uint8_t n, const struct block_io *io,
                               struct excited *target)
{
    uint8_t targets = 0;
    for (uint8_t k = 0; k < BLOCK_EXCITES_MAX; k++) {
        const struct block_excitation *a = &io->requests.excite[k];
        if (a->what == EXCITE_NOTHING)
            continue;
        struct excited *t = &target[targets];
        if (!resolve_target(s, n, a, t) || is_twice(target, targets) ||
            !num_lt(num_zero(), t->amplitude) || !is_at_most(t->lo, t->hi))
            return BLOCK_EXCITES_MAX + 1;
        targets++;
    }
    return targets;
}

static enum excite_reason may_begin(const struct supervisor *s, const struct excited *target,
                                    uint8_t targets)
{
    if (who_excites(s))
        return EXCITE_TAKEN;
    enum excite_reason reason = plant_disturbance(s);
    for (uint8_t k = 0; k < targets && reason == EXCITE_FINE; k++) {
        const struct excited *t = &target[k];
        num_t base = base_of(s, t);
        reason = disturbance(s, t, modes_now(s));
        if (reason == EXCITE_FINE &&
            !is_within_limits(s, t, num_sub(base, t->amplitude), num_add(base, t->amplitude)))
            reason = EXCITE_LIMIT;
    }
    return reason;
}

/* Returns true if the targets are those of the first request. */
static bool same_targets(const struct excitation_state *e, const struct excited *target,
                         uint8_t targets)
{
    for (uint8_t k = 0; k < targets && targets == e->targets; k++)
        if (target[k].what != e->target[k].what || target[k].index != e->target[k].index)
            return false;
    return targets == e->targets;
}

/* Takes the values of this step. Returns false if one is larger than the amplitude, or not a number. */
static bool take_values(struct supervisor *s, const struct block_io *io)
{
    const struct excited *t = s->excitation.target;
    for (uint8_t k = 0; k < BLOCK_EXCITES_MAX; k++) {
        const struct block_excitation *a = &io->requests.excite[k];
        if (a->what == EXCITE_NOTHING)
            continue;
        if (!is_at_most(num_abs(a->value), t->amplitude))
            return false;
        if (t->what == EXCITE_SETPOINT)
            s->loop[t->index].of_block.excite = a->value;
        else
            s->mv[t->index].excitation = a->value;
        t++;
    }
    return true;
}

static enum excite_reason begin_excitation(struct supervisor *s, uint8_t n,
                                           const struct excited *target, uint8_t targets)
{
    struct excitation_state *e = &s->excitation;
    enum excite_reason reason = may_begin(s, target, targets);
    if (reason != EXCITE_FINE)
        return reason;
    e->holder = (uint8_t)(n + 1u);
    e->targets = targets;
    memcpy(e->target, target, targets * sizeof *target);
    e->modes = modes_now(s);
    e->asked = s->ticks;
    tell_end(s, n, EXCITE_RUNS, EXCITE_FINE);
    event_put(s->events, s->time_ms, EVENT_EXCITATION_BEGUN, s->plan->config.block[n].kind,
              (float)(n + 1u), 0);
    return EXCITE_FINE;
}

void excitation_tell(const struct supervisor *s, uint8_t block, struct block_io *io,
                     struct block_excitation *ask)
{
    const struct excite_answer *told = &s->excitation.answer[block - BLOCK_NUMBERED];
    memset(ask, 0, BLOCK_EXCITES_MAX * sizeof *ask);
    io->requests.excite = ask;
    io->requests.excite_state = told->state;
    io->requests.excite_reason = told->reason;
    io->requests.excite_holder = who_excites(s);
}

void excitation_take(struct supervisor *s, uint8_t block, const struct block_io *io)
{
    struct excitation_state *e = &s->excitation;
    uint8_t n = (uint8_t)(block - BLOCK_NUMBERED);
    struct excited target[BLOCK_EXCITES_MAX];
    uint8_t targets = resolve_targets(s, n, io, target);
    e->asked = is_holder(s, block) ? s->ticks : e->asked;
    if (!targets) {
        excitation_end_of(s, block, EXCITE_ASKED);
        tell_end(s, n, EXCITE_OFF, EXCITE_FINE);
        return;
    }
    /* The block must let one step pass without a request. */
    if (e->answer[n].state == EXCITE_ENDED)
        return;
    bool holds = is_holder(s, block);
    enum excite_reason reason = EXCITE_FINE;
    if (targets > BLOCK_EXCITES_MAX || (holds && !same_targets(e, target, targets)))
        reason = EXCITE_WRONG;
    else if (!holds)
        reason = begin_excitation(s, n, target, targets);
    if (reason == EXCITE_FINE && !take_values(s, io))
        reason = EXCITE_WRONG;
    if (reason == EXCITE_FINE)
        return;
    if (is_holder(s, block))
        excitation_end(s, reason);
    else
        tell_end(s, n, EXCITE_REFUSED, reason);
}

/* ---- in a tick ---- */

void excitation_watch(struct supervisor *s)
{
    const struct excitation_state *e = &s->excitation;
    if (!e->holder)
        return;
    enum excite_reason reason = plant_disturbance(s);
    for (uint8_t k = 0; k < e->targets && reason == EXCITE_FINE; k++)
        reason = disturbance(s, &e->target[k], e->modes);
    if (reason == EXCITE_FINE && !has_turns(s, (uint8_t)(e->holder - 1u)))
        reason = EXCITE_MODE;
    if (reason != EXCITE_FINE)
        excitation_end(s, reason);
}

void excitation_add_asked(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    const struct excitation_state *e = &s->excitation;
    for (uint8_t k = 0; k < e->targets; k++) {
        const struct excited *t = &e->target[k];
        if (t->what != EXCITE_SETPOINT || t->index != i)
            continue;
        num_t sum = num_add(l->setpoint, l->of_block.excite);
        if (!is_within_limits(s, t, sum, sum)) {
            excitation_end(s, EXCITE_LIMIT);
            return;
        }
        l->setpoint = sum;
        l->of_block.excited = l->of_block.excite;
    }
}

/* Checks the commands. Every block but a controller has had its turn in this tick, if it has one. */
static enum excite_reason command_disturbance(const struct supervisor *s)
{
    const struct excitation_state *e = &s->excitation;
    if (e->asked != s->ticks && !is_controller(s))
        return EXCITE_CHANNEL;
    for (uint8_t k = 0; k < e->targets; k++) {
        const struct excited *t = &e->target[k];
        if (t->what == EXCITE_SETPOINT)
            continue;
        num_t commanded = s->mv[t->index].commanded;
        if (!is_within_limits(s, t, commanded, commanded))
            return EXCITE_LIMIT;
    }
    return EXCITE_FINE;
}

void excitation_check_commands(struct supervisor *s)
{
    const struct excitation_state *e = &s->excitation;
    enum excite_reason reason = e->holder ? command_disturbance(s) : EXCITE_FINE;
    if (reason == EXCITE_FINE)
        return;
    for (uint8_t k = 0; k < e->targets; k++)
        if (e->target[k].what != EXCITE_SETPOINT)
            s->mv[e->target[k].index].commanded = base_of(s, &e->target[k]);
    excitation_end(s, reason);
}
