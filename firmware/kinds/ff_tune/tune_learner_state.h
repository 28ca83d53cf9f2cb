/* The state behind tune_learner.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_FF_TUNE_TUNE_LEARNER_STATE_H
#define REFLUX_FF_TUNE_TUNE_LEARNER_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "num/real.h"

struct tune_learner {
    real_t move_square, loop_square;
    /* Samples in these squares, at most those of `learn`. */
    uint32_t squared;
    uint32_t since_look;
    bool learns;
};

#endif
