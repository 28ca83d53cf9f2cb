#include "kinds/composition/composition_settings.h"

/* Standard deviation of a feed flow that no input measures, part of it, where `feed_f` is -1. */
#define FLOW_UNMEASURED REAL_C(0.1)

bool composition_follows_model(const struct composition_settings *s)
{
    return s->method == METHOD_EKF && s->covariance == COVARIANCE_FULL;
}

bool composition_is_complete(const struct composition_settings *s)
{
    return s->method == METHOD_EKF || s->method == METHOD_KALMAN;
}

bool composition_is_sensor(const struct composition_settings *s, unsigned k)
{
    return s->role[k] == IS_TEMPERATURE;
}

real_t composition_feed_f(const struct composition_settings *s, unsigned inputs)
{
    bool is_measured = false;
    for (unsigned k = 0; k < inputs; k++)
        is_measured = is_measured || s->role[k] == IS_FEED;
    return s->feed_f >= 0                                 ? s->feed_f
           : is_measured || !composition_follows_model(s) ? REAL_C(0.0)
                                                          : FLOW_UNMEASURED;
}

size_t composition_extras(const struct composition_settings *s, unsigned inputs, size_t m)
{
    size_t n = 0;
    if (!composition_is_complete(s))
        return 0;
    for (unsigned k = 0; k < inputs; k++)
        n += s->role[k] == IS_ANALYSIS && s->offset > 0 ? 1u : 0u;
    return n + (s->feed_z > 0 ? m : 0u) + (composition_feed_f(s, inputs) > 0 ? 1u : 0u);
}
