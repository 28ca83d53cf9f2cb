/* The state behind tune_shadows.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_FF_TUNE_TUNE_SHADOWS_STATE_H
#define REFLUX_FF_TUNE_TUNE_SHADOWS_STATE_H

#include "kinds/ff_tune/loop_shadow.h"
#include "kinds/ff_tune/tune_results.h"

struct tune_shadows {
    struct tune_model model;
    struct tune_errors errors;
    /* Integral of the loop's controller, from the filtered signals. */
    real_t integral;
    /* The candidate's lead-lag. */
    real_t lead_lag, last_d;
    /* Samples since they began. */
    uint16_t warm, candidate_warm;
    struct loop_shadow no_feedforward, with_candidate;
    /* d, newest first */
    real_t delayed[SHADOW_REACH];
};

#endif
