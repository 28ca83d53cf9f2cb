#include "supervise/constrain.h"

#include "base/elapsed.h"
#include "exchange/span.h"
#include "supervise/blocks.h"
#include "supervise/latch.h"
#include "supervise/test_signal.h"

static bool heard_within(const struct supervisor *s, uint8_t k, float seconds)
{
    return (float)((uint32_t)s->time_ms - s->interlock[k].heard_ms) <= seconds * 1000.0f;
}

/* Returns the condition of entry k now. It begins on any number that the plant calls good, whatever came before it
 * or stands in for it; it ends only on a valid one. */
static bool interlock_condition(const struct supervisor *s, uint8_t k)
{
    const struct interlock_config *c = &s->plan->config.interlock[k];
    const struct interlock_state *state = &s->interlock[k];
    uint8_t i = s->plan->interlock[k].measurement;
    const struct measurement_state *m = &s->measurement[i];
    bool good = measurement_is_good(m);
    float band = state->active ? c->hysteresis : 0.0f;
    bool outside = c->side == INTERLOCK_ABOVE ? m->raw > c->limit - band : m->raw < c->limit + band;
    if (good && outside)
        return true;
    if (state->active)
        return !good || m->fault != MEASUREMENT_FINE;
    /* A substituted or inferred value is no evidence that all is well. */
    bool bad = !m->bound || !m->seen || m->lost || !quality_usable(m->quality);
    if (c->on_bad && bad)
        return true;
    /* The last number counts for as long as a value is held. */
    return !good && m->bound && m->delivered && outside && state->pending &&
           heard_within(s, k, s->plan->config.measurement[i].sensor_hold_s);
}

bool interlock_begins(const struct supervisor *s, uint8_t j)
{
    for (uint8_t k = 0; k < s->placed[PLACED_INTERLOCKS]; k++) {
        const struct interlock_config *c = &s->plan->config.interlock[k];
        const struct interlock_state *state = &s->interlock[k];
        if (!c->measurement[0] || s->plan->interlock[k].measurement == PLAN_NONE ||
            s->plan->interlock[k].mv != j || !interlock_condition(s, k))
            continue;
        float waited_ms = state->pending ? elapsed_ms(s->time_ms, state->since_ms) : 0.0f;
        if (state->active || waited_ms >= c->delay_s * 1000.0f)
            return true;
    }
    return false;
}

/* Returns true if the delay goes on although the sample is missing: a reading past the limit came within the last
 * delay_s. The interlock becomes active only while its condition holds. */
static bool interlock_waits(const struct supervisor *s, uint8_t k)
{
    const struct measurement_state *m = &s->measurement[s->plan->interlock[k].measurement];
    return s->interlock[k].pending && !measurement_is_good(m) &&
           heard_within(s, k, s->plan->config.interlock[k].delay_s);
}

/* Applies interlocks last, over limits, rates and manual alike, so that nothing overrides them. */
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
        if (condition && (!state->pending || measurement_is_good(m)))
            state->heard_ms = (uint32_t)s->time_ms;
        state->pending = condition || interlock_waits(s, k);
        bool active = condition && (state->active || elapsed_ms(s->time_ms, state->since_ms) >=
                                                         c->delay_s * 1000.0f);
        active = latch_holds(s, k, active);
        if (active != state->active)
            event_put(s->events, s->time_ms, active ? EVENT_INTERLOCK_ON : EVENT_INTERLOCK_OFF,
                      c->mv, m->raw, k);
        state->active = active;
        uint8_t j = s->plan->interlock[k].mv;
        if (!active || interlocked[j] || !s->mv[j].bound)
            continue; /* the first entry of the table wins */
        interlocked[j] = true;
        const struct mv_config *o = &s->plan->config.mv[j];
        s->mv[j].constrained = span_to_fraction(c->value, o->lo, o->hi);
    }
    for (uint8_t j = 0; j < s->placed[PLACED_MVS]; j++) {
        uint8_t i = s->plan->owner[j];
        if (s->mv[j].interlocked == interlocked[j])
            continue;
        s->mv[j].interlocked = interlocked[j];
        if (i != PLAN_NONE)
            loop_find_driving(s, i);
    }
}

