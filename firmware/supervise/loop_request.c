#include "supervise/loop_request.h"

#include "exchange/span.h"
#include "supervise/block_excitation.h"
#include "supervise/by_board.h"
#include "supervise/setpoint.h"
#include "supervise/setpoint_limits.h"

static num_t output_fraction(const struct supervisor *s, unsigned j, float value)
{
    const struct mv_config *o = &s->plan->config.mv[j];
    return span_to_fraction(value, o->lo, o->hi);
}

/* Returns true if the PV and the MV of a loop, and the PVs of every loop below it, are bound. */
static bool loop_bound(const struct supervisor *s, uint8_t i)
{
    /* At most CONFIG_LOOPS steps down a chain that plan_build has proved free of rings. */
    for (unsigned depth = 0; depth < CONFIG_LOOPS && i != PLAN_NONE; depth++) {
        const struct loop_plan *p = &s->plan->loop[i];
        if (!s->measurement[p->pv].bound)
            return false;
        if (p->mv != PLAN_NONE)
            return s->mv[p->mv].bound;
        i = p->inner;
    }
    return false;
}

static bool request_mode(struct supervisor *s, const struct request *r)
{
    struct loop_state *l = &s->loop[r->loop];
    const struct loop_plan *p = &s->plan->loop[r->loop];
    const char *name = s->plan->config.loop[r->loop].name;
    enum loop_mode mode = (enum loop_mode)r->mode;
    if (mode != LOOP_MANUAL) {
        bool possible = loop_bound(s, r->loop) && s->measurement[p->pv].seen &&
                        measurement_may_control(&s->measurement[p->pv]) &&
                        !(mode == LOOP_CASCADE && p->outer == PLAN_NONE);
        if (!possible) {
            event_put(s->events, s->time_ms, EVENT_MODE_REFUSED, name, (float)mode, (uint8_t)mode);
            return false;
        }
    }
    by_board_end(s, r->loop);
    if (l->mode == mode)
        return true;
    if (mode == LOOP_CASCADE) { /* the outer loop may be new, or this its first reading */
        s->loop[p->outer].v = setpoint_found(s, r->loop);
        s->loop[p->outer].transfer_pending = true;
        if (CONFIG_BLOCKS)
            setpoint_rest(l, s->loop[p->outer].v);
    }
    bool from_manual = l->mode == LOOP_MANUAL;
    if (l->mode == LOOP_CASCADE) {
        l->target = loop_own_setpoint(l); /* the setpoint stays where the outer loop left it */
        if (CONFIG_BLOCKS)
            setpoint_rest(l, l->target);
    }
    l->mode = mode;
    if (from_manual) {
        l->transfer_pending = true;
        setpoint_start(s, r->loop);
    }
    l->sp_given = true;
    s->state = SUPERVISOR_RUN;
    event_put(s->events, s->time_ms, EVENT_MODE, name, (float)mode, (uint8_t)mode);
    return true;
}

static bool request_setpoint(struct supervisor *s, const struct request *r)
{
    struct loop_state *l = &s->loop[r->loop];
    const struct measurement_config *m = &s->plan->config.measurement[s->plan->loop[r->loop].pv];
    const struct loop_config *c = &s->plan->config.loop[r->loop];
    float lo, hi;
    plan_setpoint_limits(s->plan, r->loop, &lo, &hi);
    if (l->mode == LOOP_CASCADE || (l->mode == LOOP_MANUAL && c->sp_track) || r->value < lo ||
        r->value > hi) {
        event_put(s->events, s->time_ms, EVENT_REQUEST_REFUSED, c->name, r->value, 0);
        return false;
    }
    l->target = span_to_fraction(r->value, m->lo, m->hi);
    l->sp_given = true;
    event_put(s->events, s->time_ms, EVENT_SETPOINT, c->name, r->value, 0);
    return true;
}

static bool request_output(struct supervisor *s, const struct request *r)
{
    uint8_t j = r->output;
    const char *name;
    if (j == PLAN_NONE) {
        struct loop_state *l = &s->loop[r->loop];
        const struct loop_plan *p = &s->plan->loop[r->loop];
        name = s->plan->config.loop[r->loop].name;
        /* The output of an outer loop follows the inner one until that is in cascade. */
        bool inactive = p->mv == PLAN_NONE && s->loop[p->inner].mode != LOOP_CASCADE;
        /* A loop's output can be moved by hand without its measurement. */
        bool there = p->mv == PLAN_NONE ? loop_bound(s, r->loop) : s->mv[p->mv].bound;
        if (l->mode != LOOP_MANUAL || inactive || !there) {
            event_put(s->events, s->time_ms, EVENT_REQUEST_REFUSED, name, r->value, 0);
            return false;
        }
        if (p->mv == PLAN_NONE) {
            const struct measurement_config *m =
                &s->plan->config.measurement[s->plan->loop[p->inner].pv];
            l->v = span_to_fraction(r->value, m->lo, m->hi);
        } else {
            s->mv[p->mv].manual = output_fraction(s, p->mv, r->value);
            excitation_end_by_hand(s, p->mv);
        }
    } else {
        name = s->plan->config.mv[j].name;
        if (!s->mv[j].bound || s->plan->owner[j] != PLAN_NONE) {
            event_put(s->events, s->time_ms, EVENT_REQUEST_REFUSED, name, r->value, 0);
            return false;
        }
        s->mv[j].manual = output_fraction(s, j, r->value);
        excitation_end_by_hand(s, j);
    }
    s->state = SUPERVISOR_RUN;
    event_put(s->events, s->time_ms, EVENT_OUTPUT, name, r->value, 0);
    return true;
}

bool loop_request(struct supervisor *s, const struct request *r)
{
    bool loop_ok = r->loop < CONFIG_LOOPS && s->plan->loop[r->loop].used;
    bool output_ok = r->output < CHANNEL_MAX && s->plan->config.mv[r->output].name[0];
    if (r->kind == REQUEST_MODE && loop_ok)
        return request_mode(s, r);
    if (r->kind == REQUEST_SETPOINT && loop_ok)
        return request_setpoint(s, r);
    if (r->kind == REQUEST_OUTPUT && (r->output == PLAN_NONE ? loop_ok : output_ok))
        return request_output(s, r);
    event_put(s->events, s->time_ms, EVENT_REQUEST_REFUSED, NULL, r->value, 0);
    return false;
}
