/* The state behind tune_test.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_FF_TUNE_TUNE_TEST_STATE_H
#define REFLUX_FF_TUNE_TUNE_TEST_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "num/real.h"

/* Sums of squares: of the three errors, of the disturbance. */
struct tune_squares {
    real_t actual, with_candidate, no_feedforward, d;
};

struct tune_test {
    /* This part; all parts that count. */
    struct tune_squares part, all;
    uint32_t part_samples, part_at;
    real_t promised, square, alone;
    uint8_t parts, better_parts;
};

#endif
