#include "exchange/block_work.h"

static bool work_piece(void *context)
{
    struct supervisor_work *w = context;
    const struct supervisor *s = w->supervisor;
    const struct block_kind *kind = block_kinds[s->block[w->block].kind];
    return kind->work(supervisor_block(s, w->block));
}

void block_work_init(struct supervisor *s)
{
    for (uint8_t n = 0; n < CONFIG_BLOCKS; n++) {
        s->worker[n] = (struct supervisor_work){s, (uint8_t)(BLOCK_NUMBERED + n)};
        job_init(&s->work[n], "block", work_piece, &s->worker[n]);
    }
}

void block_work_add_jobs(struct supervisor *s, struct jobs *jobs)
{
    for (unsigned n = 0; n < CONFIG_BLOCKS; n++)
        (void)!jobs_add(jobs, &s->work[n]); /* JOBS_MAX has room for all */
}

bool block_work_is_asked(const struct supervisor *s)
{
    for (uint8_t n = 0; n < CONFIG_BLOCKS; n++)
        if (job_is_asked(&s->work[n]))
            return true;
    return false;
}

bool block_work_is_under_way(const struct supervisor *s)
{
    for (uint8_t n = 0; n < CONFIG_BLOCKS; n++)
        if (job_is_working(&s->work[n]))
            return true;
    return false;
}
