#include "supervise/transfer.h"

#include <string.h>

#include "exchange/span.h"
#include "supervise/blocks.h"
#include "supervise/compensate_blocks.h"
#include "supervise/serve.h"

/* Returns the value of output j that a loop finds when it takes over: the limits for acting loops count from here
 * on. */
static num_t output_found(const struct supervisor *s, uint8_t j)
{
    const struct mv_config *c = &s->plan->config.mv[j];
    return num_clamp(s->mv[j].manual, span_to_fraction(c->min, c->lo, c->hi),
                     span_to_fraction(c->max, c->lo, c->hi));
}

/* Finds the loops that take part in the static decoupler now. A change to one of them concerns them all: then the
 * function returns these loops, and otherwise none. */
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
        changed = changed || s->loop[i].transfer_pending || s->loop[i].moved;
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

/* Returns true in most ticks: no loop joins, and no loop's output gets another meaning. */
static bool nothing_moves(const struct supervisor *s)
{
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++)
        if (s->loop[i].transfer_pending || s->loop[i].moved)
            return false;
    return true;
}

/* Transfers the loops that act from this tick on, and all loops of the compensator when its members change, to the
 * outputs they find: v = D^-1 (output - feedforward). Loops that acted before keep their transients, because a
 * derivative that dies away must not become part of the integral when another loop comes or goes. For them the
 * feedforward of the tick before counts, because the output they find contains that one, not the one of this tick. */
static void transfer_loops(struct supervisor *s, const num_t *before, uint8_t together,
                           uint32_t compensated)
{
    num_t v[CONFIG_LOOPS];
    const uint8_t n = s->placed[PLACED_LOOPS];
    for (uint8_t i = 0; i < n; i++) {
        const struct loop_plan *p = &s->plan->loop[i];
        const struct loop_state *l = &s->loop[i];
        bool moves = l->transfer_pending || l->moved;
        v[i] = l->v;
        if (p->used && p->mv != PLAN_NONE && (moves || together || compensated))
            /* The value is the one last sent, or just asked for by hand. A read-back is one sample old, and a valve
             * that still moves would start the loop from where it was. */
            v[i] = num_sub(output_found(s, p->mv), moves ? l->feedforward : before[i]);
    }
    if (together) {
        num_t u[DECOUPLER_MAX];
        memcpy(u, v, sizeof u);
        struct block_io io = {.members.acting = together, .members.in = u, .members.out = v};
        block_kinds[s->block[SLOT_MATRIX].kind]->back_calculate(supervisor_block(s, SLOT_MATRIX),
                                                                &io);
    }
    compensators_transfer(s, v);
    for (uint8_t i = 0; i < n; i++) {
        struct loop_state *l = &s->loop[i];
        if (!loop_drives(s, i))
            continue;
        uint8_t server = loop_server(s, i);
        bool moves = l->transfer_pending || l->moved ||
                     (i < DECOUPLER_MAX && (together & (1u << i))) ||
                     (compensated & (1u << i)) != 0;
        if (server != PLAN_NONE && moves)
            serve_must_follow(s, server);
        if (l->transfer_pending || (server != PLAN_NONE && moves)) {
            l->v = v[i];
            block_follow(s, i);
        } else if (moves) {
            block_shift(s, i, v[i]);
        }
        l->transfer_pending = l->moved = false;
    }
}

void bumpless_transfer(struct supervisor *s, const num_t *before)
{
    uint8_t together = regroup(s);
    uint32_t compensated = compensators_regroup(s);
    if (together || compensated || !nothing_moves(s))
        transfer_loops(s, before, together, compensated);
    serve_follow(s);
}
