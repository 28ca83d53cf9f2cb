#include "supervise/numbered_switch.h"

#include "supervise/blocks.h"
#include "supervise/by_board.h"
#include "supervise/numbered.h"
#include "supervise/numbered_place.h"
#include "supervise/raised.h"

static void come_on(struct supervisor *s, uint8_t block)
{
    uint8_t n = (uint8_t)(block - BLOCK_NUMBERED);
    s->numbered[n].on_pending = false;
    if (!block_is(s, block, STAGE_CONTROL)) /* the reason for giving up may be in its state */
        block_give_settings(s, block, false);
    s->block[block].off = false;
    s->block[block].must_follow = true;
    raised_forget(s, block);
    event_put(s->events, s->time_ms, EVENT_BLOCK_ON, s->plan->config.block[n].kind, (float)(n + 1u),
              0);
}

/* The main loop may be in the midst of a piece of the block's work, which the tick has interrupted. The tick clears
 * the block's state only after the end of that piece. */
static void come_on_when_idle(struct supervisor *s, uint8_t block)
{
    if (job_is_working(&s->work[block - BLOCK_NUMBERED]))
        s->numbered[block - BLOCK_NUMBERED].on_pending = true;
    else
        come_on(s, block);
}

bool numbered_switch(struct supervisor *s, uint8_t n, bool on)
{
    uint8_t block = (uint8_t)(BLOCK_NUMBERED + n);
    if (n >= CONFIG_BLOCKS || s->block[block].kind == PLAN_NONE ||
        block_is(s, block, STAGE_ESTIMATE))
        return false;
    s->numbered[n].on_pending = false;
    if (s->block[block].off != on)
        return true;
    if (!on) {
        block_give_up(s, block, "asked");
        raised_forget(s, block);
        if (block_is(s, block, STAGE_FEED_FORWARD))
            numbered_moves_loops(s, s->plan, block);
        s->block[block].running = false;
        return true;
    }
    come_on_when_idle(s, block);
    return true;
}

static void members_to_manual(struct supervisor *s, uint8_t block)
{
    const struct numbered_plan *r = numbered_at(s, block);
    for (uint8_t k = 0; k < r->members; k++)
        board_to_manual(s, r->member[k], BY_BOARD_BLOCK);
}

void numbered_check_inputs(struct supervisor *s)
{
    for (uint8_t block = BLOCK_NUMBERED; block < numbered_end(s); block++) {
        const struct numbered_plan *r = numbered_at(s, block);
        if (s->numbered[block - BLOCK_NUMBERED].on_pending)
            come_on_when_idle(s, block);
        if (!s->plan->config.block[block - BLOCK_NUMBERED].kind[0])
            continue;
        if (s->block[block].kind == PLAN_NONE) { /* this build cannot run it */
            members_to_manual(s, block);
            continue;
        }
        bool acts = false;
        for (uint8_t k = 0; k < r->members; k++)
            acts = acts || loop_drives(s, r->member[k]);
        if (s->block[block].off || !acts || block_kind_at(s, block)->bad_input == BAD_INPUT_IS_TOLD)
            continue;
        uint8_t bad = first_bad_input(s, block);
        if (bad == PLAN_NONE)
            continue;
        if (block_kind_at(s, block)->bad_input == BAD_INPUT_MANUAL)
            members_to_manual(s, block);
        else
            block_give_up_without(s, block, bad);
    }
}
