/* Work that blocks ask for in the tick and the main loop does in pieces (base/job.h). */
#ifndef REFLUX_EXCHANGE_BLOCK_WORK_H
#define REFLUX_EXCHANGE_BLOCK_WORK_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* At the start: a job for each block, and all of them among the firmware's jobs. */
void block_work_init(struct supervisor *s);
void block_work_add_jobs(struct supervisor *s, struct jobs *jobs);
/* A block has asked for work. */
bool block_work_is_asked(const struct supervisor *s);
/* A piece of a block's work is under way, under the tick: no plan may come into force. */
bool block_work_is_under_way(const struct supervisor *s);
#else
#define block_work_init(s)           ((void)(s))
#define block_work_add_jobs(s, jobs) ((void)(s), (void)(jobs))
#define block_work_is_asked(s)       ((void)(s), false)
#define block_work_is_under_way(s)   ((void)(s), false)
#endif

#endif
