/* The job of law/ under the name that the kind `experiment` includes. */
#ifndef REFLUX_STATE_LAW_STATE_LAW_JOB_H
#define REFLUX_STATE_LAW_STATE_LAW_JOB_H

#include "law/state_law_job.h"
#include "law/state_law_job_state.h"
#include "law/state_law_proposal.h"

#endif
