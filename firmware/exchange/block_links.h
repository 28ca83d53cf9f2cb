/* Who is connected to a block of the plan, whatever kind of block it is. */
#ifndef REFLUX_EXCHANGE_BLOCK_LINKS_H
#define REFLUX_EXCHANGE_BLOCK_LINKS_H

#include "exchange/plan.h"

/* The arrays stand in the plan, or are constant. */
struct block_links {
    uint8_t members, inputs, points; /* numbers of entries */
    const uint8_t *member;           /* loops */
    const uint8_t *input;            /* measurements, or MVs with INPUT_IS_MV */
    const uint8_t *point;            /* measurements; of a feedforward block the MVs it adds to */
};

/* Fills *links for a block of the plan. The static decoupler has a member for each of its rows, whether or not there is
 * such a loop: plan_takes_part() tells. */
void plan_links(const struct plan *plan, uint8_t block, struct block_links *links);

/* The same of blockN, from 0. */
#if CONFIG_BLOCKS
static inline void plan_numbered_links(const struct plan *plan, uint8_t n,
                                       struct block_links *links)
{
    const struct numbered_plan *p = &plan->numbered[n];
    *links = (struct block_links){.members = p->members,
                                  .inputs = p->inputs,
                                  .points = p->points,
                                  .member = p->member,
                                  .input = p->input,
                                  .point = p->point};
}
#else
#define plan_numbered_links(plan, n, links) ((void)(plan))
#endif

/* Returns true if loop i, a member of that block, takes part in it while it acts. */
static inline bool plan_takes_part(const struct plan *plan, uint8_t block, uint8_t i)
{
    return block != BLOCK_MATRIX || plan->loop[i].decouple;
}

/* Returns the number of grains behind the state of a block: of a compensator one for each member, for what
 * passed through it (supervise/compensate.c). */
uint8_t plan_grains_behind(const struct plan *plan, uint8_t block);

#endif
