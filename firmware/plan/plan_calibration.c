/* Checks the calibration of measurements (exchange/calibration.h) in a plan. */
#include "plan/plan_parts.h"

enum err plan_check_calibration(const struct plan *plan, struct config_fault *fault)
{
    for (uint8_t i = 0; i < CHANNEL_MAX; i++) {
        const struct measurement_config *m = &plan->config.measurement[i];
        if (!m->name[0])
            continue;
        if (plan_is_estimate(plan, i) &&
            (m->calibration.gain != 1.0f || m->calibration.zero != 0.0f))
            return plan_refuse(fault, ERR_CONFLICT, "meas", i + 1u,
                               m->calibration.gain != 1.0f ? "gain" : "zero", m->name,
                               "is written by a block; calibrate what the block reads");
        if (m->calibration.valid_lo == 0.0f && m->calibration.valid_hi == 0.0f)
            continue;
        if (!(m->calibration.valid_lo < m->calibration.valid_hi))
            return plan_refuse(fault, ERR_RANGE, "meas", i + 1u, "valid_lo", m->name,
                               "must be below valid_hi (both 0: as NAMUR NE 43)");
        if (!(m->calibration.valid_lo < m->hi && m->calibration.valid_hi > m->lo))
            return plan_refuse(fault, ERR_RANGE, "meas", i + 1u, "valid_lo", m->name,
                               "leaves no reading within the span");
    }
    return ERR_OK;
}
