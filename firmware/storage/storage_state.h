/* What storage keeps: storage.h says what may be asked of it; the files of storage_parts.h do it. */
#ifndef REFLUX_STORAGE_STORAGE_STATE_H
#define REFLUX_STORAGE_STORAGE_STATE_H

#include "service/service.h"
#include "storage/storage_record.h"

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
    bool later;       /* ... and the tick of another plant may decide: again when one comes */
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
    uint32_t
        tried_ms; /* with `later`: tick of the plant with which it was refused, 0: there was none */
    uint32_t origin; /* first sequence seen: which of two is later is told from there */
    uint32_t sequence, sure_sequence; /* latest one seen of all, and of those confirmed */
    uint32_t
        older; /* of the newest set as it was found, where there is something newer not whole */
    uint32_t read_address;    /* where the present work stands: offset in the slot, or address */
    uint32_t crc, newest_crc; /* that one of head and records of the newest set */

    enum err result; /* of the last save */
    const char *reason;

    /* What is being written */
    unsigned parameter;     /* next one */
    uint32_t old, old_left; /* records of the newest set still to be looked at */
    uint32_t copy_left;     /* bytes of the record at `old` still to be copied */
    uint8_t kept_blocks;    /* bit n: block n has the kind that the newest set gives it */
    uint8_t record[RECORD_MAX];
    uint8_t record_n, record_at;
    uint8_t piece[STORAGE_PIECE];
    uint32_t piece_n, body_left;
};

#endif
