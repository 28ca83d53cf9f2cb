#include "supervise/span.h"

#include "supervise/config.h"

float span_to_eu(num_t fraction, float lo, float hi)
{
    return lo + num_to_float(fraction) * (hi - lo);
}

float mv_to_eu(num_t fraction, const struct mv_config *c)
{
    const float ends[] = {c->safe, c->min, c->max};
    float value = span_to_eu(fraction, c->lo, c->hi);
    for (unsigned k = 0; k < 3; k++) {
        num_t end = span_to_fraction(ends[k], c->lo, c->hi);
        bool past =
            (value > ends[k]) == num_lt(fraction, end); /* on the other side than its fraction */
        if (num_eq(fraction, end) || past)
            value = ends[k];
    }
    return value;
}
