/* The state of a sequence: supervise/sequence.h. */
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

/* Why a sequence is held, or has ended. Words: sequence_reason_text. */
enum sequence_reason {
    SEQUENCE_OPERATOR,
    SEQUENCE_TIMEOUT,
    SEQUENCE_BY_GUARD,
    SEQUENCE_INTERLOCK, /* an interlock holds an output away from the value the sequence gave it */
    SEQUENCE_LOOP,      /* a loop that the sequence has put to work is in manual */
    SEQUENCE_NOT_FOLLOWING, /* an output that the sequence has moved does not follow */
    SEQUENCE_NO_READING,    /* the measurement that the row waits for is lost */
    SEQUENCE_REFUSED,       /* the action of the row is not possible now */
    SEQUENCE_SAFE,          /* the safe state has been taken for another reason */
    SEQUENCE_CONFIGURATION, /* another configuration has changed its rows */
    SEQUENCE_RESTART,       /* it ran when the board was reset */
    SEQUENCE_REASONS
};

/* Commands of operators, the mode of a REQUEST_SEQUENCE. For confirm and skip, output is the row that was shown to
 * the operator. */
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
    uint8_t step;                  /* row at which it stands, or ended */
    uint8_t reason;                /* enum sequence_reason, where it is held or aborted */
    char about[CHANNEL_NAME_SIZE]; /* name of the cause, or empty */
    bool acted;                    /* the action of the row is done */
    bool confirmed;
    bool window;         /* lo and hi are set */
    uint16_t driven;     /* outputs that its rows have moved, a bit each */
    uint16_t working;    /* loops that its rows have put to work, a bit each */
    uint32_t met_ms;     /* time for which the condition has held; with STEP_TIME, time waited */
    uint32_t elapsed_ms; /* time that counts towards the time-out */
    float lo, hi;        /* STEP_STEADY: range of the readings since the count began */
    uint32_t guards;     /* rows whose guard is in force, a bit each */
    uint32_t violated_ms[CONFIG_STEPS];
    uint64_t last_ms; /* plant time of the last tick */
};
_Static_assert(CONFIG_STEPS <= 32, "a bit for each guard");
_Static_assert(CHANNEL_MAX <= 16 && CONFIG_LOOPS <= 16, "a bit for each output and loop");

/* Returns true if the sequence is under way: running, held or waiting for confirmation. */
static inline bool sequence_active(const struct sequence *q)
{
    return q->state == SEQUENCE_RUNNING || q->state == SEQUENCE_HELD ||
           q->state == SEQUENCE_CONFIRM;
}
/* Return the state (enum sequence_state), and the row at which the sequence stands or ended. */
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
