/* One way from an input to an output, all rounds together: a record of model.c, which alone writes it. */
#ifndef REFLUX_COMMISSION_ELEMENT_H
#define REFLUX_COMMISSION_ELEMENT_H

#include "identify/identified.h"

#define ASYMMETRY_UNIT REAL_C(1000.0)

struct element {
    struct identified fit; /* least squares, weighted over the rounds; the design uses it */
    struct fopdt moments;  /* of the last round: a second opinion */
    uint16_t moments_flags;
    /* Gain up less gain down over their mean, last round, in 1/ASYMMETRY_UNIT; 0: none that is certain. */
    int16_t asymmetry;
    /* The beginning of the response where that is not a lag's, last such round: slope after a unit step, 1/s, magnitude, and
     * dead time with one standard deviation. Slope 0: none. */
    real_t early_slope, early_dead_s;
    real_t plateau_gain; /* of the last round; 0: none */
    real_t misfit;       /* standard deviation of the gain that is not noise, weighted likewise */
};

#endif
