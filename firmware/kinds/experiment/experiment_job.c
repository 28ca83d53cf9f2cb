#include "kinds/experiment/experiment_job.h"

#include "base/assertion.h"
#include "kinds/experiment/experiment_finding.h"
#include "kinds/experiment/experiment_finding_state.h"
#include "kinds/experiment/experiment_record.h"
#include "kinds/experiment/experiment_record_state.h"

/* The estimators and the rows stand behind it. */
struct experiment_job {
    struct experiment_finding finding;
    struct experiment_rows rows;
};

#define HEAD_BYTES ((uint32_t)((sizeof(struct experiment_job) + 7u) & ~(size_t)7u))

uint32_t experiment_job_bytes(unsigned n, uint32_t samples)
{
    return HEAD_BYTES + experiment_rows_bytes(n, samples);
}

void experiment_job_begin(struct experiment_job *job, const struct experiment_context *c)
{
    experiment_finding_reset(&job->finding);
    experiment_rows_begin(&job->rows, c, (char *)job + HEAD_BYTES);
}

struct experiment_rows *experiment_job_rows(struct experiment_job *job)
{
    REFLUX_ASSERT(job);
    return &job->rows;
}

struct experiment_finding *experiment_job_finding(struct experiment_job *job)
{
    REFLUX_ASSERT(job);
    return &job->finding;
}
