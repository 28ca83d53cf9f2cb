#include "supervise/transfer.h"

#include "exchange/span.h"
#include "supervise/blocks.h"
#include "supervise/compensate.h"
#include "supervise/numbered_control.h"

/* Returns the value of output j that a loop finds when it takes over: the limits for acting loops count from here
 * on. */
static num_t output_found(const struct supervisor *s, uint8_t j)
{
    const struct mv_config *c = &s->plan->config.mv[j];
    return num_clamp(s->mv[j].manual, span_to_fraction(c->min, c->lo, c->hi),
                     span_to_fraction(c->max, c->lo, c->hi));
}

/* Returns the loops that begin to act, or whose output has another meaning now. In most ticks there is none. */
static uint32_t loops_that_move(const struct supervisor *s)
{
    uint32_t loops = 0;
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++)
        if (s->loop[i].transfer_pending || s->loop[i].moved)
            loops |= 1u << i;
    return loops;
}

/* Transfers the loops that act from this tick on, and all loops of the compensator when its members change, to the
 * outputs they find: v = D^-1 (output - feedforward). Loops that acted before keep their transients, because a
 * derivative that dies away must not become part of the integral when another loop comes or goes. For them the
 * feedforward of the tick before counts, because the output they find contains that one, not the one of this tick. */
static void transfer_loops(struct supervisor *s, const num_t *before, uint32_t moves,
                           uint32_t compensated)
{
    num_t v[CONFIG_LOOPS];
    const uint8_t n = s->placed[PLACED_LOOPS];
    for (uint8_t i = 0; i < n; i++) {
        const struct loop_plan *p = &s->plan->loop[i];
        const struct loop_state *l = &s->loop[i];
        bool moves_itself = (moves & (1u << i)) != 0;
        v[i] = l->v;
        if (p->used && p->mv != PLAN_NONE && (moves_itself || compensated))
            /* The value is the one last sent, or just asked for by hand. A read-back is one sample old, and a valve
             * that still moves would start the loop from where it was. */
            v[i] = num_sub(output_found(s, p->mv), moves_itself ? l->feedforward : before[i]);
    }
    compensators_transfer(s, v);
    for (uint8_t i = 0; i < n; i++) {
        struct loop_state *l = &s->loop[i];
        if (!loop_drives(s, i))
            continue;
        uint8_t server = loop_server(s, i);
        bool found = ((moves | compensated) & (1u << i)) != 0;
        if (server != PLAN_NONE && found)
            numbered_must_follow(s, server);
        if (l->transfer_pending || (server != PLAN_NONE && found)) {
            l->v = v[i];
            block_follow(s, i);
        } else if (found) {
            block_shift(s, i, v[i]);
        }
        l->transfer_pending = l->moved = false;
    }
}

void bumpless_transfer(struct supervisor *s, const num_t *before)
{
    uint32_t moves = loops_that_move(s);
    uint32_t compensated = compensators_regroup(s, moves);
    if (moves || compensated)
        transfer_loops(s, before, moves, compensated);
    controllers_follow(s);
}
