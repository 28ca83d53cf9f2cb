/* Calibration of a measurement (docs/inside/faults.md). */
#ifndef REFLUX_EXCHANGE_CALIBRATION_H
#define REFLUX_EXCHANGE_CALIBRATION_H

#include "exchange/plan.h"

/* Returns true if the value is at most a tenth of its span outside the span. This is for values that come from no
 * transmitter. */
static inline bool near_span(float value, float lo, float hi)
{
    float margin = 0.1f * (hi - lo);
    return value >= lo - margin && value <= hi + margin;
}

#if CONFIG_CALIBRATION
/* Returns a value that the plant sends, calibrated, EU. */
static inline float calibrated(const struct measurement_config *c, float value)
{
    return c->calibration.zero + c->calibration.gain * value;
}
/* Returns true if the limits are set outside of which a reading is not valid. */
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
/* Converts a reading that was calibrated as `before` says to the calibration of *c, EU. */
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
