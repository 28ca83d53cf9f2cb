/* What the files of storage share, and nobody else sees: storage.c (a start, turns), storage_read.c (find, check, load)
 * and storage_write.c (erase, save). Format: docs/storage.md. */
#ifndef REFLUX_SERVICE_STORAGE_PARTS_H
#define REFLUX_SERVICE_STORAGE_PARTS_H

#include "service/storage.h"

/* Slot: mark, then sets. Set: head, records, zeros up to the next grain, tail. */
#define MARK_MAGIC 0x4D535852u /* "RXSM" */
#define HEAD_MAGIC 0x48535852u /* "RXSH" */
#define TAIL_MAGIC 0x54535852u /* "RXST" */
#define FORMAT     1u

enum storage_state {
    NO_STORAGE, /* there is none */
    WAITING,    /* for the first command, or no plant */
    SCANNING,
    CHECKING, /* `candidate`: while scanning, and what has just been saved */
    PREPARING,
    ERASING,
    MARKING,
    TAKING, /* what is stored into force */
    READY,
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

void storage_tell(struct storage *st, enum event_code code, const char *subject, float value);

/* Look through both slots for the newest whole set older than `below`; ends in PREPARING. */
void storage_begin_scan(struct storage *st);
void storage_scan(struct storage *st);
/* Read the candidate whole and compare its checksum. */
void storage_begin_check(struct storage *st);
void storage_check(struct storage *st);

/* Behind the newest whole set, or first in the other slot, there is one that is not whole: by its head, which tells
 * its number, or with a broken head. */
bool storage_newer_broken(const struct storage *st);

/* One piece of erasing or writing, as the state says. */
void storage_write(struct storage *st);
/* What a save has written has been read back. */
void storage_verified(struct storage *st, bool whole);

#endif
