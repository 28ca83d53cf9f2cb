/* What a block with a record (blockN) is given and gives, whatever its stage. Within supervise only. */
#ifndef REFLUX_SUPERVISE_SERVED_IO_H
#define REFLUX_SUPERVISE_SERVED_IO_H

#include "exchange/state.h"

#if CONFIG_BLOCKS

/* Member by member, input by input, point by point. */
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

/* The slot behind the last record in use. */
static inline uint8_t served_end(const struct supervisor *s)
{
    return (uint8_t)(SLOT_RECORDS + s->plan->records);
}

static inline bool served_is(const struct supervisor *s, uint8_t slot, enum block_stage stage)
{
    return s->block[slot].kind != PLAN_NONE && served_kind(s, slot)->stage == stage;
}

/* Its members as they stand, with their present outputs and which of them drive; its inputs; points without a value. */
void served_gather(const struct supervisor *s, uint8_t slot, struct served_io *g);

/* enum quality of an input. measured: what stands in for a reading is bad. */
uint8_t served_input_quality(const struct supervisor *s, uint8_t input, bool measured);
/* Which of its inputs is the first that is not usable, or PLAN_NONE. */
uint8_t served_bad_input(const struct supervisor *s, uint8_t slot);

/* Its step, with the result of its work, what became of its test signals and room for a proposal; its events are told. */
void served_step(struct supervisor *s, uint8_t slot, struct served_io *g);
/* What it has asked for in a step that counts: work, test signals, a proposal. */
void served_grant(struct supervisor *s, uint8_t slot, struct served_io *g);

/* It is off from now on. The loops' own controllers act; of a compensator: its members' outputs pass through it as they are,
 * which begins with a bumpless transfer. */
void served_give_up(struct supervisor *s, uint8_t slot, const char *reason);
/* The same for want of its k-th input. */
void served_give_up_without(struct supervisor *s, uint8_t slot, uint8_t k);

#define SERVED_NO_NUMBER "not_a_number" /* reason for giving up */
/* In floating point a block may have come apart: what is no number must reach nobody. */
static inline bool served_is_number(num_t x)
{
    return float_is_finite(num_to_float(x));
}

#endif

#endif
