/* The rows of sequences in a plan. */
#ifndef REFLUX_SUPERVISE_SEQUENCE_PLAN_H
#define REFLUX_SUPERVISE_SEQUENCE_PLAN_H

#include "supervise/plan.h"

#if CONFIG_STEPS
/* Checks the rows of the plan and resolves their names. */
MUST_CHECK enum err sequence_resolve(struct plan *plan, struct config_fault *fault);

/* First row of a sequence after row `after` (-1: from the start), or PLAN_NONE. */
uint8_t sequence_next(const struct config *config, enum sequence_kind kind, int after);

/* Would this plan disturb a sequence that runs under the old one: other rows, or channels elsewhere? */
bool sequence_differs(const struct plan *plan, const struct plan *old);
#endif

#endif
