/* The state of origin.c. */
#ifndef REFLUX_COMMISSION_ORIGIN_STATE_H
#define REFLUX_COMMISSION_ORIGIN_STATE_H

#include "exchange/config.h"
#include "num/real.h"

struct origin_channel {
    real_t level;       /* at the latest rest, fraction of span */
    real_t slope_most;  /* fastest possible drift by the rest before the first test, magnitude */
    real_t drift_per_s; /* fastest drift that has been seen, magnitude */
    real_t left;        /* from the operating point without drifts, fraction of span, signed */
    real_t moved;       /* from the operating point with drifts, likewise; for the operator */
};

struct origin {
    bool fixed;     /* the first rest has been taken: the operating point */
    bool drifted;   /* an output drifted then */
    real_t since_s; /* time from the latest rest */
    struct origin_channel channel[CHANNEL_MAX];
};

#endif
