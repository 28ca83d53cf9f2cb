/* Work that blocks ask for in the tick, and that the main loop does in pieces (base/job.h). */
#ifndef REFLUX_EXCHANGE_BLOCK_WORK_H
#define REFLUX_EXCHANGE_BLOCK_WORK_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* At the start: make a job for each block, and add all of them to the firmware's jobs. */
void block_work_init(struct supervisor *s);
void block_work_add_jobs(struct supervisor *s, struct jobs *jobs);
/* Returns true if a block has asked for work. */
bool block_work_is_asked(const struct supervisor *s);
/* Returns true if the tick has interrupted a piece of a block's work. Then no plan may come into force. */
bool block_work_is_under_way(const struct supervisor *s);
#else
#define block_work_init(s)           ((void)(s))
#define block_work_add_jobs(s, jobs) ((void)(s), (void)(jobs))
#define block_work_is_asked(s)       ((void)(s), false)
#define block_work_is_under_way(s)   ((void)(s), false)
#endif

#endif
