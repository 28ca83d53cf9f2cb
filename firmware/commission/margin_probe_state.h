/* The state of margin_probe.c. */
#ifndef REFLUX_COMMISSION_MARGIN_PROBE_STATE_H
#define REFLUX_COMMISSION_MARGIN_PROBE_STATE_H

#include <stdbool.h>

struct trial_probe;

struct margin_probe {
    const struct trial_probe *predicted; /* one for each loop; NULL: no loop is probed */
    bool repeats;                        /* the probe is made again, as a step away */
    bool raised;                         /* the loop under trial is to have its gain raised */
};

/* Predictions for the ways back with a raised gain, one for each loop; they must stay until the trial ends. */
static inline void margin_probe_with(struct margin_probe *p, const struct trial_probe *predicted)
{
    p->predicted = predicted;
}

/* The loop under trial is to have its gain raised. */
static inline bool margin_probe_is_raised(const struct margin_probe *p)
{
    return p->raised;
}

/* The next step away repeats the probe, or no longer does. */
static inline void margin_probe_repeat(struct margin_probe *p, bool repeats)
{
    p->repeats = repeats;
}

static inline bool margin_probe_repeats(const struct margin_probe *p)
{
    return p->repeats;
}

#endif
