/* The state of analysis_job.c. */
#ifndef REFLUX_COMMISSION_ANALYSIS_JOB_STATE_H
#define REFLUX_COMMISSION_ANALYSIS_JOB_STATE_H

#include "base/assertion.h"
#include "commission/analysis_state.h"

/* The main loop's while the task is under way, else the tick's. */
struct analysis_job {
    struct analysis_config config;
    uint8_t column[CHANNEL_MAX]; /* tested input of each input of the analysis */
    enum err error;
    bool begun;
};

/* ERR_EMPTY: no input was left. */
static inline enum err analysis_job_error(const struct analysis_job *job)
{
    return job->error;
}

/* The tested input that is input i of the analysis. */
static inline uint8_t analysis_job_input(const struct analysis_job *job, unsigned i)
{
    REFLUX_ASSERT(i < CHANNEL_MAX);
    return job->column[i];
}

#endif
