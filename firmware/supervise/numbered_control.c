#include "supervise/numbered_control.h"

#include "supervise/blocks.h"
#include "supervise/compensate.h"
#include "supervise/numbered.h"
#include "supervise/raised.h"

void controllers_follow(struct supervisor *s)
{
    uint8_t end = plan_stage_end(s->plan, STAGE_CONTROL);
    for (uint8_t k = plan_stage_begin(s->plan, STAGE_CONTROL); k < end; k++) {
        uint8_t slot = s->plan->listed[k];
        struct block_state *b = &s->block[slot];
        if (!b->must_follow)
            continue;
        struct gathered g;
        gather(s, slot, &g);
        block_kind_at(s, slot)->follow(supervisor_block(s, slot), &g.io);
        b->must_follow = b->stepped = false;
    }
}

/* Steps the loops' own controllers, which act now, in this tick. */
static void own_step(struct supervisor *s, uint8_t slot, uint8_t acting)
{
    const struct numbered_plan *r = numbered_at(s, slot);
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
            (!is_a_number(g->out[k]) || !num_lt(num_abs(g->out[k]), num_from_float(COMMAND_MAX))))
            return false;
    return true;
}

void numbered_control(struct supervisor *s, uint8_t slot)
{
    const struct numbered_plan *r = numbered_at(s, slot);
    if (s->block[slot].off || !loop_due(s, r->member[0], s->ticks))
        return;
    const struct block_kind *kind = block_kind_at(s, slot);
    struct gathered g;
    gather(s, slot, &g);
    if (!g.io.members.acting) {
        raised_forget(s, slot);
        return;
    }
    /* The last step had no back-calculation yet: as if nothing had limited its outputs. */
    if (s->block[slot].stepped)
        kind->back_calculate(supervisor_block(s, slot), &g.io);
    numbered_step(s, slot, &g);
    if (!g.io.requests.gives_up && !gives_numbers(&g, r->members))
        g.io.requests.gives_up = NOT_A_NUMBER;
    if (g.io.requests.gives_up) {
        block_give_up(s, slot, g.io.requests.gives_up);
        own_step(s, slot, g.io.members.acting);
        return;
    }
    numbered_grant(s, slot, &g);
    for (uint8_t k = 0; k < r->members; k++) {
        if (!(g.io.members.acting & (1u << k)))
            continue;
        s->loop[r->member[k]].v = g.out[k];
        s->loop[r->member[k]].limited = g.numbered.limited[k];
    }
    s->block[slot].stepped = true;
}

void controllers_back_calculate(struct supervisor *s)
{
    uint8_t end = plan_stage_end(s->plan, STAGE_CONTROL);
    for (uint8_t listed = plan_stage_begin(s->plan, STAGE_CONTROL); listed < end; listed++) {
        uint8_t slot = s->plan->listed[listed];
        if (slot < SLOT_NUMBERED) /* loops' own controllers have been told already */
            continue;
        struct block_state *b = &s->block[slot];
        const struct numbered_plan *r = numbered_at(s, slot);
        struct gathered g;
        gather(s, slot, &g);
        if (b->off || !g.io.members.acting || b->must_follow) {
            b->must_follow = !b->off; /* it follows before it acts again */
            continue;
        }
        if (!b->stepped || !loop_due(s, r->member[0], s->ticks + 1u))
            continue;
        for (uint8_t k = 0; k < r->members; k++)
            if (g.io.members.acting & (1u << k))
                g.out[k] = s->loop[r->member[k]].served.applied;
        b->stepped = false;
        block_kind_at(s, slot)->back_calculate(supervisor_block(s, slot), &g.io);
        for (uint8_t k = 0; k < r->members; k++)
            if (g.io.members.acting & (1u << k))
                s->loop[r->member[k]].limited = g.numbered.limited[k];
    }
}

void numbered_forget(struct supervisor *s)
{
    for (uint8_t slot = SLOT_NUMBERED; slot < PLAN_BLOCKS; slot++) {
        s->block[slot].must_follow = true;
        s->block[slot].running = false;
    }
}
