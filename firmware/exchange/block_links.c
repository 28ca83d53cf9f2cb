#include "exchange/block_links.h"

/* Member k of these is loop k. */
static const uint8_t each_loop[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                                    16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31};
_Static_assert(CONFIG_LOOPS <= sizeof each_loop && DECOUPLER_MAX <= CONFIG_LOOPS, "a number each");

void plan_links(const struct plan *plan, uint8_t block, struct block_links *links)
{
    REFLUX_ASSERT(block < PLAN_BLOCKS);
    if (block >= BLOCK_NUMBERED) {
        plan_numbered_links(plan, (uint8_t)(block - BLOCK_NUMBERED), links);
    } else if (block >= BLOCK_FEEDFORWARDS) {
        *links =
            (struct block_links){.inputs = 1,
                                 .points = 1,
                                 .input = &plan->feedforward[block - BLOCK_FEEDFORWARDS].input,
                                 .point = &plan->feedforward[block - BLOCK_FEEDFORWARDS].point};
    } else if (block == BLOCK_MATRIX) {
        *links = (struct block_links){.members = DECOUPLER_MAX, .member = each_loop};
    } else {
        *links = (struct block_links){.members = 1, .member = each_loop + block};
    }
}

uint8_t plan_grains_behind(const struct plan *plan, uint8_t block)
{
    if (plan_kind(plan, block)->stage != STAGE_COMPENSATE)
        return 0;
    struct block_links links;
    plan_links(plan, block, &links);
    return links.members;
}
