/* Checks the interval, phase and delay of measurements (exchange/sampling.h) in a plan. */
#include "plan/plan_parts.h"

enum err plan_check_sampling(const struct plan *plan, struct config_fault *fault)
{
    for (uint8_t i = 0; i < CHANNEL_MAX; i++) {
        const struct measurement_config *m = &plan->config.measurement[i];
        if (!m->name[0])
            continue;
        if (m->analyser.phase >= m->analyser.every)
            return plan_refuse(fault, ERR_RANGE, "meas", i + 1u, "phase", m->name,
                               "must be below `every`");
        if (plan_is_estimate(plan, i) && (m->analyser.every > 1 || m->analyser.delay > 0))
            return plan_refuse(fault, ERR_CONFLICT, "meas", i + 1u,
                               m->analyser.every > 1 ? "every" : "delay", m->name,
                               "is written by a block in every tick, without delay");
    }
    return ERR_OK;
}
