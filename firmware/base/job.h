/* Work that outlasts a tick. The main loop does it in pieces of a bounded number of instructions (a millisecond or so), the
 * tick asks for it and takes its result: after as many ticks as were declared with the asking, however much sooner it is
 * there. So a run is the same run on every processor.
 *
 *     tick       job_ask(&job, 20)    ...    job_take(&job, ...) once a tick: true in the twentieth
 *     main loop  jobs_work(&jobs)     a piece of the job that is due first
 *     app        jobs_wait(&jobs)     the next tick would meet a job that is due and not done: its sample waits
 *
 * A plant that stops its time until it is answered (lockstep) notices nothing. One that goes on is not kept waiting: its
 * samples make their ticks, the job is late, which is an event, and its result is taken by the first tick that finds it.
 *
 * The tick may give a job up in the midst of a piece; it puts nothing else into the memory that the job works on, and asks for
 * no other, before job_is_working() is false. */
#ifndef REFLUX_BASE_JOB_H
#define REFLUX_BASE_JOB_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "base/event.h"

#ifndef JOBS_MAX
#define JOBS_MAX 8 /* that all families of a board's build may have; 0 leaves jobs out */
#endif

struct job {
    const char *name; /* of whose it is, for the event */
    /* One piece. True while there is more to do. Main loop. */
    bool (*piece)(void *context);
    void *context;
    volatile bool asked;      /* the tick's: from asking to taking or giving up */
    volatile bool done;       /* the main loop's: its result is there */
    volatile bool working;    /* the main loop's: in the midst of a piece */
    volatile uint32_t number; /* counts askings: one that was given up cannot end the next */
    uint32_t ticks, due;      /* since the asking; at which the result is taken */
    volatile bool late;       /* the declared tick has come and gone without it */
};

void job_init(struct job *j, const char *name, bool (*piece)(void *context), void *context);

/* From now on the main loop works on it; the result is taken in the `ticks`-th tick after this one, from 1 up. Tick. */
void job_ask(struct job *j, uint32_t ticks);
/* It is not wanted any more. Tick. */
void job_give_up(struct job *j);
/* Asked for, and neither taken nor given up. */
static inline bool job_is_asked(const struct job *j)
{
    return j->asked;
}
/* A piece is under way, under the tick that asks. */
static inline bool job_is_working(const struct job *j)
{
    return j->working;
}
/* Once a tick while it is asked for. True: the declared tick has come, and the result is there; the job is over. Tells when it
 * is late. Tick. */
bool job_take(struct job *j, struct event_queue *events, uint64_t time_ms);

#if JOBS_MAX
/* Those of the whole firmware. */
struct jobs {
    struct job *job[JOBS_MAX];
    uint8_t n;
};

/* j must live as long. At the start. ERR_FULL. */
MUST_CHECK enum err jobs_add(struct jobs *jobs, struct job *j);
/* Must the next sample wait? */
bool jobs_wait(const struct jobs *jobs);
/* A piece of the job that is due first. False: there is none. Main loop. */
bool jobs_work(struct jobs *jobs);
#else
struct jobs {
};
#define jobs_add(jobs, j) ((void)(jobs), (void)(j), ERR_OK)
#define jobs_wait(jobs)   ((void)(jobs), false)
#define jobs_work(jobs)   ((void)(jobs), false)
#endif

#endif
