#ifndef REFLUX_GMV_GMV_LAMBDA_STATE_H
#define REFLUX_GMV_GMV_LAMBDA_STATE_H

#include "kinds/gmv/gmv_detune_state.h"
#include "kinds/gmv/gmv_lambda.h"
#include "kinds/gmv/gmv_trial_state.h"

struct gmv_lambda_search {
    /* Lambda is a multiple of g_ii,0. */
    bool relative;
    /* The result of the trial under way will be used; another trial is to begin. */
    bool trial_running, trial_wanted;
    /* As set; the multiple of it that is in use; the largest multiple. */
    float lambda[GMV_LOOPS], times, most;
    float margin;
    struct gmv_trial_pi pi[GMV_LOOPS];
    /* The work between ticks owns these two while it is under way. */
    struct gmv_trial trial;
    struct gmv_detune search;
};

/* The multiple in use. */
static inline float gmv_lambda_times(const struct gmv_lambda_search *s)
{
    return s->times;
}

/* The result of a trial under way is dropped. */
static inline void gmv_lambda_drop(struct gmv_lambda_search *s)
{
    s->trial_running = false;
}

/* Runs a few steps of a trial. True: not finished. */
static inline bool gmv_lambda_work(struct gmv_lambda_search *s)
{
    return gmv_detune_piece(&s->search, &s->trial);
}

#endif
