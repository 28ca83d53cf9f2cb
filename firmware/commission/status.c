#include "commission/status.h"

#include "base/elapsed.h"
#include "commission/status_state.h"

#include <string.h>

void status_init(struct startup_status *st, struct event_queue *events)
{
    memset(st, 0, sizeof *st);
    st->events = events;
}

void status_begin(struct startup_status *st, uint64_t time_ms)
{
    status_init(st, st->events);
    st->began_ms = time_ms;
}

void status_enter_trial(struct startup_status *st, uint64_t time_ms)
{
    status_enter(st, COMMISSION_TRIAL, time_ms);
    st->reason = REASON_NOT;
}

void status_ready(struct startup_status *st, uint64_t time_ms)
{
    status_enter(st, COMMISSION_READY, time_ms);
    st->ended_ms = time_ms;
    st->analysed = st->unseen = true;
}

void status_kept(struct startup_status *st, uint64_t time_ms)
{
    st->phase = COMMISSION_KEPT;
    st->ended_ms = time_ms;
}

static void set_subject(struct startup_status *st, const char *subject)
{
    memset(st->subject, 0, sizeof st->subject);
    for (unsigned i = 0; subject && subject[i] && i + 1 < sizeof st->subject; i++)
        st->subject[i] = subject[i];
}

void status_watch(struct startup_status *st, uint64_t time_ms)
{
    status_enter(st, COMMISSION_WATCHING, time_ms);
    st->reason = REASON_NOT;
}

void status_watched(struct startup_status *st, enum commission_reason reason, const char *subject)
{
    st->phase = COMMISSION_KEPT;
    st->reason = reason;
    st->unseen = true;
    set_subject(st, subject);
}

void status_rejected(struct startup_status *st)
{
    st->phase = COMMISSION_IDLE;
    st->unseen = false;
}

void status_end(struct startup_status *st, enum commission_reason reason, const char *subject,
                real_t value, uint64_t time_ms)
{
    enum event_code code = st->phase == COMMISSION_TRIAL      ? EVENT_TRIAL_FAILED
                           : st->phase == COMMISSION_WATCHING ? EVENT_WATCH_FAILED
                                                              : EVENT_COMMISSION_ENDED;
    st->phase = COMMISSION_ENDED;
    st->reason = reason;
    st->value = value;
    set_subject(st, subject);
    st->ended_ms = time_ms;
    event_put(st->events, time_ms, code, subject, value, (uint8_t)reason);
}

static real_t seconds_since(uint64_t then_ms, uint64_t time_ms)
{
    return elapsed_ms(time_ms, then_ms) / REAL_C(1000.0);
}

real_t status_run_s(const struct startup_status *st, uint64_t time_ms)
{
    return seconds_since(st->began_ms, time_ms);
}

real_t status_phase_s(const struct startup_status *st, uint64_t time_ms)
{
    return seconds_since(st->phase_ms, time_ms);
}

uint64_t status_duration_ms(const struct startup_status *st, uint64_t time_ms)
{
    uint64_t end_ms = st->ended_ms ? st->ended_ms : time_ms;
    return end_ms > st->began_ms ? end_ms - st->began_ms : 0; /* time may be set back */
}
