/* Jobs: work that takes longer than a tick. The tick asks for a job, and the main loop does it in pieces of a bounded number of
 * instructions (about a millisecond). The tick takes the result after the number of ticks that it declared with the request, even
 * if the main loop was done earlier. A run is therefore the same on every processor.
 *
 *     tick       job_ask(&job, 20)    ...    job_take(&job, ...) once a tick: true in the twentieth
 *     main loop  jobs_work(&jobs)     a piece of the job that is due first
 *     app        jobs_wait(&jobs)     true: the next tick would find a job due and not done, so its sample waits
 *
 * A plant that stops its time until it gets an answer (lockstep) notices nothing. A plant that goes on does not wait: its
 * samples make their ticks, the job is late, which is an event, and the first tick that finds the result takes it.
 *
 * The tick may give a job up in the middle of a piece. Until job_is_working() is false, it writes nothing else into the memory
 * of the job and asks for no other job there. */
#ifndef REFLUX_BASE_JOB_H
#define REFLUX_BASE_JOB_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "base/event.h"

#ifndef JOBS_MAX
#define JOBS_MAX 8 /* jobs of all families in a board's build; 0 leaves jobs out */
#endif

struct job {
    const char *name; /* subject of the event JOB_LATE */
    /* Does one piece, in the main loop. Returns true while there is more to do. */
    bool (*piece)(void *context);
    void *context;
    /* Set from the request until the tick takes the result or gives up. The tick writes it. */
    volatile bool asked;
    volatile bool done;    /* the result is ready; the main loop writes it */
    volatile bool working; /* a piece is under way; the main loop writes it */
    /* Counts requests, so that a piece of a job that was given up cannot end the next one. */
    volatile uint32_t number;
    uint32_t ticks, due; /* ticks since the request; tick in which the result is taken */
    volatile bool late;  /* the declared tick has passed without a result */
};

void job_init(struct job *j, const char *name, bool (*piece)(void *context), void *context);

/* Asks for the job: the main loop works on it from here on. The tick takes the result in the `ticks`-th tick after this one, from 1
 * up. Call in the tick. */
void job_ask(struct job *j, uint32_t ticks);
/* Gives the job up. Call in the tick. */
void job_give_up(struct job *j);
/* Returns whether the job was asked for and neither taken nor given up. */
static inline bool job_is_asked(const struct job *j)
{
    return j->asked;
}
/* Returns whether the tick that calls has interrupted a piece. */
static inline bool job_is_working(const struct job *j)
{
    return j->working;
}
/* Takes the result. Call once a tick while the job is asked for. Returns true, and ends the job, when the declared tick has come and
 * the result is ready. Reports JOB_LATE once. */
bool job_take(struct job *j, struct event_queue *events, uint64_t time_ms);

#if JOBS_MAX
/* The jobs of the whole firmware. */
struct jobs {
    struct job *job[JOBS_MAX];
    uint8_t n;
};

/* Adds a job at the start of the firmware; *j must live as long as *jobs. ERR_FULL: there are JOBS_MAX. */
MUST_CHECK enum err jobs_add(struct jobs *jobs, struct job *j);
/* Returns whether the next sample must wait. */
bool jobs_wait(const struct jobs *jobs);
/* Does a piece of the job that is due first. Returns false where there is none. Main loop. */
bool jobs_work(struct jobs *jobs);
#else
struct jobs {
};
#define jobs_add(jobs, j) ((void)(jobs), (void)(j), ERR_OK)
#define jobs_wait(jobs)   ((void)(jobs), false)
#define jobs_work(jobs)   ((void)(jobs), false)
#endif

#endif
