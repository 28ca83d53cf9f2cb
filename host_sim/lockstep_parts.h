/* What the files of a run in lockstep share. */
#ifndef REFLUX_HOST_SIM_LOCKSTEP_PARTS_H
#define REFLUX_HOST_SIM_LOCKSTEP_PARTS_H

#include "lockstep.h"

enum outcome {
    GOT_IT,
    TOO_LATE,
    REGREETED, /* the link was greeted anew meanwhile; which means the controller may have restarted */
    STOPPED    /* interrupted, or failed with k->error */
};

typedef bool (*condition)(const struct lockstep *k);

/* lockstep.c: fails the run with this reason. */
enum outcome lockstep_stop(struct lockstep *k, const char *reason);
/* Lets link and console work until done() holds, for at most span_ms. */
enum outcome lockstep_wait(struct lockstep *k, condition done, uint64_t span_ms);
/* Fails the run because this did not come in time. */
enum outcome lockstep_late(struct lockstep *k, const char *what);
/* After REGREETED: everything back to where samples can flow. */
enum outcome lockstep_recover(struct lockstep *k, bool *restarted);
/* At the board's own pins, while plant time has not begun: until the board has taken a sample. */
enum outcome lockstep_next_sample(struct lockstep *k);

/* lockstep_lines.c */
/* Puts the console into machine mode, and telemetry back on if log_line says so. Never interrupted by a greeting:
 * the caller looks at that afterwards. */
enum outcome lockstep_start_console(struct lockstep *k);
/* Sends one scripted line and waits for what it leads to. */
enum outcome lockstep_one_line(struct lockstep *k, const struct script_line *x);
/* All lines that are due at this plant time. */
enum outcome lockstep_lines(struct lockstep *k, double time_s);

#endif
