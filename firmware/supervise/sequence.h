/* Sequences: start-up and shut-down as a table of rows, step<k>.* of the configuration.
 *
 * Each row does one thing and then waits for one (docs/sequences.md). Rows of one sequence follow each other in the
 * order of the table; those that wait for nothing run in one tick. What a step waits for counts only while the
 * reading is believed.
 *
 *     idle, done, aborted --> running <--> confirm (waits for a person)
 *                               | ^
 *                               v |
 *                              held        by a person, or because something went wrong; goes on by a person only
 *     running, confirm, held --> done | aborted (safe state)
 *
 * A guard holds from its row on until the sequence ends or a row drops it, also while the sequence is held.
 */
#ifndef REFLUX_SUPERVISE_SEQUENCE_H
#define REFLUX_SUPERVISE_SEQUENCE_H

#include "supervise/plan.h"

struct supervisor;
struct request;

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
    SEQUENCE_INTERLOCK,     /* forces an output elsewhere than the sequence has put it */
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
    uint8_t why;                   /* enum sequence_reason, where it is held or aborted */
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

/* Checks the rows of the plan and resolves their names. */
MUST_CHECK enum err sequence_resolve(struct plan *plan, struct config_fault *fault);

/* First row of a sequence after row `after` (-1: from the start), or PLAN_NONE. */
uint8_t sequence_next(const struct config *config, enum sequence_kind kind, int after);

/* Would this plan disturb a sequence that runs under the old one: other rows, or channels elsewhere? */
bool sequence_differs(const struct plan *plan, const struct plan *old);
/* Under way: running, held or waiting for confirmation. */
bool sequence_active(const struct sequence *q);

/* In the tick, between requests and control: guards, the condition of the step, further steps. */
void sequence_run(struct supervisor *s);
/* REQUEST_SEQUENCE. */
void sequence_request(struct supervisor *s, const struct request *r);
/* A new plan is in force. */
void sequence_place(struct supervisor *s, const struct plan *old);
/* The safe state has been taken: a sequence under way ends. */
void sequence_safe(struct supervisor *s, const char *why);
/* It ran when the board was reset, and does not go on. */
void sequence_interrupted(struct supervisor *s, uint8_t kind, uint8_t step);

/* Does the action of row k. False: it could not be done. */
bool sequence_act(struct supervisor *s, uint8_t k);

/* Switches the offset of measurement i; its value moves at once, loops on it make room. */
void measurement_offset(struct supervisor *s, uint8_t i, bool on);

/* What a condition or guard looks at, EU. False: nothing that is believed now. */
bool sequence_reading(const struct supervisor *s, uint8_t measurement, float *value);
#endif

const char *sequence_state_text(uint8_t state);   /* "held" */
const char *sequence_kind_text(uint8_t kind);     /* "start" */
const char *sequence_reason_text(uint8_t reason); /* "time-out" */

/* detail of the sequence's events: reason and kind in one byte. */
static inline uint8_t sequence_detail(uint8_t kind, uint8_t reason)
{
    return (uint8_t)(kind << 4 | reason);
}

#endif
