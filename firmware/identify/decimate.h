/* Samples that come faster than the control interval: one in `ratio` is kept, as it is or behind a low-pass filter on all of them, as
 * Kotyk and Machacek (1995), section 3, treat a noisy measurement; the filter is not told there, this one is ours.
 *
 * The filter belongs to the plant that is identified, with its delay of about a control interval at a cutoff of 0.5: no controller of the
 * board sees the measurement through it, and the zeros it brings are outside the unit circle. Without it the model is that of the samples
 * the controllers take. Only outputs are filtered, inputs are those of the samples that are kept.
 *
 * Butterworth of second order, by the trapezoidal rule in the form of integrators (A. Simper 2013), whose gain at rest is 1
 * however low the cutoff. K = tan(pi cutoff/(2 ratio)).
 *
 * Accuracy: within 16 REAL_EPSILON (1 + 1/K) of the largest |x|. */
#ifndef REFLUX_IDENTIFY_DECIMATE_H
#define REFLUX_IDENTIFY_DECIMATE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "num/real.h"

struct decimator {
    uint16_t ratio;
    /* Samples since the last that was kept. */
    uint16_t count;
    bool begun;
    real_t k, share; /* K, 1/(1 + K(K + sqrt 2)) */
    real_t speed, level;
};

/* ratio: 1 to 10000, of samples to those that are kept; 1: nothing is filtered. cutoff: where the filter lets 1/sqrt 2 pass, as
 * a part of half the frequency of the samples kept, [0.01, 1]; 0: no filter. ERR_RANGE, ERR_NOT_FINITE: *d unchanged. */
MUST_CHECK enum err decimator_init(struct decimator *d, uint32_t ratio, real_t cutoff);

/* A sample, finite. Returns whether it is one that is kept, the first and every ratio-th behind it; *kept gets it then. The
 * filter begins at rest at the first. */
bool decimator_step(struct decimator *d, real_t x, real_t *kept);

#endif
