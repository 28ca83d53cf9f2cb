/* The task that start-up gives to the main loop, one at a time: the tick asks for it and takes its result. */
#ifndef REFLUX_COMMISSION_BACKGROUND_H
#define REFLUX_COMMISSION_BACKGROUND_H

#include "base/job.h"
#include "commission/phase.h"

struct startup_background;

/* piece(context) does a piece of the present task and says whether there is more. */
void background_init(struct startup_background *b, const char *name, bool (*piece)(void *context),
                     void *context);
/* The result is taken the given number of ticks later; a task that is under way is given up. Tick. */
void background_ask(struct startup_background *b, enum background_task task, uint32_t ticks);

#endif
