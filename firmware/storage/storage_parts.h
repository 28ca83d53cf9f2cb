/* What the files of storage share, and nobody else sees: storage_turns.c (a start, turns), storage_read.c (find, check, load)
 * and storage_write.c (erase, save). Format: docs/storage.md. */
#ifndef REFLUX_STORAGE_STORAGE_PARTS_H
#define REFLUX_STORAGE_STORAGE_PARTS_H

#include "storage/storage_state.h"

/* Slot: mark, then sets and renewals. Set: head, records, zeros up to the next grain, tail. Behind a tail or a renewal
 * stands its confirmation. */
#define MARK_MAGIC    0x4D535852u /* "RXSM" */
#define HEAD_MAGIC    0x48535852u /* "RXSH" */
#define TAIL_MAGIC    0x54535852u /* "RXST" */
#define RENEWAL_MAGIC 0x52535852u /* "RXSR" */
#define FORMAT        1u
#define CONFIRMATION  0u /* format of a head that is none: earlier firmware passes over it */

/* A renewal and its confirmation; room for so many is left behind a set, for cuts one after the other. */
#define RENEWAL_SIZE (2u * STORAGE_GRAIN)
#define RENEWALS     4u
/* What a save needs behind its tail. */
#define SAVE_ROOM (STORAGE_GRAIN + RENEWALS * RENEWAL_SIZE)

#define OF_NEWER                                                                                   \
    "newer firmware's settings are stored, in a format unknown here: `save replace` gives them up"

enum storage_state {
    NO_STORAGE, /* there is none */
    WAITING,    /* for the first command, or no plant */
    SCANNING,
    CHECKING, /* `candidate`: while scanning, and what has just been saved */
    PREPARING,
    UNMARKING, /* a slot that will be erased */
    ERASING,
    MARKING,
    TAKING, /* what is stored into force */
    READY,
    RENEWING, /* the newest set is closed again, under the latest sequence */
    CONFIRMING,
    WRITING_HEAD,
    WRITING_BODY,
    WRITING_TAIL
};

static inline uint32_t whole_grains(uint32_t n)
{
    return (n + STORAGE_GRAIN - 1u) / STORAGE_GRAIN * STORAGE_GRAIN;
}

/* A set with that many bytes of records takes so many of flash. */
static inline uint32_t set_size(uint32_t length)
{
    return STORAGE_GRAIN + whole_grains(length) + STORAGE_GRAIN;
}

static inline uint32_t slot_address(const struct storage *st, uint8_t slot)
{
    return slot * st->slot_size;
}

/* The one with the newest whole set. */
static inline uint8_t slot_in_use(const struct storage *st)
{
    return st->newest.sequence && st->newest.address >= st->slot_size ? 1 : 0;
}

/* One sequence comes after the other; 0 before all. They go round, 1 follows 2^32 - 1: the nearer way round from the
 * first one seen counts. */
static inline bool later(const struct storage *st, uint32_t a, uint32_t b)
{
    return a != 0 && (b == 0 || a - st->origin + 0x80000000u > b - st->origin + 0x80000000u);
}

static inline uint32_t next_sequence(uint32_t sequence)
{
    return sequence + 1u ? sequence + 1u : 1u;
}

/* Its tail is the one it was written with. */
static inline bool own_tail(const struct storage_set *set)
{
    return set->tail == set->address + set_size(set->length) - STORAGE_GRAIN;
}

/* Three numbers and the checksum of them, which goes on from `crc`; returns it. */
uint32_t storage_grain(uint8_t *grain, uint32_t magic, uint32_t a, uint32_t b, uint32_t crc);
/* The grain that closes a set again, after that checksum of head and records; returns its own. */
uint32_t storage_renewal(const struct storage_set *set, uint8_t *grain, uint32_t crc);

void storage_tell(struct storage *st, enum event_code code, const char *subject, float value);

/* Look through both slots for the newest whole set before `limit`; ends in RENEWING where the newest set must be closed
 * again, else in PREPARING. */
void storage_begin_scan(struct storage *st);
void storage_scan(struct storage *st);
/* Read the candidate whole and compare its checksum. The verdict is for who has saved it; else what comes next has begun. */
enum storage_verdict { STORAGE_GOES_ON, STORAGE_NOT_WHOLE, STORAGE_WHOLE };
void storage_begin_check(struct storage *st);
enum storage_verdict storage_check(struct storage *st);

/* Must the newest set be closed again before anything else is written? Its own confirmation is missing, or there is
 * something later that was never confirmed and might read whole another time. */
bool storage_unsettled(const struct storage *st);
/* The slot of the newest set takes one more renewal. */
bool storage_can_renew(const struct storage *st);
bool storage_blocked(const struct storage *st);

/* One piece of erasing or writing, as the state says. */
void storage_write(struct storage *st);
/* What a save has written has been read back. */
void storage_verified(struct storage *st, bool whole);

#endif
