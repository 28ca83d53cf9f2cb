/* Sequences: start-up and shut-down as a table of rows, step<k>.* of the configuration.
 *
 * Each row does one action and then waits for one condition (docs/use/sequences.md). Rows of one sequence follow each
 * other in the order of the table; rows without a wait run in one tick. The condition of a row counts only while
 * the reading is valid.
 *
 *     idle, done, aborted --> running <--> confirm (waits for the operator)
 *                               | ^
 *                               v |
 *                              held        by the operator, or because of a fault; only the operator continues it
 *     running, confirm, held --> done | aborted (safe state)
 *
 * A guard holds from its row on until the sequence ends or a row drops it, also while the sequence is held. */
#ifndef REFLUX_SUPERVISE_SEQUENCE_H
#define REFLUX_SUPERVISE_SEQUENCE_H

#include "exchange/sequence_rows.h"
#include "exchange/state.h"

#if CONFIG_STEPS
/* In the tick, between requests and control: runs guards, the condition of the step, and further steps. */
void sequence_run(struct supervisor *s);
/* Carries out a REQUEST_SEQUENCE. */
void sequence_request(struct supervisor *s, const struct request *r);
/* Aborts the sequence if a new plan that is now in force disturbs it. */
void sequence_place(struct supervisor *s, const struct plan *old);
/* Ends a sequence under way, because the safe state has been taken. */
void sequence_safe(struct supervisor *s, const char *reason);
/* Reports a sequence that ran when the board was reset, and does not go on. */
void sequence_interrupted(struct supervisor *s, uint8_t kind, uint8_t step);

#else
#define sequence_run(s)          ((void)(s))
#define sequence_request(s, r)   ((void)(s), (void)(r))
#define sequence_place(s, old)   ((void)(old))
#define sequence_safe(s, reason) ((void)(reason))
#endif

/* Returns the detail of the sequence's events: reason and kind in one byte. */
static inline uint8_t sequence_detail(uint8_t kind, uint8_t reason)
{
    return (uint8_t)(kind << 4 | reason);
}

#endif
