#include "commission/background.h"

#include "commission/background_state.h"

void background_init(struct startup_background *b, const char *name, bool (*piece)(void *context),
                     void *context)
{
    job_init(&b->job, name, piece, context);
    b->task = TASK_INTERIM_FIT;
}

void background_ask(struct startup_background *b, enum background_task task, uint32_t ticks)
{
    job_give_up(&b->job); /* an interim fit that the end of its test has overtaken */
    b->task = (uint8_t)task;
    job_ask(&b->job, ticks);
}
