/* A block with a number (blockN) has work, test signals, proposals and events, which the other blocks of its stage do not have, and
 * it may give up. Within supervise only. */
#ifndef REFLUX_SUPERVISE_NUMBERED_H
#define REFLUX_SUPERVISE_NUMBERED_H

#include "supervise/gather.h"

#if CONFIG_BLOCKS

static inline const struct numbered_plan *numbered_at(const struct supervisor *s, uint8_t block)
{
    REFLUX_ASSERT(block >= BLOCK_NUMBERED && block < PLAN_BLOCKS);
    return &s->plan->numbered[block - BLOCK_NUMBERED];
}

/* Returns the place behind the last blockN in use. */
static inline uint8_t numbered_end(const struct supervisor *s)
{
    return (uint8_t)(BLOCK_NUMBERED + s->plan->numbered_end);
}

/* gather() for any block; of a block with a number also what its members stand at, qualities, ages and histories. */
void gather_all(const struct supervisor *s, uint8_t block, struct gathered *g);

/* Returns the first of its inputs that is not usable, or PLAN_NONE. */
uint8_t first_bad_input(const struct supervisor *s, uint8_t block);

/* Makes its step, with the result of its work, the answer to its test signals and room for a proposal. Reports its
 * events. */
void numbered_step(struct supervisor *s, uint8_t block, struct gathered *g);
/* Grants the requests of a step that counts: work, test signals, a proposal, a switch-off. */
void numbered_grant(struct supervisor *s, uint8_t block, struct gathered *g);
/* After it was called: it gives up if it asks for that, or if one of its values is not a number: bit k of `which`, value[k].
 * Returns true if it goes on. */
bool numbered_goes_on(struct supervisor *s, uint8_t block, const struct gathered *g,
                      const num_t *value, uint8_t which);

/* Switches the block off from now on. The loops' own controllers act. The inputs of a compensator pass through it
 * unchanged, which begins with a bumpless transfer. */
void block_give_up(struct supervisor *s, uint8_t block, const char *reason);
/* Switches the block off because its k-th input is bad. */
void block_give_up_without(struct supervisor *s, uint8_t block, uint8_t k);

#define NOT_A_NUMBER "not_a_number" /* reason for giving up */
/* Returns true for a finite number. In floating point a block may diverge, and a value that is not a number must
 * reach nobody. */
static inline bool is_a_number(num_t x)
{
    return float_is_finite(num_to_float(x));
}

#else

#define gather_all(s, block, g)                     gather(s, block, g)
#define first_bad_input(s, block)                   PLAN_NONE
#define numbered_step(s, block, g)                  ((void)(s))
#define numbered_grant(s, block, g)                 ((void)(s))
#define numbered_goes_on(s, block, g, value, which) ((void)(s), (void)(block), (void)(g), true)
#define block_give_up_without(s, block, k)          ((void)(s))

#endif

/* The step of any block. */
static inline void step_gathered(struct supervisor *s, uint8_t block, struct gathered *g)
{
    if (block >= BLOCK_NUMBERED)
        numbered_step(s, block, g);
    else
        block_kind_at(s, block)->step(supervisor_block(s, block), &g->io);
}

#endif
