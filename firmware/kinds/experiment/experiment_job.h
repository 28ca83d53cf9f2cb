/* The part of an experiment in the workspace: the rows of its record, and the search for a model in them. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_JOB_H
#define REFLUX_EXPERIMENT_EXPERIMENT_JOB_H

#include "kinds/experiment/experiment_context.h"

struct experiment_job;

/* Bytes of the workspace. */
uint32_t experiment_job_bytes(unsigned n, uint32_t samples);
/* Memory of these bytes. */
void experiment_job_begin(struct experiment_job *job, const struct experiment_context *c);
struct experiment_rows *experiment_job_rows(struct experiment_job *job);
struct experiment_finding *experiment_job_finding(struct experiment_job *job);

#endif
