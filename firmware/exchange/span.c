#include "exchange/span.h"

#include "exchange/config.h"

float span_to_eu(num_t fraction, float lo, float hi)
{
    return lo + num_to_float(fraction) * (hi - lo);
}

float mv_to_eu(num_t fraction, const struct mv_config *c)
{
    float value = span_to_eu(fraction, c->lo, c->hi);
    bool past = value > c->max && !num_lt(span_to_fraction(c->max, c->lo, c->hi), fraction);
    return past ? c->max : value;
}
