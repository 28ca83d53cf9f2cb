/* Records of a stored set: one value of one parameter each, keyed by its id. docs/storage.md has the bytes. */
#ifndef REFLUX_STORAGE_STORAGE_RECORD_H
#define REFLUX_STORAGE_STORAGE_RECORD_H

#include "settings/parameters.h"

#define RECORD_HEAD 4u /* id, type, size */
/* Of those this build writes. Ids of more than 16 bits stand in front of the value, behind a short one of 0. */
#define RECORD_WIDE 4u
#define RECORD_MAX                                                                                 \
    (RECORD_HEAD + (CONFIG_BLOCKS ? RECORD_WIDE + BLOCK_NAMES_SIZE : CHANNEL_NAME_SIZE))
_Static_assert(BLOCK_NAMES_SIZE >= RECORD_COLS_MAX * sizeof(float), "rows of tables fit as well");

enum storage_type {
    STORAGE_FLOAT = 1,
    STORAGE_U32 = 2,
    STORAGE_U16 = 3,
    STORAGE_WORD = 4, /* one byte, index into the words of the parameter */
    STORAGE_TEXT = 5, /* without terminating zero; empty = none */
    STORAGE_ROW = 6   /* of a table: its values, each in the bytes of its type */
};

/* A field that has moved: its records are read as those of the new one (group << 12 | field << 6). The table ends
 * with {0, 0}. */
struct storage_rename {
    uint16_t from, to;
};
extern const struct storage_rename storage_renames[];

struct stored_record {
    uint32_t address;
    uint32_t id;
    uint8_t type, size; /* size of what follows the head */
    uint8_t wide;       /* bytes of that which are the id */
};

/* Reads as often as it takes until two readings in a row agree: that one reading goes wrong has no effect. Words that
 * read differently each time, after a cut of the power, give what was read last. ERR_RANGE outside the flash. */
MUST_CHECK enum err storage_read(uint32_t address, void *data, uint32_t n);

/* The record at `address`, of which `left` bytes of the set are still there; false = there is none. */
bool record_at(uint32_t address, uint32_t left, struct stored_record *r);
/* The parameter a record belongs to today; false = this build knows of none. Those of a block's kind are known where the
 * block has that kind in *config. */
bool record_parameter(const struct stored_record *r, const struct config *config,
                      struct parameter *p, bool *renamed);
/* The block it belongs to, whatever it is of that block; false: of none that this build has. */
bool record_of_block(const struct stored_record *r, uint8_t *block);
/* It is the kind of that block, and *config has the same one there. */
bool record_is_kind(const struct stored_record *r, uint8_t block, const struct config *config);
/* It says that a block has a kind whose settings are a table. */
bool record_is_table(const struct stored_record *r);
/* Puts its value into the configuration. False: it had to be changed to the nearest one allowed, or left out. */
bool record_take(const struct stored_record *r, const struct parameter *p, struct config *config);

/* Whether a set must have a record of it: it belongs to something in use, or differs from the default. */
bool record_wanted(const struct parameter *p, const struct config *config);
/* Writes the record; returns its size, RECORD_MAX at most. */
uint8_t record_encode(const struct parameter *p, struct config *config, uint8_t *record);

static inline uint32_t get32(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static inline uint16_t get16(const uint8_t *p)
{
    return (uint16_t)(p[0] | p[1] << 8);
}

static inline void put32(uint8_t *p, uint32_t x)
{
    p[0] = (uint8_t)x;
    p[1] = (uint8_t)(x >> 8);
    p[2] = (uint8_t)(x >> 16);
    p[3] = (uint8_t)(x >> 24);
}

static inline void put16(uint8_t *p, uint16_t x)
{
    p[0] = (uint8_t)x;
    p[1] = (uint8_t)(x >> 8);
}

#endif
