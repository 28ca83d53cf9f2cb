#include "supervise/numbered_switch.h"

#include "supervise/blocks.h"
#include "supervise/numbered.h"
#include "supervise/numbered_place.h"
#include "supervise/raised.h"

static void come_on(struct supervisor *s, uint8_t slot)
{
    uint8_t n = (uint8_t)(slot - SLOT_NUMBERED);
    s->served[n].on_pending = false;
    if (!block_is(s, slot, STAGE_CONTROL)) /* the reason for giving up may be in its state */
        block_give_settings(s, slot, false);
    s->block[slot].off = false;
    s->block[slot].must_follow = true;
    raised_forget(s, slot);
    event_put(s->events, s->time_ms, EVENT_BLOCK_ON, s->plan->config.block[n].kind, (float)(n + 1u),
              0);
}

/* The main loop may be in the midst of a piece of the block's work, which the tick has interrupted. The tick clears
 * the block's state only after the end of that piece. */
static void come_on_when_idle(struct supervisor *s, uint8_t slot)
{
    if (job_is_working(&s->work[slot - SLOT_NUMBERED]))
        s->served[slot - SLOT_NUMBERED].on_pending = true;
    else
        come_on(s, slot);
}

bool numbered_switch(struct supervisor *s, uint8_t n, bool on)
{
    uint8_t slot = (uint8_t)(SLOT_NUMBERED + n);
    if (n >= CONFIG_BLOCKS || s->block[slot].kind == PLAN_NONE || block_is(s, slot, STAGE_ESTIMATE))
        return false;
    s->served[n].on_pending = false;
    if (s->block[slot].off != on)
        return true;
    if (!on) {
        block_give_up(s, slot, "asked");
        raised_forget(s, slot);
        if (block_is(s, slot, STAGE_FEED_FORWARD))
            numbered_moves_loops(s, s->plan, slot);
        s->block[slot].running = false;
        return true;
    }
    come_on_when_idle(s, slot);
    return true;
}

static void members_to_manual(struct supervisor *s, uint8_t slot)
{
    const struct numbered_plan *r = numbered_at(s, slot);
    for (uint8_t k = 0; k < r->members; k++)
        loop_to_manual(s, r->member[k]);
}

void numbered_check_inputs(struct supervisor *s)
{
    for (uint8_t slot = SLOT_NUMBERED; slot < numbered_end(s); slot++) {
        const struct numbered_plan *r = numbered_at(s, slot);
        if (s->served[slot - SLOT_NUMBERED].on_pending)
            come_on_when_idle(s, slot);
        if (!s->plan->config.block[slot - SLOT_NUMBERED].kind[0])
            continue;
        if (s->block[slot].kind == PLAN_NONE) { /* this build cannot run it */
            members_to_manual(s, slot);
            continue;
        }
        bool acts = false;
        for (uint8_t k = 0; k < r->members; k++)
            acts = acts || loop_drives(s, r->member[k]);
        if (s->block[slot].off || !acts || block_kind_at(s, slot)->bad_input == BAD_INPUT_IS_TOLD)
            continue;
        uint8_t bad = first_bad_input(s, slot);
        if (bad == PLAN_NONE)
            continue;
        if (block_kind_at(s, slot)->bad_input == BAD_INPUT_MANUAL)
            members_to_manual(s, slot);
        else
            block_give_up_without(s, slot, bad);
    }
}
