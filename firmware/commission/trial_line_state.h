/* The state of trial_line.c. */
#ifndef REFLUX_COMMISSION_TRIAL_LINE_STATE_H
#define REFLUX_COMMISSION_TRIAL_LINE_STATE_H

#include <stdbool.h>

#include "num/real.h"

struct trial_line {
    real_t rest, rest_sd;               /* at the end of the rest, fraction of span */
    real_t slope_per_s, slope_sd_per_s; /* span per second */
    bool drifts;                        /* significantly and by a relevant amount */
};

/* Returns the level at the end of the rest, fraction of span. */
static inline real_t trial_line_rest(const struct trial_line *l)
{
    return l->rest;
}

/* Returns true where the measurement drifts, so that setpoints follow its line. */
static inline bool trial_line_drifts(const struct trial_line *l)
{
    return l->drifts;
}

#endif
