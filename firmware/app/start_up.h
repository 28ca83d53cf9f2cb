/* Automatic start-up as a part of the firmware; empty where a board leaves it out. */
#ifndef REFLUX_APP_START_UP_H
#define REFLUX_APP_START_UP_H

#include "base/job.h"
#include "base/workspace.h"
#include "commission/commission.h"
#include "service/service.h"

#if COMMISSION_CHANNELS
struct start_up {
    struct commission commission;
};

/* Its job is the first of the jobs, so there is room for it. was_testing: start-up was under way, or its proposal
 * waited, when the board was reset. */
static inline void start_up_init(struct start_up *u, struct service *s, struct jobs *jobs)
{
    commission_init(&u->commission, &s->tick_events, s->workspace);
    s->commission = &u->commission;
    (void)!jobs_add(jobs, commission_job(&u->commission));
}

static inline void start_up_resume(struct start_up *u, bool was_testing)
{
    if (was_testing)
        commission_was_reset(&u->commission);
}

static inline void start_up_tick(struct start_up *u, struct supervisor *s)
{
    commission_tick(&u->commission, s);
}
#else
struct start_up {
};
#define start_up_init(u, s, jobs)       ((void)(u))
#define start_up_resume(u, was_testing) ((void)(was_testing))
#define start_up_tick(u, s)             ((void)(u))
#endif

#endif
