#include "exchange/block_links.h"

/* Member k of these is loop k. */
static const uint8_t each_loop[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                                    16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31};
_Static_assert(CONFIG_LOOPS <= sizeof each_loop && DECOUPLER_MAX <= CONFIG_LOOPS, "a number each");

void plan_links(const struct plan *plan, uint8_t slot, struct block_links *links)
{
    REFLUX_ASSERT(slot < PLAN_BLOCKS);
    if (slot >= SLOT_NUMBERED) {
        plan_numbered_links(plan, (uint8_t)(slot - SLOT_NUMBERED), links);
    } else if (slot >= SLOT_FEEDFORWARDS) {
        *links = (struct block_links){.inputs = 1,
                                      .points = 1,
                                      .input = &plan->feedforward[slot - SLOT_FEEDFORWARDS].input,
                                      .point = &plan->feedforward[slot - SLOT_FEEDFORWARDS].point};
    } else if (slot == SLOT_MATRIX) {
        *links = (struct block_links){.members = DECOUPLER_MAX, .member = each_loop};
    } else {
        *links = (struct block_links){.members = 1, .member = each_loop + slot};
    }
}

uint8_t plan_grains_behind(const struct plan *plan, uint8_t slot)
{
    if (plan_kind(plan, slot)->stage != STAGE_COMPENSATE)
        return 0;
    struct block_links links;
    plan_links(plan, slot, &links);
    return links.members;
}
