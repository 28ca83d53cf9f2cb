#include "supervise/span.h"

float span_to_eu(num_t fraction, float lo, float hi)
{
    return lo + num_to_float(fraction) * (hi - lo);
}
