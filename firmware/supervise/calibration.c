#include "supervise/calibration.h"

/* A transmitter of 4 to 20 mA reports its failure with 3.6 mA or less, or 21 mA or more (NAMUR NE 43): fractions of
 * the span. */
#define FAILURE_LO (-0.025f)
#define FAILURE_HI 1.0625f

bool calibration_believes(const struct plan *plan, uint8_t i, float value)
{
    const struct measurement_config *c = &plan->config.measurement[i];
    float span = c->hi - c->lo;
    if (has_limits_of_belief(c))
        return within_limits_of_belief(c, value);
    if (plan_is_estimate(plan, i))
        return near_span(value, c->lo, c->hi);
    return value > c->lo + FAILURE_LO * span && value < c->lo + FAILURE_HI * span;
}
