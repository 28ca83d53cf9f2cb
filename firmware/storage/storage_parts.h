/* Shared by the files of storage alone: storage_turns.c (a start, turns), storage_read.c (find, check, load) and
 * storage_write.c (erase, save). docs/inside/storage.md has the format. */
#ifndef REFLUX_STORAGE_STORAGE_PARTS_H
#define REFLUX_STORAGE_STORAGE_PARTS_H

#include "storage/storage_state.h"

/* A slot holds a mark, then sets and renewals. A set is a head, records, zeros up to the next grain, and a tail. The
 * confirmation of a tail or renewal comes after it. */
#define MARK_MAGIC    0x4D535852u /* "RXSM" */
#define HEAD_MAGIC    0x48535852u /* "RXSH" */
#define TAIL_MAGIC    0x54535852u /* "RXST" */
#define RENEWAL_MAGIC 0x52535852u /* "RXSR" */
#define FORMAT        1u
#define CONFIRMATION  0u /* format of a head that is a confirmation; earlier firmware skips it */

/* Bytes of a renewal and its confirmation. A save leaves room for RENEWALS after its set, for power cuts in a row. */
#define RENEWAL_SIZE (2u * STORAGE_GRAIN)
#define RENEWALS     4u
/* Bytes that a save needs after its tail. */
#define SAVE_ROOM (STORAGE_GRAIN + RENEWALS * RENEWAL_SIZE)

#define OF_NEWER                                                                                   \
    "newer firmware's settings are stored, in a format unknown here: `save replace` gives them up"

enum storage_state {
    NO_STORAGE, /* the board has no storage */
    WAITING,    /* waits for the first command, or for STORAGE_WAIT_MS without a plant */
    SCANNING,
    CHECKING, /* checks `candidate`, which a scan has found or a save has written */
    PREPARING,
    UNMARKING, /* zeroes the mark of a slot that it will erase */
    ERASING,
    MARKING,
    TAKING, /* puts the stored set into force */
    READY,
    RENEWING, /* closes the newest set again, under the latest sequence */
    CONFIRMING,
    WRITING_HEAD,
    WRITING_BODY,
    WRITING_TAIL
};

static inline uint32_t whole_grains(uint32_t n)
{
    return (n + STORAGE_GRAIN - 1u) / STORAGE_GRAIN * STORAGE_GRAIN;
}

/* Returns the bytes of flash of a set with that many bytes of records. */
static inline uint32_t set_size(uint32_t length)
{
    return STORAGE_GRAIN + whole_grains(length) + STORAGE_GRAIN;
}

static inline uint32_t slot_address(const struct storage *st, uint8_t slot)
{
    return slot * st->slot_size;
}

/* Returns the slot with the newest whole set; 0 without one. */
static inline uint8_t slot_in_use(const struct storage *st)
{
    return st->newest.sequence && st->newest.address >= st->slot_size ? 1 : 0;
}

/* Returns whether sequence a comes after b; 0 comes before all. Sequences wrap: 1 follows 2^32 - 1. Both are counted from
 * the first sequence seen, the nearer way round. */
static inline bool later(const struct storage *st, uint32_t a, uint32_t b)
{
    return a != 0 && (b == 0 || a - st->origin + 0x80000000u > b - st->origin + 0x80000000u);
}

static inline uint32_t next_sequence(uint32_t sequence)
{
    return sequence + 1u ? sequence + 1u : 1u;
}

/* Returns whether the tail that closes the set is its own, and not a renewal. */
static inline bool own_tail(const struct storage_set *set)
{
    return set->tail == set->address + set_size(set->length) - STORAGE_GRAIN;
}

/* Writes a grain of three numbers and their checksum, which continues from `crc`. Returns the checksum. */
uint32_t storage_grain(uint8_t *grain, uint32_t magic, uint32_t a, uint32_t b, uint32_t crc);
/* Writes the renewal that closes a set again. crc: checksum of head and records. Returns the checksum of the renewal. */
uint32_t storage_renewal(const struct storage_set *set, uint8_t *grain, uint32_t crc);

void storage_tell(struct storage *st, enum event_code code, const char *subject, float value);

/* Search both slots for the newest whole set before `limit`. The search ends in RENEWING where the newest set must be closed
 * again, in TAKING where newer firmware blocks storage, else in PREPARING. */
void storage_begin_scan(struct storage *st);
void storage_scan(struct storage *st);
/* Read the whole candidate and compare its checksum. The verdict is for a save; otherwise the next piece of work has begun. */
enum storage_verdict { STORAGE_GOES_ON, STORAGE_NOT_WHOLE, STORAGE_WHOLE };
void storage_begin_check(struct storage *st);
enum storage_verdict storage_check(struct storage *st);

/* Returns whether the newest set must be closed again before anything else is written. It must be if its confirmation is
 * missing, or if something later was never confirmed and might read as whole another time. */
bool storage_unsettled(const struct storage *st);
/* Returns whether the slot of the newest set has room for one more renewal. */
bool storage_can_renew(const struct storage *st);
/* Returns whether newer firmware has stored something, so that storage must not write. */
bool storage_blocked(const struct storage *st);

/* Does one piece of erasing or writing, as the state says. */
void storage_write(struct storage *st);
/* Goes on with a save after its set was read back. whole: the set is whole. */
void storage_verified(struct storage *st, bool whole);

#endif
