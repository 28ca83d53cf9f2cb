/* Inputs and outputs of a block in a tick, for all blocks of a stage. Within supervise only. */
#ifndef REFLUX_SUPERVISE_GATHER_H
#define REFLUX_SUPERVISE_GATHER_H

#include "exchange/block_links.h"
#include "exchange/state.h"

/* Arrays that only blocks with a number (blockN) have. The struct is empty on a board without them. */
#if CONFIG_BLOCKS
#define GATHER_INPUTS BLOCK_INPUTS_MAX
#define GATHER_POINTS BLOCK_POINTS_MAX
struct numbered_io {
    num_t setpoint[BLOCK_MEMBERS_MAX];
    uint8_t clamp[BLOCK_MEMBERS_MAX], limited[BLOCK_MEMBERS_MAX];
    uint8_t quality[BLOCK_INPUTS_MAX], point_quality[BLOCK_POINTS_MAX];
    float event_value[BLOCK_EVENTS_MAX];
    struct block_excitation excite[BLOCK_EXCITES_MAX];
    const struct applied_history *member_applied[BLOCK_MEMBERS_MAX],
        *input_applied[BLOCK_INPUTS_MAX];
    float age_s[BLOCK_INPUTS_MAX];
};
#else
#define GATHER_INPUTS 1
#define GATHER_POINTS 1
struct numbered_io {
};
#endif

/* Arrays for struct block_io, with an entry for each member, input or point. */
struct gathered {
    struct block_io io;
    struct block_links links;
    num_t in[BLOCK_MEMBERS_MAX], out[BLOCK_MEMBERS_MAX];
    num_t input[GATHER_INPUTS], point[GATHER_POINTS];
    struct numbered_io numbered;
};

/* Fills in what every block looks at and has room for: g->links, with members that are loops of the plan, and values
 * of inputs. Points have no value yet. Each stage says what goes in and comes out. */
void gather(const struct supervisor *s, uint8_t block, struct gathered *g);

/* Returns enum quality of an input. measured: a value that stands in for a reading is bad. */
uint8_t input_quality(const struct supervisor *s, uint8_t input, bool measured);

static inline const struct block_kind *block_kind_at(const struct supervisor *s, uint8_t block)
{
    REFLUX_ASSERT(block < PLAN_BLOCKS && s->block[block].kind < block_kind_count);
    return block_kinds[s->block[block].kind];
}

static inline bool block_is(const struct supervisor *s, uint8_t block, enum block_stage stage)
{
    return s->block[block].kind != PLAN_NONE && block_kind_at(s, block)->stage == stage;
}

#endif
