/* The state behind tune_responses.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_FF_TUNE_TUNE_RESPONSES_STATE_H
#define REFLUX_FF_TUNE_TUNE_RESPONSES_STATE_H

#include "kinds/ff_tune/tune_results.h"

struct tune_responses {
    struct tune_band band;
    struct high_order_point loop[FEEDFORWARD_POINTS], disturbance[FEEDFORWARD_POINTS];
    /* Weighted sums over the points of this look: the change since the last one, the size. */
    real_t moved, size;
    real_t change;
    uint8_t settled_looks;
};

#endif
