#include "supervise/calibration.h"

#include "supervise/plan_parts.h"

/* A transmitter of 4 to 20 mA reports its failure with 3.6 mA or less, or 21 mA or more (NAMUR NE 43): fractions of the span. */
#define FAILURE_LO (-0.025f)
#define FAILURE_HI 1.0625f

bool calibration_believes(const struct plan *plan, uint8_t i, float value)
{
    const struct measurement_config *c = &plan->config.measurement[i];
    float span = c->hi - c->lo;
#if CONFIG_CALIBRATION
    if (c->valid_lo != 0.0f || c->valid_hi != 0.0f)
        return value >= c->valid_lo && value <= c->valid_hi;
#endif
    if (plan_is_estimate(plan, i))
        return near_span(value, c->lo, c->hi);
    return value > c->lo + FAILURE_LO * span && value < c->lo + FAILURE_HI * span;
}

#if CONFIG_CALIBRATION
enum err calibration_check(const struct plan *plan, struct config_fault *fault)
{
    for (uint8_t i = 0; i < CHANNEL_MAX; i++) {
        const struct measurement_config *m = &plan->config.measurement[i];
        if (!m->name[0])
            continue;
        if (plan_is_estimate(plan, i) && (m->gain != 1.0f || m->zero != 0.0f))
            return plan_refuse(fault, ERR_CONFLICT, "meas", i + 1u,
                               m->gain != 1.0f ? "gain" : "zero", m->name,
                               "is written by a block; calibrate what the block reads");
        if (m->valid_lo == 0.0f && m->valid_hi == 0.0f)
            continue;
        if (!(m->valid_lo < m->valid_hi))
            return plan_refuse(fault, ERR_RANGE, "meas", i + 1u, "valid_lo", m->name,
                               "must be below valid_hi (both 0: as NAMUR NE 43)");
        if (!(m->valid_lo < m->hi && m->valid_hi > m->lo))
            return plan_refuse(fault, ERR_RANGE, "meas", i + 1u, "valid_lo", m->name,
                               "leaves no reading within the span");
    }
    return ERR_OK;
}
#endif
