/* Outcome of a self-tuner's trial, and whether it is good enough. docs/methods/self-tuning.md, Adoption. */
#ifndef REFLUX_GMV_GMV_OUTCOME_H
#define REFLUX_GMV_GMV_OUTCOME_H

#include <stdbool.h>

/* An upset must shrink at least by this factor per step. */
#define GMV_SLOWEST_DECAY 0.9995f

struct gmv_outcome {
    /* Lambda as a multiple of the setting. */
    float times;
    /* gmv_trial_worst, gmv_trial_ratio */
    float decay, ratio;
    /* At rest the law would do worse than the PI's record. */
    bool shakes;
};

/* better: part of the PI's error that must be saved. */
static inline bool gmv_outcome_passes(const struct gmv_outcome *o, float better)
{
    return o->decay <= GMV_SLOWEST_DECAY && o->ratio <= 1 - better && !o->shakes;
}

#endif
