/* Parameter storage: sets of keyed records in flash. Format and life of a save: docs/storage.md.
 *
 * Two slots, each a half of the area hal/nvm.h describes. A save appends a whole set to a slot that was erased before,
 * and confirms it; the newest whole set counts, and nothing that is needed to find it is ever written again. A cut of
 * the power can leave words behind that read now so, now so: what a start decides on them it writes down, before
 * anything else is done.
 *
 * Rules
 *  1. Main loop only, in small pieces: storage_poll() does at most one flash operation.
 *  2. An erase stalls the processor. It happens only while all loops are in manual: after a start, before the
 *     stored set is put into force, when the slot in use has no room for another set; or in a save.
 *  3. Nothing is touched before the first command has gone out, or until no plant has come for STORAGE_WAIT_MS.
 *  4. What is stored is never given up because of one value: unknown ids are carried over by the next save (but those
 *     of a block that has got another kind), values out of range are clipped and told one by one.
 *  5. Nothing is written while there is something in a format of newer firmware, until storage_save() is told to
 *     replace it.
 */
#ifndef REFLUX_SERVICE_STORAGE_H
#define REFLUX_SERVICE_STORAGE_H

#include "service/service.h"
#include "service/storage_record.h"

#define STORAGE_GRAIN 16u /* everything begins on a multiple; a multiple of any program unit */
#ifndef STORAGE_PIECE
#define STORAGE_PIECE 32u /* bytes programmed at once, a multiple of the grain */
#endif
#ifndef STORAGE_TURN
#define STORAGE_TURN 64u /* grains read in a turn */
#endif
#define STORAGE_WAIT_MS 2000u /* for a plant, after a start */

/* How well a set is closed, worst first: the order of sets that have the same sequence. */
enum storage_closed { CLOSED_BY_TAIL, CLOSED_AGAIN, CLOSED_CONFIRMED };

struct storage_set {
    uint32_t sequence; /* 0: there is none */
    uint32_t address;  /* of its head */
    uint32_t tail;     /* address of what closes it: its tail, or a renewal */
    uint16_t length;   /* bytes of records */
    uint8_t closed;    /* enum storage_closed */
};

struct storage {
    struct service *service;
    uint8_t state;    /* enum in storage_parts.h */
    uint8_t slot;     /* being read, erased or written */
    bool saving;      /* a save has been asked for and is not over */
    bool hurry;       /* an operator asked: the wait after a start is over */
    bool clocked;     /* born_ms is valid */
    bool remains;     /* there is something that is neither erased nor blank */
    bool failed;      /* the last write was not taken */
    bool refused;     /* the newest set did not go into force after the start */
    bool again;       /* the candidate has been found wanting once */
    bool prepared[2]; /* erased and marked: sets may be appended */
    bool sure[2];     /* holds a set that was confirmed */
    uint8_t newer[2]; /* format of newer firmware that stands in the slot; 0 = none */
    uint8_t tries;    /* of the present write that the flash did not take */
    uint32_t used[2]; /* bytes of the slot that cannot be written any more */
    uint32_t erases[2];
    uint64_t born_ms;

    uint32_t slot_size, slot_sectors;
    uint8_t erased;

    struct storage_set newest, candidate;
    struct storage_set limit; /* sets from this one on are not whole */
    uint32_t origin;          /* first sequence seen: which of two is later is told from there */
    uint32_t sequence, sure_sequence; /* latest one seen of all, and of those confirmed */
    uint32_t
        older;   /* of the newest set as it was found, where there is something newer not whole */
    uint32_t at; /* where the present work stands: offset in the slot, or address */
    uint32_t crc, newest_crc; /* that one of head and records of the newest set */

    enum err result; /* of the last save */
    const char *why;

    /* What is being written */
    unsigned parameter;     /* next one */
    uint32_t old, old_left; /* records of the newest set still to be looked at */
    uint32_t copy_left;     /* bytes of the record at `old` still to be copied */
#if CONFIG_BLOCKS
    uint8_t kept_blocks; /* bit n: block n has the kind that the newest set gives it */
#endif
    uint8_t record[RECORD_MAX];
    uint8_t record_n, record_at;
    uint8_t piece[STORAGE_PIECE];
    uint32_t piece_n, body_left;
};

void storage_init(struct storage *st, struct service *service);

/* One piece of work. Returns whether there was any. */
bool storage_poll(struct storage *st);

/* Has the flash been read, so that load and save can do their work? Asking ends the wait after a start. */
bool storage_ready(struct storage *st);

/* Begins to store service_plan(). The caller keeps service_staged() free until storage_saving() is false; then
 * storage_result() tells. `replace`: also where that erases what newer firmware has stored. ERR_UNSUPPORTED, ERR_VERSION
 * (newer firmware has stored something), ERR_STATE (needs an erase while a loop acts; would replace a set that was
 * refused by the defaults that run instead), ERR_FULL: nothing begun. */
MUST_CHECK enum err storage_save(struct storage *st, bool replace, const char **why);
bool storage_saving(const struct storage *st);
MUST_CHECK enum err storage_result(const struct storage *st, const char **why);

/* The stored set over the defaults; what had to be changed is told by events. ERR_UNSUPPORTED, ERR_EMPTY, ERR_VERSION
 * where there is only something of newer firmware, ERR_CRC where there is something but no whole set: *config is
 * unchanged. */
MUST_CHECK enum err storage_load(struct storage *st, struct config *config, const char **why);

/* "none", "unread", "ok", "blocked": newer firmware has stored something, or "failed": the last write was not taken. */
const char *storage_word(const struct storage *st);
/* "ok, set 12 bytes 1304 room 14000 erases 1" */
void storage_text(const struct storage *st, struct text *line);

#endif
