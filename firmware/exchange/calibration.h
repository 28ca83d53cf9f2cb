/* Calibration of a measurement (docs/faults.md). */
#ifndef REFLUX_EXCHANGE_CALIBRATION_H
#define REFLUX_EXCHANGE_CALIBRATION_H

#include "exchange/plan.h"

/* For what comes from no transmitter: at most a tenth of its span outside it. */
static inline bool near_span(float value, float lo, float hi)
{
    float margin = 0.1f * (hi - lo);
    return value >= lo - margin && value <= hi + margin;
}

#if CONFIG_CALIBRATION
/* What the plant sends, calibrated, EU. */
static inline float calibrated(const struct measurement_config *c, float value)
{
    return c->calibration.zero + c->calibration.gain * value;
}
/* Limits outside of which a reading is not valid, where they are set. */
static inline bool has_limits_of_belief(const struct measurement_config *c)
{
    return c->calibration.valid_lo != 0.0f || c->calibration.valid_hi != 0.0f;
}
static inline bool within_limits_of_belief(const struct measurement_config *c, float value)
{
    return value >= c->calibration.valid_lo && value <= c->calibration.valid_hi;
}
static inline bool same_calibration(const struct measurement_config *a,
                                    const struct measurement_config *b)
{
    return a->calibration.gain == b->calibration.gain && a->calibration.zero == b->calibration.zero;
}
/* What a reading calibrated as `before` says is with another calibration, EU. */
static inline float recalibrated(const struct measurement_config *c,
                                 const struct measurement_config *before, float value)
{
    return same_calibration(c, before)
               ? value
               : calibrated(c, (value - before->calibration.zero) / before->calibration.gain);
}
#else
#define calibrated(c, value)              ((void)(c), (value))
#define has_limits_of_belief(c)           ((void)(c), false)
#define within_limits_of_belief(c, value) ((void)(c), (void)(value), true)
#define same_calibration(a, b)            ((void)(a), (void)(b), true)
#define recalibrated(c, before, value)    ((void)(c), (void)(before), (value))
#endif

#endif
