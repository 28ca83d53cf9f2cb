/* The state of limits.c. */
#ifndef REFLUX_COMMISSION_LIMITS_STATE_H
#define REFLUX_COMMISSION_LIMITS_STATE_H

#include "exchange/config.h"
#include "identify/guard.h"

struct limits {
    uint8_t over[CHANNEL_MAX]; /* samples in a row past the limit */
    uint8_t worst_output;
    real_t worst; /* largest share of its limit that worst_output has used, drift apart */
    /* Extremes of the positive half below and above rest for an amplitude of 1, fraction of span. */
    real_t low[CHANNEL_MAX], high[CHANNEL_MAX];
    /* Amplitude before it grew, and deviation of each output then, fractions of span. */
    real_t step_from, from[CHANNEL_MAX];
    struct guard guard;
};

/* The largest share of its limit that an output has used, and that output. */
static inline real_t limits_worst(const struct limits *l)
{
    return l->worst;
}

static inline uint8_t limits_worst_output(const struct limits *l)
{
    return l->worst_output;
}

#endif
