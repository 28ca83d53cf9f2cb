#ifndef REFLUX_GMV_GMV_DETUNE_STATE_H
#define REFLUX_GMV_GMV_DETUNE_STATE_H

#include "kinds/gmv/gmv_detune.h"
#include "kinds/gmv/gmv_record_state.h"

struct gmv_detune {
    /* Best of those that pass; the first one where none passes. */
    struct gmv_outcome best;
    bool passes;
    /* A trial is over. */
    bool any;
    /* Multiple of lambda under way, largest one; part of the PI's error that must be saved; least ratio of those that pass. */
    float times, most, better, noise_margin, least;
    struct gmv_record record[GMV_LOOPS];
};

#endif
