#include "supervise/back_calculate.h"

#include "supervise/blocks.h"
#include "supervise/compensate.h"
#include "supervise/constrain.h"
#include "supervise/numbered_control.h"
#include "supervise/setpoint.h"
#include "supervise/setpoint_cascade.h"
#include "supervise/test_signal.h"

/* Returns the directions in which the setpoint of loop i should not move, because its own output is at a limit. */
static uint8_t saturation(const struct supervisor *s, uint8_t i)
{
    const struct loop_state *l = &s->loop[i];
    const struct loop_plan *p = &s->plan->loop[i];
    if (loop_interlocked(s, i))
        return INTEGRAL_CLAMP_UP | INTEGRAL_CLAMP_DOWN;
    bool up = (l->limited & INTEGRAL_CLAMP_UP) != 0;
    bool down = (l->limited & INTEGRAL_CLAMP_DOWN) != 0;
    if (p->mv != PLAN_NONE) {
        num_t shortfall = mv_shortfall(&s->mv[p->mv]);
        up = up || num_lt(shortfall, num_zero());
        down = down || num_lt(num_zero(), shortfall);
    } else { /* whether or not the inner loop has taken the setpoint already */
        num_t taken = setpoint_taken(s, p->inner, l->v);
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

/* Tells the block or controller that acts for loop i what took effect of its output. If a block acts, the loop's
 * own controller follows. */
static void tell_applied(struct supervisor *s, uint8_t i, num_t told, uint8_t clamp)
{
    if (loop_server(s, i) != PLAN_NONE) {
        loop_applied(&s->loop[i], told);
        s->loop[i].clamp = clamp;
        block_follow_at(s, i, told);
        return;
    }
    if (block_closes(s, i))
        block_back_calculate(s, i, told, clamp);
}

static void back_direct(struct supervisor *s, uint8_t i, num_t told)
{
    struct loop_state *l = &s->loop[i];
    const struct loop_plan *p = &s->plan->loop[i];
    if (loop_interlocked(s, i))
        l->transfer_pending = true; /* whenever the interlock lets go */
    if (l->mode != LOOP_MANUAL && !l->transfer_pending) {
        tell_applied(s, i, told, INTEGRAL_FREE);
        return;
    }
    const struct mv_state *o = &s->mv[p->mv];
    l->v = num_sub(mv_without_signal(o, o->applied), l->feedforward);
    block_follow(s, i);
}

static void back_outer(struct supervisor *s, uint8_t i)
{
    struct loop_state *l = &s->loop[i];
    const struct loop_plan *p = &s->plan->loop[i];
    const struct loop_state *inner = &s->loop[p->inner];
    /* The inner loop does not take this loop's output: it is not in cascade, or its own output reaches nothing. */
    l->downstream_inactive = inner->mode != LOOP_CASCADE || inner->downstream_inactive;
    if (l->downstream_inactive)
        l->v = setpoint_found(s, p->inner);
    if (l->mode == LOOP_MANUAL || l->downstream_inactive) {
        block_follow(s, i);
        if (l->downstream_inactive && loop_server(s, i) != PLAN_NONE)
            numbered_must_follow(s, loop_server(s, i));
        return;
    }
    l->clamp = saturation(s, p->inner);
    /* The setpoint that the inner loop takes does not depend on whose turn comes first. */
    tell_applied(s, i, setpoint_taken(s, p->inner, l->v), l->clamp);
}

void back_calculate_loops(struct supervisor *s)
{
    num_t effect[CONFIG_LOOPS];
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++) {
        uint8_t j = s->plan->loop[i].mv;
        effect[i] = s->loop[i].v;
        if (j != PLAN_NONE)
            effect[i] = num_add(effect[i], mv_shortfall(&s->mv[j]));
    }
    compensators_back_calculate(s, effect);
    /* Inner loops come first, because the limits of an outer loop depend on them. */
    for (uint8_t k = plan_stage_end(s->plan, STAGE_CONTROL); k-- > 0;) {
        uint8_t i = s->plan->listed[k];
        if (i >= CONFIG_LOOPS) /* blocks with a number come when it is known for all loops */
            continue;
        if (s->plan->loop[i].mv != PLAN_NONE)
            back_direct(s, i, effect[i]);
        else
            back_outer(s, i);
    }
    controllers_back_calculate(s);
}
