/* Conversions between engineering units (EU) and fractions of a span lo..hi. */
#ifndef REFLUX_EXCHANGE_SPAN_H
#define REFLUX_EXCHANGE_SPAN_H

#include "num/num.h"

static inline num_t span_to_fraction(float value, float lo, float hi)
{
    return num_from_float((value - lo) / (hi - lo));
}
float span_to_eu(num_t fraction, float lo, float hi);

/* Returns the value that is sent to an MV with these settings, EU. Rounding does not take it past mv.max. */
struct mv_config;
float mv_to_eu(num_t fraction, const struct mv_config *c);

#endif