/* An interlock may have left the output outside lo..hi. In manual the output stays there until somebody moves it;
 * whatever moves it finds it at the nearest limit. Returns true if it stays. */
static bool stays_beyond(struct mv_state *o, num_t lo, num_t hi, bool acts)
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

/* Narrows lo..hi to the limits of a loop, which hold for its output after decoupler and feedforward. An output
 * found outside enters them at the loop's rate, or at once where there is no rate. */
static void loop_limits(const struct supervisor *s, uint8_t i, num_t at, num_t *lo, num_t *hi)
{
    const struct loop_config *l = &s->plan->config.loop[i];
    num_t least = num_from_float(l->own.out_lo), most = num_from_float(l->own.out_hi);
    if (l->own.out_rate_per_s > 0.0f) {
        /* The step is at least one of num_t, so that the output arrives. */
        num_t reach = num_max(num_from_float(l->own.out_rate_per_s * s->plan->tick_s),
                              num_from_float(1.0f / 16777216.0f));
        least = num_min(least, num_add(at, reach));
        most = num_max(most, num_sub(at, reach));
    }
    *lo = num_min(num_max(*lo, least), *hi);
    *hi = num_max(num_min(*hi, most), *lo);
}

static void constrain_mv(struct supervisor *s, uint8_t j)
{
    struct mv_state *o = &s->mv[j];
    const struct mv_config *c = &s->plan->config.mv[j];
    if (s->state == SUPERVISOR_SAFE || !o->bound) {
        /* An MV that the plant lacks waits at its safe value too, and begins there when it comes. */
        o->constrained = o->manual = span_to_fraction(c->safe, c->lo, c->hi);
        return;
    }
    num_t lo = span_to_fraction(c->min, c->lo, c->hi);
    num_t hi = span_to_fraction(c->max, c->lo, c->hi);
    uint8_t i = s->plan->owner[j];
    bool acts = i != PLAN_NONE && loop_acts(s, i);
    if (!acts) {
        /* The safe value may lie outside the operating limits; manual may stay there. */
        num_t safe = span_to_fraction(c->safe, c->lo, c->hi);
        lo = num_min(lo, safe);
        hi = num_max(hi, safe);
    }
    if (stays_beyond(o, lo, hi, acts))
        return;
    /* A value that is not sent now is not sent later either, when the limits are wider again. */
    o->manual = num_clamp(o->manual, lo, hi);
    if (acts && loop_drives(s, i) && !plan_kind(s->plan, i)->positions)
        loop_limits(s, i, o->constrained, &lo, &hi);
    /* The ramp starts from the present output, whatever put it there. It keeps wide numbers, so that slow rates do
     * not stall. */
    if (!num_eq(ramp_position(&o->rate), o->constrained))
        ramp_reset(&o->rate, o->constrained);
    o->constrained = ramp_step(&o->rate, num_clamp(o->commanded, lo, hi));
}

num_t mv_shortfall(const struct mv_state *o)
{
    return num_sub(mv_without_signal(o, o->applied), num_sub(o->commanded, o->excitation));
}

void constrain_mvs(struct supervisor *s)
{
    for (uint8_t j = 0; j < s->placed[PLACED_MVS]; j++)
        if (s->plan->config.mv[j].name[0])
            constrain_mv(s, j);
    run_interlocks(s);
    for (uint8_t j = 0; j < s->placed[PLACED_MVS]; j++) {
        struct mv_state *o = &s->mv[j];
        uint8_t i = s->plan->owner[j];
        if (!s->plan->config.mv[j].name[0])
            continue;
        o->applied = o->not_following ? o->readback : o->constrained;
        o->sent = true;
        o->beyond = o->beyond || o->interlocked;
        /* Manual begins where automatic or an interlock left the output. */
        if (o->interlocked || (i != PLAN_NONE && loop_drives(s, i)))
            o->manual = mv_without_signal(o, o->constrained);
    }
}
