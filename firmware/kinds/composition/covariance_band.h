/* The covariance of a Kalman filter in a block-banded form: cost and memory are linear in the number of stages.
 *
 * Fractions x and extras t (kinds/composition/covariance.h) are taken as
 *
 *     x = M t + e,   P = [ S + M T M'   M T ]    T = cov t, S = cov e
 *                        [    T M'        T ]
 *
 * What is kept: T as U D U' (num/ud.h), M whole, and of S the blocks of each stage and of its neighbours. The rest of S is not taken as 0
 * but as what follows from these where a stage given its neighbour has nothing more to do with stages beyond it,
 *
 *     S_(s,u) = S_(s,s+1) S_(s+1,s+1)^-1 S_(s+1,u)   for u > s + 1
 *
 * so S is the most random one with the blocks that are kept, and its inverse is block-banded. Measurements leave S so: nothing is lost
 * there. A step does not; it is carried exactly through each sweep of the transition, and after each the blocks beyond the
 * neighbours are forgotten. Each matrix is a covariance whatever is forgotten: no variance becomes negative, no taper is needed. The
 * uncertainty of an extra stays in M, so that an unmeasured feed binds stages far from each other. Cost: docs/methods/kalman.md.
 *
 * Sources: A. Asif, J. M. F. Moura, Block matrices with L-block-banded inverse: inversion algorithms, IEEE Trans. Signal Processing 53
 * (2005) 630 (the completion). M and the way through the transition are ours. */
#ifndef REFLUX_COMPOSITION_COVARIANCE_BAND_H
#define REFLUX_COMPOSITION_COVARIANCE_BAND_H

#include "kinds/composition/covariance_band_inside.h"

struct covariance_band {
    size_t stages, m, extras;
    /* [stages]: S_(s,s), S_(s,s+1) (m x m, row by row), then M turned [extras][m] */
    real_t *blocks;
    real_t *ud; /* packed, of the extras */
    /* within a step */
    size_t phase, next;
    struct covariance_band_fresh fresh[COVARIANCE_EXTRAS_MAX];
    real_t block[4][COVARIANCE_BAND_BLOCK]; /* carried by a sweep from stage to stage */
    real_t row[COVARIANCE_EXTRAS_MAX * COVARIANCE_BAND_M_MAX];
    enum err err; /* ERR_NOT_FINITE: the last step made something that is no number */
};

/* Bytes of memory, aligned as real_t. */
size_t covariance_band_bytes(size_t stages, size_t m, size_t extras);

/* P = diag(variance[n + extras]), in `memory` of covariance_band_bytes; a variance below COVARIANCE_LEAST becomes that. ERR_RANGE: below 0,
 * or sizes that no column has (2 stages or more, at most COLUMN_STATES_MAX fractions, COVARIANCE_EXTRAS_MAX extras); ERR_NOT_FINITE. */
MUST_CHECK enum err covariance_band_begin(struct covariance_band *c, size_t stages, size_t m,
                                          size_t extras, const real_t *variance, void *memory);

/* Does a part of a step: stages of one of its two sweeps with some `effort` numbers of what is kept, or one stage. True while there is
 * more; until then nothing but this may be called. How it is cut does not change the result. An effort of COVARIANCE_BAND_EFFORT is at
 * most 100,000 instructions on a Cortex-M4F. Of an extra COVARIANCE_BAND_KEEP is kept at least. */
#define COVARIANCE_BAND_EFFORT 420
#define COVARIANCE_BAND_KEEP   REAL_C(0.015625)
bool covariance_band_carry_piece(struct covariance_band *c, const struct covariance_step *step,
                                 size_t effort);

/* gain[n + extras] = P h'/alpha, P <- P - P h' h P/alpha. Returns alpha = h P h' + variance. 0: that was no number, or not above 0, or
 * the fractions are not all of one stage; then P stays and the gain is 0. */
real_t covariance_band_take(struct covariance_band *c, const struct covariance_measurement *z,
                            real_t *gain);

/* h P h', without z->variance. */
real_t covariance_band_of(const struct covariance_band *c, const struct covariance_measurement *z);

/* Returns how the last step ended. */
enum err covariance_band_err(const struct covariance_band *c);

/* Smallest and largest variance of a state. */
void covariance_band_extremes(const struct covariance_band *c, real_t *least, real_t *most);

#endif
