/* The state of trial_step.c. */
#ifndef REFLUX_COMMISSION_TRIAL_STEP_STATE_H
#define REFLUX_COMMISSION_TRIAL_STEP_STATE_H

#include "commission/swing_state.h"
#include "exchange/config.h"

#include <string.h>

struct trial_step {
    real_t error_sum; /* over the last quarter */
    uint32_t error_n;
    struct swing swing;
    uint32_t blocked[CONFIG_LOOPS]; /* samples at a limit of the output, by loop */
};

/* The oscillation does not decay. */
static inline bool trial_step_swings(const struct trial_step *t)
{
    return swing_grows(&t->swing);
}

/* A stage of the trial begins. */
static inline void trial_step_begin(struct trial_step *t)
{
    memset(t, 0, sizeof *t);
}

#endif
