/* The state of status.c. */
#ifndef REFLUX_COMMISSION_STATUS_STATE_H
#define REFLUX_COMMISSION_STATUS_STATE_H

#include "base/event.h"
#include "commission/phase.h"
#include "commission/reasons.h"
#include "exchange/config.h"
#include "num/real.h"

struct startup_status {
    enum commission_phase phase;
    enum commission_reason reason;
    volatile bool analysed; /* the workspace holds a result */
    bool unseen;            /* nobody has looked at the result */
    struct event_queue *events;
    /* Plant time: when the tests began, when they or the trial ended, when the present phase began. */
    uint64_t began_ms, ended_ms, phase_ms;
    char subject[CHANNEL_NAME_SIZE]; /* channel or loop that `reason` is about */
    real_t value;                    /* number that goes with `reason`, fraction of span */
};

static inline enum commission_phase status_phase(const struct startup_status *st)
{
    return st->phase;
}

/* Tests, fits and the analysis, paused or not: test signals may be on the outputs. */
static inline bool status_is_testing(const struct startup_status *st)
{
    return st->phase >= COMMISSION_TESTING && st->phase <= COMMISSION_PAUSED;
}

/* Enters a phase whose duration counts. */
static inline void status_enter(struct startup_status *st, enum commission_phase phase,
                                uint64_t time_ms)
{
    st->phase = phase;
    st->phase_ms = time_ms;
}

/* The old settings go back into force. */
static inline void status_returned(struct startup_status *st)
{
    st->phase = COMMISSION_RETURNED;
}

static inline enum commission_reason status_reason(const struct startup_status *st)
{
    return st->reason;
}

static inline const char *status_subject(const struct startup_status *st)
{
    return st->subject;
}

/* There was a result. */
static inline bool status_has_results(const struct startup_status *st)
{
    return st->analysed;
}

/* Nobody has looked at it. */
static inline bool status_is_unseen(const struct startup_status *st)
{
    return st->unseen;
}

static inline void status_set_unseen(struct startup_status *st, bool unseen)
{
    st->unseen = unseen;
}

static inline struct event_queue *status_events(const struct startup_status *st)
{
    return st->events;
}

#endif
