/* State of storage. storage.h has its functions; the files that storage_parts.h names implement them. */
#ifndef REFLUX_STORAGE_STORAGE_STATE_H
#define REFLUX_STORAGE_STORAGE_STATE_H

#include "service/service.h"
#include "storage/storage_record.h"

#define STORAGE_GRAIN 16u /* bytes; all parts begin on a multiple; a multiple of any program unit */
#ifndef STORAGE_PIECE
#define STORAGE_PIECE 32u /* bytes that one operation programs, a multiple of the grain */
#endif
#ifndef STORAGE_TURN
#define STORAGE_TURN 64u /* grains read in a turn */
#endif
#define STORAGE_WAIT_MS 2000u /* longest wait for a plant after a start */

/* Grades of closing a set, worst first. They order sets that have the same sequence. */
enum storage_closed { CLOSED_BY_TAIL, CLOSED_AGAIN, CLOSED_CONFIRMED };

struct storage_set {
    uint32_t sequence; /* 0: there is no set */
    uint32_t address;  /* address of the head */
    uint32_t tail;     /* address of the tail or renewal that closes the set */
    uint16_t length;   /* bytes of records */
    uint8_t closed;    /* enum storage_closed */
};

struct storage {
    struct service *service;
    uint8_t state;    /* enum in storage_parts.h */
    uint8_t slot;     /* slot that is being read, erased or written */
    bool saving;      /* a save is under way */
    bool hurry;       /* an operator asked, so the wait after a start is over */
    bool clocked;     /* born_ms is valid */
    bool remains;     /* the flash holds a grain that is neither a mark nor blank */
    bool failed;      /* the flash refused the last write */
    bool refused;     /* the newest set did not come into force after the start */
    bool later;       /* ... and a plant with another tick gives it another try */
    bool again;       /* the candidate has failed the check once */
    bool prepared[2]; /* the slot is erased and marked: sets may be appended */
    bool sure[2];     /* the slot holds a confirmed set */
    uint8_t newer[2]; /* format of newer firmware in the slot; 0: none */
    uint8_t tries;    /* writes in a row that the flash refused */
    uint32_t used[2]; /* bytes of the slot that cannot be written any more */
    uint32_t erases[2];
    uint64_t born_ms;

    uint32_t slot_size, slot_sectors;
    uint8_t erased;

    struct storage_set newest, candidate;
    struct storage_set limit; /* the search looks for sets before this one only */
    uint32_t tried_ms;        /* with `later`: tick of the plant that was there; 0: none */
    uint32_t origin;          /* first sequence seen; the order of two is counted from it */
    /* Latest sequence seen of all sets, and of the confirmed ones. */
    uint32_t sequence, sure_sequence;
    /* Sequence of the newest whole set as the start found it, where something newer is not whole; else 0. */
    uint32_t older;
    uint32_t read_address;    /* position of the present work: offset in the slot, or address */
    uint32_t crc, newest_crc; /* newest_crc: checksum of head and records of the newest set */

    enum err result; /* result of the last save */
    const char *reason;

    /* Progress of a save. */
    unsigned parameter;     /* next parameter */
    uint32_t old, old_left; /* address and bytes of the newest set's records still to be read */
    uint32_t copy_left;     /* bytes of the record at `old` still to be copied */
    uint8_t kept_blocks;    /* bit n: block n has the kind that the newest set gives it */
    uint8_t record[RECORD_MAX];
    uint8_t record_n, record_at;
    uint8_t piece[STORAGE_PIECE];
    uint32_t piece_n, body_left;
};

#endif
