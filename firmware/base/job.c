#include "base/job.h"

#include <stdatomic.h>
#include <stddef.h>

void job_init(struct job *j, const char *name, bool (*piece)(void *context), void *context)
{
    *j = (struct job){.name = name, .piece = piece, .context = context};
}

void job_ask(struct job *j, uint32_t ticks)
{
    j->done = false;
    j->late = false;
    j->ticks = 0;
    j->due = ticks;
    j->number = j->number + 1u;
    j->asked = true; /* last: from here on the main loop may work */
}

void job_give_up(struct job *j)
{
    j->asked = false;
}

bool job_take(struct job *j, struct event_queue *events, uint64_t time_ms)
{
    if (!j->asked)
        return false;
    if (j->ticks < j->due)
        j->ticks++;
    if (j->ticks < j->due)
        return false;
    if (j->done) {
        j->asked = false;
        return true;
    }
    if (!j->late)
        event_put(events, time_ms, EVENT_JOB_LATE, j->name, (float)j->due, 0);
    j->late = true;
    return false;
}

enum err jobs_add(struct jobs *jobs, struct job *j)
{
    if (jobs->n == JOBS_MAX)
        return ERR_FULL;
    jobs->job[jobs->n++] = j;
    return ERR_OK;
}

static bool is_open(const struct job *j)
{
    return j->asked && !j->done;
}

bool jobs_wait(const struct jobs *jobs)
{
    for (uint8_t k = 0; k < jobs->n; k++) {
        const struct job *j = jobs->job[k];
        if (is_open(j) && !j->late && j->ticks + 1u >= j->due)
            return true;
    }
    return false;
}

/* Does one piece. The tick may give the job up, or ask for it again, at any time. */
static bool do_piece(struct job *j)
{
    j->working = true;
    uint32_t number = j->number;
    atomic_signal_fence(memory_order_seq_cst);
    bool open = is_open(j); /* the tick may end the job from here on */
    bool ended = open && !j->piece(j->context);
    atomic_signal_fence(memory_order_seq_cst);
    if (ended && j->number == number)
        j->done = true;
    j->working = false;
    return open;
}

bool jobs_work(struct jobs *jobs)
{
    struct job *first = NULL;
    uint32_t least = 0;
    for (uint8_t k = 0; k < jobs->n; k++) {
        struct job *j = jobs->job[k];
        uint32_t left = j->due - j->ticks;
        if (is_open(j) && (!first || left < least)) {
            first = j;
            least = left;
        }
    }
    return first && do_piece(first);
}
