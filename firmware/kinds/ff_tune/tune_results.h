/* Results that the parts of a block of the kind `ff_tune` hand on to each other. */
#ifndef REFLUX_FF_TUNE_TUNE_RESULTS_H
#define REFLUX_FF_TUNE_TUNE_RESULTS_H

#include "identify/high_order.h"
#include "kinds/ff_tune/feedforward_search.h"
#include "lti/fopdt.h"

/* Signals of a sample, in the order of the filters. */
enum tune_signal { SIGNAL_Y, SIGNAL_R, SIGNAL_D, SIGNAL_U, SIGNAL_ADDED, TUNE_SIGNALS };

/* Points of the band that a model or a rule needs. */
#define TUNE_POINTS_LEAST 3u

/* The grid, process and ratio on it, and the band, whose last point is the one before `to`. */
struct tune_band {
    real_t omega[FEEDFORWARD_POINTS];
    struct high_order_point process[FEEDFORWARD_POINTS], ratio[FEEDFORWARD_POINTS];
    uint8_t points, from, to;
};

/* A first-order model of a response. */
struct tune_model {
    struct fopdt element;
    /* r.m.s. of the distance to the response, over its size. */
    real_t misfit;
};

/* The element that the rule gives. */
struct tune_rule {
    bool valid;
    /* The case of the nine: 10, 20, 30 for I, II, III, and 1, 2, 3 for a, b, c. */
    uint8_t number;
    struct tune_model path;
    struct feedforward_shape shape;
    real_t j;
};

/* Errors of this sample. */
struct tune_errors {
    real_t actual, no_feedforward, with_candidate;
    /* They are whole, and no setpoint is under way. */
    bool count;
};

#endif
