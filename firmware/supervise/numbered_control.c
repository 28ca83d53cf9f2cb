#include "supervise/numbered_control.h"

#include "supervise/blocks.h"
#include "supervise/compensate.h"
#include "supervise/numbered.h"
#include "supervise/raised.h"

void controllers_follow(struct supervisor *s)
{
    uint8_t end = plan_stage_end(s->plan, STAGE_CONTROL);
    for (uint8_t k = plan_stage_begin(s->plan, STAGE_CONTROL); k < end; k++) {
        uint8_t block = s->plan->listed[k];
        struct block_state *b = &s->block[block];
        if (!b->must_follow)
            continue;
        struct gathered g;
        gather_all(s, block, &g);
        block_kind_at(s, block)->follow(supervisor_block(s, block), &g.io);
        b->must_follow = b->stepped = false;
    }
}

/* Steps the loops' own controllers, which act now, in this tick. */
static void own_step(struct supervisor *s, uint8_t block, uint8_t acting)
{
    const struct numbered_plan *r = numbered_at(s, block);
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
            !num_lt(num_abs(g->out[k]), num_from_float(COMMAND_MAX))) /* nor is NaN less */
            return false;
    return true;
}

void numbered_control(struct supervisor *s, uint8_t block)
{
    const struct numbered_plan *r = numbered_at(s, block);
    if (s->block[block].off || !loop_due(s, r->member[0], s->ticks))
        return;
    const struct block_kind *kind = block_kind_at(s, block);
    struct gathered g;
    gather_all(s, block, &g);
    if (!g.io.members.acting) {
        raised_forget(s, block);
        return;
    }
    /* The last step had no back-calculation yet: as if nothing had limited its outputs. */
    if (s->block[block].stepped)
        kind->back_calculate(supervisor_block(s, block), &g.io);
    numbered_step(s, block, &g);
    if (!g.io.requests.gives_up && !gives_numbers(&g, r->members))
        g.io.requests.gives_up = NOT_A_NUMBER;
    if (g.io.requests.gives_up) {
        block_give_up(s, block, g.io.requests.gives_up);
        own_step(s, block, g.io.members.acting);
        return;
    }
    numbered_grant(s, block, &g);
    for (uint8_t k = 0; k < r->members; k++) {
        if (!(g.io.members.acting & (1u << k)))
            continue;
        s->loop[r->member[k]].v = g.out[k];
        s->loop[r->member[k]].limited = g.numbered.limited[k];
    }
    s->block[block].stepped = true;
}

void controllers_back_calculate(struct supervisor *s)
{
    uint8_t end = plan_stage_end(s->plan, STAGE_CONTROL);
    for (uint8_t listed = plan_stage_begin(s->plan, STAGE_CONTROL); listed < end; listed++) {
        uint8_t block = s->plan->listed[listed];
        if (block < BLOCK_NUMBERED) /* loops' own controllers have been told already */
            continue;
        struct block_state *b = &s->block[block];
        const struct numbered_plan *r = numbered_at(s, block);
        struct gathered g;
        gather_all(s, block, &g);
        if (b->off || !g.io.members.acting || b->must_follow) {
            b->must_follow = !b->off; /* it follows before it acts again */
            continue;
        }
        if (!b->stepped || !loop_due(s, r->member[0], s->ticks + 1u))
            continue;
        for (uint8_t k = 0; k < r->members; k++)
            if (g.io.members.acting & (1u << k))
                g.out[k] = s->loop[r->member[k]].of_block.applied;
        b->stepped = false;
        block_kind_at(s, block)->back_calculate(supervisor_block(s, block), &g.io);
        for (uint8_t k = 0; k < r->members; k++)
            if (g.io.members.acting & (1u << k))
                s->loop[r->member[k]].limited = g.numbered.limited[k];
    }
}

void numbered_forget(struct supervisor *s)
{
    for (uint8_t block = BLOCK_NUMBERED; block < PLAN_BLOCKS; block++) {
        s->block[block].must_follow = true;
        s->block[block].running = false;
    }
}
