/* Inputs and outputs of a block with a number (blockN), whatever its stage. Within supervise only. */
#ifndef REFLUX_SUPERVISE_SERVED_IO_H
#define REFLUX_SUPERVISE_SERVED_IO_H

#include "exchange/state.h"

#if CONFIG_BLOCKS

/* Arrays for struct block_io, with an entry for each member, input or point. */
struct served_io {
    struct block_io io;
    num_t setpoint[BLOCK_MEMBERS_MAX], in[BLOCK_MEMBERS_MAX], out[BLOCK_MEMBERS_MAX];
    uint8_t clamp[BLOCK_MEMBERS_MAX], limited[BLOCK_MEMBERS_MAX];
    num_t input[BLOCK_INPUTS_MAX], point[BLOCK_POINTS_MAX];
    uint8_t quality[BLOCK_INPUTS_MAX], point_quality[BLOCK_POINTS_MAX];
    float event_value[BLOCK_EVENTS_MAX];
    struct block_excitation excite[BLOCK_EXCITES_MAX];
    const struct applied_history *member_applied[BLOCK_MEMBERS_MAX],
        *input_applied[BLOCK_INPUTS_MAX];
    float age_s[BLOCK_INPUTS_MAX];
};

static inline const struct block_kind *served_kind(const struct supervisor *s, uint8_t slot)
{
    REFLUX_ASSERT(slot < PLAN_BLOCKS && s->block[slot].kind < block_kind_count);
    return block_kinds[s->block[slot].kind];
}

static inline const struct record_plan *served_record(const struct supervisor *s, uint8_t slot)
{
    REFLUX_ASSERT(slot >= SLOT_RECORDS && slot < PLAN_BLOCKS);
    return &s->plan->record[slot - SLOT_RECORDS];
}

/* Returns the slot behind the last blockN in use. */
static inline uint8_t served_end(const struct supervisor *s)
{
    return (uint8_t)(SLOT_RECORDS + s->plan->records);
}

static inline bool served_is(const struct supervisor *s, uint8_t slot, enum block_stage stage)
{
    return s->block[slot].kind != PLAN_NONE && served_kind(s, slot)->stage == stage;
}

/* Gathers the present state of its members, with their outputs and the set of those that drive; its inputs; and
 * points without a value. */
void served_gather(const struct supervisor *s, uint8_t slot, struct served_io *g);

/* Returns the enum quality of an input. measured: a value that stands in for a reading is bad. */
uint8_t served_input_quality(const struct supervisor *s, uint8_t input, bool measured);
/* Returns the first of its inputs that is not usable, or PLAN_NONE. */
uint8_t served_bad_input(const struct supervisor *s, uint8_t slot);

/* Makes its step, with the result of its work, the answer to its test signals and room for a proposal. Reports its
 * events. */
void served_step(struct supervisor *s, uint8_t slot, struct served_io *g);
/* Grants the requests of a step that counts: work, test signals, a proposal, a switch-off. */
void served_grant(struct supervisor *s, uint8_t slot, struct served_io *g);

/* Switches the block off from now on. The loops' own controllers act. The inputs of a compensator pass through it
 * unchanged, which begins with a bumpless transfer. */
void served_give_up(struct supervisor *s, uint8_t slot, const char *reason);
/* Switches the block off because its k-th input is bad. */
void served_give_up_without(struct supervisor *s, uint8_t slot, uint8_t k);

#define SERVED_NO_NUMBER "not_a_number" /* reason for giving up */
/* Returns true for a finite number. In floating point a block may diverge, and a value that is not a number must
 * reach nobody. */
static inline bool served_is_number(num_t x)
{
    return float_is_finite(num_to_float(x));
}

#endif

#endif
