/* Where a sequence stands: supervise/sequence.h. */
#ifndef REFLUX_EXCHANGE_SEQUENCE_STATE_H
#define REFLUX_EXCHANGE_SEQUENCE_STATE_H

#include "exchange/plan.h"

enum sequence_state {
    SEQUENCE_IDLE,
    SEQUENCE_RUNNING,
    SEQUENCE_HELD,
    SEQUENCE_CONFIRM, /* waits for `seq confirm` */
    SEQUENCE_DONE,
    SEQUENCE_ABORTED
};

/* Why it is held, or has ended. Words: sequence_reason_text. */
enum sequence_reason {
    SEQUENCE_OPERATOR,
    SEQUENCE_TIMEOUT,
    SEQUENCE_BY_GUARD,
    SEQUENCE_INTERLOCK,     /* holds an output elsewhere than the sequence has put it */
    SEQUENCE_LOOP,          /* a loop the sequence has put to work is in manual */
    SEQUENCE_NOT_FOLLOWING, /* an output the sequence has moved does not follow */
    SEQUENCE_NO_READING,    /* the measurement that is waited for is lost */
    SEQUENCE_REFUSED,       /* the action of the row is not possible now */
    SEQUENCE_SAFE,          /* the safe state has been taken for another reason */
    SEQUENCE_CONFIGURATION, /* another configuration has changed its rows */
    SEQUENCE_RESTART,       /* it ran when the board was reset */
    SEQUENCE_REASONS
};

/* What people ask: mode of a REQUEST_SEQUENCE. confirm, skip: output is the row that was shown to them. */
enum sequence_command {
    SEQUENCE_DO_START,
    SEQUENCE_DO_STOP,
    SEQUENCE_DO_HOLD,
    SEQUENCE_DO_GO,
    SEQUENCE_DO_CONFIRM,
    SEQUENCE_DO_SKIP,
    SEQUENCE_DO_ABORT,
    SEQUENCE_COMMANDS
};

#if CONFIG_STEPS
struct sequence {
    uint8_t state;                 /* enum sequence_state */
    uint8_t kind;                  /* enum sequence_kind: the one running, or the last one */
    uint8_t step;                  /* row it stands at, or ended at */
    uint8_t reason;                /* enum sequence_reason, where it is held or aborted */
    char about[CHANNEL_NAME_SIZE]; /* ... and what is to blame, or empty */
    bool acted;                    /* the action of the row is done */
    bool confirmed;
    bool window;         /* lo and hi are set */
    uint16_t driven;     /* outputs its rows have moved, a bit each */
    uint16_t working;    /* loops its rows have put to work */
    uint32_t met_ms;     /* the condition has held for so long; with STEP_TIME, waited */
    uint32_t elapsed_ms; /* towards the time-out */
    float lo, hi;        /* STEP_STEADY: range of the readings since it began to count */
    uint32_t guards;     /* rows whose guard holds, a bit each */
    uint32_t violated_ms[CONFIG_STEPS];
    uint64_t last_ms; /* plant time of the last tick */
};
_Static_assert(CONFIG_STEPS <= 32, "a bit for each guard");
_Static_assert(CHANNEL_MAX <= 16 && CONFIG_LOOPS <= 16, "a bit for each output and loop");

/* Under way: running, held or waiting for confirmation. */
static inline bool sequence_active(const struct sequence *q)
{
    return q->state == SEQUENCE_RUNNING || q->state == SEQUENCE_HELD ||
           q->state == SEQUENCE_CONFIRM;
}
/* enum sequence_state; the row it stands at, or ended at. */
static inline uint8_t sequence_phase(const struct sequence *q)
{
    return q->state;
}
static inline uint8_t sequence_row(const struct sequence *q)
{
    return q->step;
}
#else
struct sequence {
};
#define sequence_active(q) ((void)(q), false)
#define sequence_phase(q)  ((void)(q), (uint8_t)SEQUENCE_IDLE)
#define sequence_row(q)    ((void)(q), (uint8_t)0)
#endif

#endif
