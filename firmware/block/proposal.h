/* Proposals: settings that a block has found, for itself or for another block (a tuner, a fit of a feedforward
 * element). The block writes ids and values into block_io.requests.proposal in its step. The main loop checks them
 * as a whole, as an `apply` would, and puts them into force without a bump: at once, or when somebody has accepted
 * them. It keeps the old values for the way back (operate/operate.h). */
#ifndef REFLUX_BLOCK_PROPOSAL_H
#define REFLUX_BLOCK_PROPOSAL_H

#include <stdint.h>

#define PROPOSAL_MAX 24

enum proposal_manner { PROPOSAL_WHEN_ACCEPTED, PROPOSAL_AT_ONCE };

struct proposed_value {
    uint32_t id; /* proposed_setting(), proposed_own() or proposed_in_row() */
    float value; /* value as `set` takes it, for a word its place in the list; no names */
};

struct block_proposal {
    uint8_t n;      /* values; 0: none */
    uint8_t manner; /* enum proposal_manner */
    struct proposed_value value[PROPOSAL_MAX];
};

/* A switch-off of a harmful feedforward element ffN, or of a harmful term of a feedforward element blockN. From
 * the next tick on it adds nothing, even while a transaction is open. The values, which have the same effect,
 * follow when the settings are free. */
#define SWITCH_OFF_MAX 2
struct block_switch_off {
    uint8_t n;       /* values; 0: none */
    uint8_t element; /* switch_off_of_ff() or switch_off_term() */
    struct proposed_value value[SWITCH_OFF_MAX];
};

/* Most terms of a feedforward element blockN: rows of this many values have one for each term. */
#define SWITCH_OFF_TERMS 8

/* Returns the number of a feedforward element ffN: 0 for ff1, and so on. */
static inline uint8_t switch_off_of_ff(uint8_t index)
{
    return index;
}

/* Returns the number of a term of the feedforward element blockN; both count from 0. */
static inline uint8_t switch_off_term(uint8_t block, uint8_t term)
{
    return (uint8_t)(SWITCH_OFF_TERMS * (block + 1u) + term);
}

/* Ids of settings, as in docs/reference/parameters.md. Other ids may be written in the same way. Only settings of loops,
 * decoupler, feedforward elements and blocks can be proposed. */
enum proposed {
    PROPOSED_LOOP_GAIN = 0x4100,
    PROPOSED_LOOP_TI = 0x4140,
    PROPOSED_LOOP_TD = 0x4180,
    PROPOSED_LOOP_B = 0x4200,
    PROPOSED_DECOUPLE_D1 = 0x5040, /* the index is the row; + 0x40 for each further column */
    PROPOSED_FF_GAIN = 0x60C0,
    PROPOSED_FF_LEAD = 0x6100,
    PROPOSED_FF_LAG = 0x6140,
    PROPOSED_FF_DEAD = 0x6180
};

/* Returns the id for the loop, row or element with that index, from 0 (block_member.loop). */
static inline uint32_t proposed_setting(enum proposed field, uint8_t index)
{
    return (uint32_t)field | index;
}

/* Index of the proposing block itself; proposed_own() returns the id of a parameter of its kind. */
#define PROPOSED_SELF 0x3Fu
static inline uint32_t proposed_own(uint8_t id)
{
    return (uint32_t)16 << 24 | (64u + id) << 16 | PROPOSED_SELF;
}

/* Returns the id of column `col` in row `row` of a table of a block. All count from 0; the block may be
 * PROPOSED_SELF. */
#define PROPOSED_COLUMN ((uint32_t)7 << 24)
static inline uint32_t proposed_in_row(uint8_t block, uint8_t id, uint16_t row, uint8_t col)
{
    return (proposed_own(id) & ~PROPOSED_SELF) | (uint32_t)col << 24 | (uint32_t)row << 6 | block;
}

/* Ids of the rows of an element of the kind `leadlag`, with a value for each term. Use proposed_in_row() for the
 * columns. */
enum proposed_of_term { TERM_GAIN = 3, TERM_LEAD, TERM_LAG, TERM_DEAD };

/* Returns the id with PROPOSED_SELF replaced by the number of the proposing block, from 0. */
static inline uint32_t proposed_by(uint8_t block, uint32_t id)
{
    return id >> 16 && (id & 0x3Fu) == PROPOSED_SELF ? (id & ~PROPOSED_SELF) | block : id;
}

#endif
