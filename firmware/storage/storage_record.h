/* Records of a stored set: one value of one parameter each, keyed by its id. tests/reference/storage-format.md has the bytes. */
#ifndef REFLUX_STORAGE_STORAGE_RECORD_H
#define REFLUX_STORAGE_STORAGE_RECORD_H

#include "settings/parameters.h"

#define RECORD_HEAD 4u /* id, type, size */
/* Parameters of blocks, and of devices and outputs at the board's pins, have ids of more than 16 bits. */
#define RECORDS_ARE_WIDE (CONFIG_BLOCKS || CONFIG_DEVICES)
/* Bytes of a long id, and of the longest record that this build writes. An id of more than 16 bits stands before the value, and
 * the short id in the head is then 0. */
#define RECORD_WIDE 4u
#define RECORD_MAX                                                                                 \
    (RECORD_HEAD + (RECORDS_ARE_WIDE ? RECORD_WIDE : 0u) +                                         \
     (CONFIG_BLOCKS ? BLOCK_NAMES_SIZE : CHANNEL_NAME_SIZE))
_Static_assert(BLOCK_NAMES_SIZE >= BLOCK_COLS_MAX * sizeof(float), "rows of tables fit as well");

enum storage_type {
    STORAGE_FLOAT = 1,
    STORAGE_U32 = 2,
    STORAGE_U16 = 3,
    STORAGE_WORD = 4, /* one byte, index into the words of the parameter */
    STORAGE_TEXT = 5, /* without terminating zero; empty = none */
    STORAGE_ROW = 6   /* of a table: its values, each in the bytes of its type */
};

/* A field that has moved: storage reads its records as those of the new field (group << 12 | field << 6). The table ends
 * with {0, 0}. */
struct storage_rename {
    uint16_t from, to;
};
extern const struct storage_rename storage_renames[];

struct stored_record {
    uint32_t address;
    uint32_t id;
    uint8_t type, size; /* enum storage_type; bytes after the head */
    uint8_t wide;       /* bytes of a long id among these; 0 without one */
};

/* Reads until two readings in a row agree, so that a single wrong reading has no effect. Words that read differently each
 * time, after a power cut, give the last reading. ERR_RANGE: outside the flash. */
MUST_CHECK enum err storage_read(uint32_t address, void *data, uint32_t n);

/* Reads the head of the record at `address`. left: bytes of the set from there on. Returns false where there is none. */
bool record_at(uint32_t address, uint32_t left, struct stored_record *r);
/* Finds the parameter that a record belongs to today. Returns false where this build has none. It knows the parameters of
 * a block's kind only where the block has that kind in *config. */
bool record_parameter(const struct stored_record *r, const struct config *config,
                      struct parameter *p, bool *renamed);
/* Finds the block that a record belongs to. Returns false where it belongs to no block of this build. */
bool record_of_block(const struct stored_record *r, uint8_t *block);
/* Returns whether the record is the kind of that block, and *config has the same kind there. */
bool record_is_kind(const struct stored_record *r, uint8_t block, const struct config *config);
/* Returns whether the record gives a block a kind whose settings are a table. */
bool record_is_table(const struct stored_record *r);
/* Puts the value of a record into the configuration. Returns false where it took the nearest allowed value, or none. */
bool record_take(const struct stored_record *r, const struct parameter *p, struct config *config);

/* Returns whether a set needs a record of the parameter: it belongs to something in use, or differs from the default. */
bool record_wanted(const struct parameter *p, const struct config *config);
/* Writes the record of a parameter. Returns its size, RECORD_MAX at most. */
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
