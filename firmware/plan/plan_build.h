/* From a configuration to a plan: checks and resolves everything, or refuses it with the reason. */
#ifndef REFLUX_PLAN_PLAN_BUILD_H
#define REFLUX_PLAN_PLAN_BUILD_H

#include "exchange/plan.h"

/* Checks *config (which may be the plan's own) as a whole, and fills *plan. tick_s is the base tick that the plant
 * announces, s, used where the configuration leaves it open; 0 = unknown yet (1 s is assumed until a plant says).
 * On an error *fault says why, and *plan is undefined. */
MUST_CHECK enum err plan_build(struct plan *plan, const struct config *config, float tick_s,
                               struct config_fault *fault);

/* Resolves the plan again in place for another base tick. On an error *plan is unusable. */
MUST_CHECK enum err plan_set_tick(struct plan *plan, float tick_s, struct config_fault *fault);

#endif
