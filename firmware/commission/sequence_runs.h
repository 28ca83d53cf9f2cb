/* A sequence that runs keeps start-up from beginning; boards without sequences have none. */
#ifndef REFLUX_COMMISSION_SEQUENCE_RUNS_H
#define REFLUX_COMMISSION_SEQUENCE_RUNS_H

#include "supervise/supervisor.h"

#if CONFIG_STEPS
static inline bool sequence_runs(const struct supervisor *s)
{
    return sequence_active(&s->sequence);
}
#else
static inline bool sequence_runs(const struct supervisor *s)
{
    (void)s;
    return false;
}
#endif

#endif
