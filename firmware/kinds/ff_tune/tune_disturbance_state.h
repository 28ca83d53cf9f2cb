/* The state behind tune_disturbance.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_FF_TUNE_TUNE_DISTURBANCE_STATE_H
#define REFLUX_FF_TUNE_TUNE_DISTURBANCE_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "num/real.h"

struct tune_disturbance {
    /* Mean squares: of late; the largest of the last hours; the one that the element in force was learnt from, 0 where none was; of a
     * reading when it rested last. */
    real_t square, most, learnt, noise;
    uint32_t still;
};

#endif
