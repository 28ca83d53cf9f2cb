#include "signal/check.h"

#include "base/channel.h" /* float_is_finite */

enum err check_range(float x, float lo, float hi)
{
    if (!float_is_finite(x))
        return ERR_NOT_FINITE;
    return x < lo || x > hi ? ERR_RANGE : ERR_OK;
}

enum err check_interval(float h_s)
{
    return check_range(h_s, STEP_INTERVAL_MIN_S, STEP_INTERVAL_MAX_S);
}
