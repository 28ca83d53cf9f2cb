/* The status of start-up: phase, times, the reason why it ended, and the queue of its events. The tick writes it; the main loop reads it
 * under hal_tick_lock. */
#ifndef REFLUX_COMMISSION_STATUS_H
#define REFLUX_COMMISSION_STATUS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/event.h"
#include "commission/phase.h"
#include "commission/reasons.h"
#include "num/real.h"

struct startup_status;

void status_init(struct startup_status *st, struct event_queue *events);
/* Start-up begins anew at time_ms. */
void status_begin(struct startup_status *st, uint64_t time_ms);

/* The trial begins; no reason is left from before. */
void status_enter_trial(struct startup_status *st, uint64_t time_ms);
/* The result is there. */
void status_ready(struct startup_status *st, uint64_t time_ms);
/* The trial was passed. */
void status_kept(struct startup_status *st, uint64_t time_ms);
/* The kept loops are watched from now on; and no longer, for that reason, which is REASON_NOT at the end of the time. The settings stay. */
void status_watch(struct startup_status *st, uint64_t time_ms);
void status_watched(struct startup_status *st, enum commission_reason reason, const char *subject);
/* The operator rejected the proposal. */
void status_rejected(struct startup_status *st);
/* Start-up, the trial or the watch ends before its time; subject may be NULL. Puts the event. */
void status_end(struct startup_status *st, enum commission_reason reason, const char *subject,
                real_t value, uint64_t time_ms);

/* Seconds since start-up began, and since its present phase did. */
real_t status_run_s(const struct startup_status *st, uint64_t time_ms);
real_t status_phase_s(const struct startup_status *st, uint64_t time_ms);
/* Plant time of the whole of it until its end, or until time_ms. */
uint64_t status_duration_ms(const struct startup_status *st, uint64_t time_ms);

#endif
