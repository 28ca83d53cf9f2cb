#include "supervise/feed_forward.h"

#include "supervise/blocks.h"
#include "supervise/by_board.h"
#include "supervise/numbered.h"
#include "supervise/raised.h"
#include "supervise/switch_offs.h"

static struct loop_state *loop_on(const struct supervisor *s, uint8_t mv)
{
    return &s->loop[s->plan->owner[mv]];
}

/* The loops on its MVs continue from the outputs they find. */
static void loops_make_room(struct supervisor *s, const struct block_links *links)
{
    for (uint8_t k = 0; k < links->points; k++)
        loop_on(s, links->point[k])->moved = true;
}

static void stop(struct supervisor *s, uint8_t block, const struct block_links *links)
{
    s->block[block].running = false;
    loops_make_room(s, links);
}

/* Every input has a value, and not all it adds is switched off. */
static bool has_values(const struct supervisor *s, uint8_t block, const struct block_links *links)
{
    for (uint8_t k = 0; k < links->inputs; k++)
        if (input_quality(s, links->input[k], false) == QUALITY_MISSING)
            return false;
    return block >= BLOCK_NUMBERED || !switched_off(s, block);
}

/* Does what its kind has declared for a bad input. Returns whether the block goes on. */
static bool stands_bad_input(struct supervisor *s, uint8_t block, const struct block_links *links)
{
    enum block_bad_input declared = block_kind_at(s, block)->bad_input;
    uint8_t bad = declared == BAD_INPUT_IS_TOLD ? (uint8_t)PLAN_NONE : first_bad_input(s, block);
    if (bad == PLAN_NONE)
        return true;
    if (!s->block[block].running) /* nothing depends on it yet */
        return false;
    if (declared == BAD_INPUT_GIVES_UP) {
        block_give_up_without(s, block, bad);
        stop(s, block, links);
        return false;
    }
    for (uint8_t k = 0; k < links->points; k++)
        board_to_manual(s, s->plan->owner[links->point[k]], BY_BOARD_BLOCK);
    return true;
}

/* Its terms that are switched off are told to it. */
static void tell_switched_off(struct supervisor *s, uint8_t block, struct gathered *g)
{
    if (block >= BLOCK_NUMBERED && switched_off_changes(s, block, &g->io))
        loops_make_room(s, &g->links);
}

static void add_to_loops(struct supervisor *s, uint8_t block, const struct gathered *g)
{
    num_t most = num_from_float(plan_added_most(block));
    for (uint8_t k = 0; k < g->links.points; k++) {
        struct loop_state *l = loop_on(s, g->links.point[k]);
        l->feedforward = num_add(l->feedforward, num_clamp(g->point[k], num_neg(most), most));
    }
}

static void step_feedforward(struct supervisor *s, uint8_t block)
{
    struct gathered g;
    gather_all(s, block, &g);
    bool runs = has_values(s, block, &g.links);
    if (!runs && s->block[block].running) { /* no value, no correction */
        raised_forget(s, block);
        stop(s, block, &g.links);
    }
    if (!runs || !stands_bad_input(s, block, &g.links))
        return;
    g.io.members.in = g.input;
    g.io.members.out = g.point;
    for (uint8_t k = 0; k < g.links.points; k++)
        if (loop_drives(s, s->plan->owner[g.links.point[k]]))
            g.io.members.acting = (uint8_t)(g.io.members.acting | (1u << k));
    tell_switched_off(s, block, &g);
    if (!s->block[block].running) {
        loops_make_room(s, &g.links);
        s->block[block].running = true;
        block_kind_at(s, block)->follow(supervisor_block(s, block), &g.io);
    }
    step_gathered(s, block, &g);
    if (!numbered_goes_on(s, block, &g, g.point, (uint8_t)((1u << g.links.points) - 1u))) {
        stop(s, block, &g.links);
        return;
    }
    numbered_grant(s, block, &g);
    add_to_loops(s, block, &g);
}

void feed_forward(struct supervisor *s, num_t *before)
{
    for (uint8_t i = 0; i < s->placed[PLACED_LOOPS]; i++) {
        before[i] = s->loop[i].feedforward;
        s->loop[i].feedforward = num_zero();
    }
    switch_offs_lift(s);
    uint8_t end = plan_stage_end(s->plan, STAGE_FEED_FORWARD);
    for (uint8_t k = plan_stage_begin(s->plan, STAGE_FEED_FORWARD); k < end; k++)
        if (!s->block[s->plan->listed[k]].off)
            step_feedforward(s, s->plan->listed[k]);
}
