/* The rows of sequences in a plan. */
#ifndef REFLUX_PLAN_SEQUENCE_PLAN_H
#define REFLUX_PLAN_SEQUENCE_PLAN_H

#include "exchange/plan.h"

#if CONFIG_STEPS
/* Checks the rows of the plan and resolves their names. */
MUST_CHECK enum err sequence_resolve(struct plan *plan, struct config_fault *fault);

#else
#define sequence_resolve(plan, fault) ERR_OK
#endif

#endif
