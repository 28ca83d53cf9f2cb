/* The state behind experiment_loops.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_LOOPS_STATE_H
#define REFLUX_EXPERIMENT_EXPERIMENT_LOOPS_STATE_H

#include <stdbool.h>

#include "block/polynomial_settings.h"
#include "block/rst_settings.h"
#include "kinds/experiment/plant_experiment.h"

/* A decoupler and controllers for it, as their blocks have them. */
struct experiment_loops {
    float g[EXPERIMENT_KEPT * EXPERIMENT_KEPT][POLYNOMIAL_TAPS];
    /* p, q, r */
    float rst[EXPERIMENT_KEPT][3][RST_COEFFICIENTS];
    float period_s;
    /* enum polynomial_limits */
    uint8_t limits;
    /* Controllers that were proposed. */
    uint8_t part;
    /* Values of the decoupler that differed when it was proposed. */
    uint8_t left;
    /* The decoupler was proposed, and not all of it is in force. */
    bool waits;
};

#endif
