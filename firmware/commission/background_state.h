/* The state of background.c. */
#ifndef REFLUX_COMMISSION_BACKGROUND_STATE_H
#define REFLUX_COMMISSION_BACKGROUND_STATE_H

#include "base/job.h"
#include "commission/phase.h"

struct startup_background {
    struct job job;
    volatile uint8_t task; /* enum background_task */
};

/* Tick. */
static inline void background_give_up(struct startup_background *b)
{
    job_give_up(&b->job);
}

/* As job_take(). Tick. */
static inline bool background_take(struct startup_background *b, struct event_queue *events,
                                   uint64_t time_ms)
{
    return job_take(&b->job, events, time_ms);
}

static inline bool background_is_asked(const struct startup_background *b)
{
    return job_is_asked(&b->job);
}

/* A piece of a task runs at this moment, below the tick that asks. */
static inline bool background_is_working(const struct startup_background *b)
{
    return job_is_working(&b->job);
}

static inline enum background_task background_task(const struct startup_background *b)
{
    return (enum background_task)b->task;
}

/* For the list of all jobs. */
static inline struct job *background_job(struct startup_background *b)
{
    return &b->job;
}

#endif
