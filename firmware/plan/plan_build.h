/* From a configuration to a plan: everything is checked and resolved, or refused with the reason. */
#ifndef REFLUX_PLAN_PLAN_BUILD_H
#define REFLUX_PLAN_PLAN_BUILD_H

#include "exchange/plan.h"

/* Checks *config (which may be the plan's own) whole and fills *plan. tick_s: base tick the plant announces, s, used where the
 * configuration leaves it open; 0 = unknown yet (1 s is assumed until a plant says). On error *fault says
 * why and *plan is undefined. */
MUST_CHECK enum err plan_build(struct plan *plan, const struct config *config, float tick_s,
                               struct config_fault *fault);

/* Resolves the plan again in place for another base tick. On error *plan is unusable. */
MUST_CHECK enum err plan_set_tick(struct plan *plan, float tick_s, struct config_fault *fault);

#endif
