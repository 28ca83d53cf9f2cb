/* The state behind tune_watch.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_FF_TUNE_TUNE_WATCH_STATE_H
#define REFLUX_FF_TUNE_TUNE_WATCH_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "num/real.h"

struct tune_watch {
    /* Decaying sums: squares of the error with the element and without, of the disturbance; samples. */
    real_t actual, no_feedforward, d, weight;
    /* Samples in a row in which the loop is worse than without the element. */
    uint32_t worse_for;
    /* Samples in which it does less than half of what was promised. */
    uint32_t since_change;
    /* Times in a row that it was identified anew for doing too little. */
    uint8_t changes;
    bool as_alone;
};

#endif
