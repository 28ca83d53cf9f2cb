#include "supervise/element_blocks.h"

#include "supervise/blocks.h"
#include "supervise/raised.h"
#include "supervise/served_io.h"

/* Makes the loops on its MVs continue from the outputs they find. */
static void loops_make_room(struct supervisor *s, uint8_t slot)
{
    const struct record_plan *r = served_record(s, slot);
    for (uint8_t k = 0; k < r->points; k++)
        s->loop[s->plan->owner[r->point[k]]].moved = true;
}

static void stop_element(struct supervisor *s, uint8_t slot)
{
    s->block[slot].running = false;
    loops_make_room(s, slot);
}

static bool inputs_there(const struct served_io *g, uint8_t inputs)
{
    for (uint8_t k = 0; k < inputs; k++)
        if (g->quality[k] == QUALITY_MISSING)
            return false;
    return true;
}

/* Does what the kind has declared for a bad input. Returns true if the element goes on. */
static bool stands_bad_input(struct supervisor *s, uint8_t slot)
{
    const struct record_plan *r = served_record(s, slot);
    uint8_t bad = served_bad_input(s, slot);
    if (bad == PLAN_NONE || served_kind(s, slot)->bad_input == BAD_INPUT_IS_TOLD)
        return true;
    if (!s->block[slot].running) /* nothing depends on it yet */
        return false;
    if (served_kind(s, slot)->bad_input == BAD_INPUT_GIVES_UP) {
        served_give_up_without(s, slot, bad);
        stop_element(s, slot);
        return false;
    }
    for (uint8_t k = 0; k < r->points; k++)
        loop_to_manual(s, s->plan->owner[r->point[k]]);
    return true;
}

/* Returns true if the element adds a number to each MV. */
static bool gave_corrections(const struct served_io *g, uint8_t points)
{
    for (uint8_t k = 0; k < points; k++)
        if (!served_is_number(g->point[k]))
            return false;
    return true;
}

static void run_element(struct supervisor *s, uint8_t slot, struct served_io *g)
{
    const struct record_plan *r = served_record(s, slot);
    const struct block_kind *kind = served_kind(s, slot);
    void *state = supervisor_block(s, slot);
    g->io.members.in = g->input;
    g->io.members.out = g->point;
    for (uint8_t k = 0; k < r->points; k++)
        if (loop_drives(s, s->plan->owner[r->point[k]]))
            g->io.members.acting = (uint8_t)(g->io.members.acting | (1u << k));
    g->io.requests.silenced = s->silenced[1 + slot - SLOT_RECORDS];
    if (s->served[slot - SLOT_RECORDS].silenced != g->io.requests.silenced)
        loops_make_room(s, slot);
    s->served[slot - SLOT_RECORDS].silenced = g->io.requests.silenced;
    if (!s->block[slot].running) {
        loops_make_room(s, slot);
        s->block[slot].running = true;
        kind->follow(state, &g->io);
    }
    served_step(s, slot, g);
    if (g->io.requests.gives_up || !gave_corrections(g, r->points)) {
        served_give_up(s, slot,
                       g->io.requests.gives_up ? g->io.requests.gives_up : SERVED_NO_NUMBER);
        stop_element(s, slot);
        return;
    }
    served_grant(s, slot, g);
    num_t most = num_from_float(PLAN_ELEMENT_MOST);
    for (uint8_t k = 0; k < r->points; k++) {
        struct loop_state *l = &s->loop[s->plan->owner[r->point[k]]];
        num_t added = num_clamp(g->point[k], num_neg(most), most);
        l->feedforward = num_add(l->feedforward, added);
    }
}

void elements_step(struct supervisor *s)
{
    for (uint8_t slot = SLOT_RECORDS; slot < served_end(s); slot++) {
        struct block_state *b = &s->block[slot];
        if (!served_is(s, slot, STAGE_FEED_FORWARD) || b->off)
            continue;
        struct served_io g;
        served_gather(s, slot, &g);
        bool there = inputs_there(&g, served_record(s, slot)->inputs);
        if (!there && b->running) { /* without a number there is no correction */
            b->running = false;
            raised_forget(s, slot);
            loops_make_room(s, slot);
        }
        if (there && stands_bad_input(s, slot))
            run_element(s, slot, &g);
    }
}
