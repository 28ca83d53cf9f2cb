/* Steps and measurements of a Kalman filter's covariance, common to its forms.
 *
 * States, in this order: mole fractions of the column as in model/column.h (n = stages m of them), then up to COVARIANCE_EXTRAS_MAX
 * "extras" (an unknown part of the feed's composition or flow, the offset of an analysed place). Extras move the fractions, fractions do
 * not move extras. Over a step
 *
 *     P <- A (P + N) A' + G,   A = [Phi   Phi push']    Phi of model/column_transition.h: what an extra pushes is carried as well
 *                                  [ 0      keep   ]
 *
 * N is the noise of the fractions. It enters before Phi, as an unknown rate during the step, which a stage that settles sooner does not
 * keep; G is the noise of the extras.
 *
 * Forms: kinds/composition/covariance_ud.h, the whole; kinds/composition/covariance_band.h, of neighbouring stages. */
#ifndef REFLUX_COMPOSITION_COVARIANCE_H
#define REFLUX_COMPOSITION_COVARIANCE_H

#include "model/column_transition.h"

#define COVARIANCE_EXTRAS_MAX 8
#define COVARIANCE_STATES_MAX (COLUMN_STATES_MAX + COVARIANCE_EXTRAS_MAX)

/* No variance is known to be less, given all states behind it in the order above: a standard deviation of 1e-12. */
#define COVARIANCE_LEAST REAL_C(1e-24)

/* A step of the states. All arrays are the caller's and stay as they are until the step is done. */
struct covariance_step {
    const struct column_transition *transition;
    size_t extras;
    /* [extras][n]: h times the slope of the fractions' rates by each extra; zeros for an offset */
    const real_t *push;
    const real_t *keep;  /* [extras]: part of an extra that is left after the step, 0 to 1 */
    const real_t *grown; /* [extras]: variance that an extra gathers in the step, 0 or more */
    const real_t *noise; /* [n]: variance that a fraction gathers in the step, 0 or more */
    /* Only the fractions noise_first .. noise_first + noise_count - 1 (mod n) get theirs in this step, since noise costs as much as all
     * the rest where all of them do: a caller that goes round makes noise[] as much larger. noise_count: at most n. */
    size_t noise_first, noise_count;
};

/* z = sum of slope[i] * fraction[first + i], i < count, + extra_slope * extra, and white noise. */
struct covariance_measurement {
    /* Fractions first .. first + count - 1, at least one, within n. */
    size_t first, count;
    const real_t *slope;
    size_t extra; /* from 0; the number of extras or more: none */
    real_t extra_slope;
    real_t variance; /* above 0 */
};

#endif
