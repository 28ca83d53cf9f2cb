/* The covariance of a Kalman filter as U D U' (num/ud.h), of all states, resumable: symmetric and positive however rounding goes.
 *
 * A step is done on the square root S = U D^(1/2), P = S S', by what turns rows of S alone, so that nothing is ever squared and
 * subtracted. Columns of a stage pass both sweeps of the transition; what the second one leaves left of the diagonal is turned into the
 * columns beside it by Householder's reflections, on the way up so far that only the m columns left of the diagonal are filled, on the
 * way back entirely. About 12 n^2 multiplications for m = 2, where products with Phi take n^3. Works for every efficiency and takes no
 * pivots. Noise is added one fraction after the other (Agee and Turner), measurements are taken by Bierman's update, both in num/ud.h.
 * The way through the transition (kinds/composition/covariance_root.c) is ours; what it stands in for is C. L. Thornton's, Triangular Covariance Factorizations for
 * Kalman Filtering (1976). */
#ifndef REFLUX_COMPOSITION_COVARIANCE_UD_H
#define REFLUX_COMPOSITION_COVARIANCE_UD_H

#include "kinds/composition/covariance_root_state.h"

struct covariance_ud {
    size_t stages, m, n, extras; /* n: stages m fractions */
    real_t *ud;                  /* packed, n + extras: P between two steps */
    real_t *spare;               /* [2 (n + extras)] */
    /* within a step */
    size_t phase, next;
    struct covariance_root root;
};

/* Bytes of memory, aligned as real_t. */
size_t covariance_ud_bytes(size_t stages, size_t m, size_t extras);

/* P = diag(variance[n + extras]), in `memory` of covariance_ud_bytes. ERR_RANGE: below 0, or sizes that no column has (2 stages to
 * COLUMN_STAGES_MAX, 1 to 3 fractions, at most COVARIANCE_EXTRAS_MAX extras); ERR_NOT_FINITE. */
MUST_CHECK enum err covariance_ud_begin(struct covariance_ud *c, size_t stages, size_t m,
                                        size_t extras, const real_t *variance, void *memory);

/* Does a part of a step: about `effort` elements of the triangle at most, or the least that can be done at once, which is noise of one or
 * two fractions. True while there is more; until then nothing but this may be called, with the same step. How it is cut does not change
 * the result. COVARIANCE_UD_EFFORT is at most 100,000 instructions on a Cortex-M4F. */
#define COVARIANCE_UD_EFFORT 2000
bool covariance_ud_carry_piece(struct covariance_ud *c, const struct covariance_step *step,
                               size_t effort);

/* gain[n + extras] = P h'/alpha, P <- P - P h' h P/alpha. Returns alpha = h P h' + variance. 0: that was no number, or not above 0; then
 * P stays and the gain is 0. */
real_t covariance_ud_take(struct covariance_ud *c, const struct covariance_measurement *z,
                          real_t *gain);

/* h P h', without z->variance. */
real_t covariance_ud_of(struct covariance_ud *c, const struct covariance_measurement *z);

/* Returns how the last step ended. */
enum err covariance_ud_err(const struct covariance_ud *c);

/* Smallest and largest variance of a state. */
void covariance_ud_extremes(struct covariance_ud *c, real_t *least, real_t *most);

#endif
