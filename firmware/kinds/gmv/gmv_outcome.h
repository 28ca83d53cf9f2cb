/* What a self-tuner's trial came to, and whether that is good enough. docs/self-tuning.md, Adoption. */
#ifndef REFLUX_GMV_GMV_OUTCOME_H
#define REFLUX_GMV_GMV_OUTCOME_H

#include <stdbool.h>

/* What is upset must die away at least like this per step. */
#define GMV_SLOWEST_DECAY 0.9995f

struct gmv_outcome {
    float times; /* lambda, times what is set */
    float decay; /* gmv_trial_worst */
    float ratio; /* gmv_trial_ratio */
    bool shakes; /* at rest it would do worse than the PI's record */
};

/* better: part of the PI's error that must be saved. */
static inline bool gmv_outcome_passes(const struct gmv_outcome *o, float better)
{
    return o->decay <= GMV_SLOWEST_DECAY && o->ratio <= 1 - better && !o->shakes;
}

#endif
