/* Singular value decomposition A = U diag(s) V' by one-sided Jacobi rotations: Hestenes (1958); order of rotations and
 * convergence test after Demmel and Veselic, SIAM J. Matrix Anal. Appl. 13 (1992) 1204.
 *
 * Accuracy in float: |s - exact| <= 20 REAL_EPSILON s[0]; U and V orthogonal to 20 REAL_EPSILON. Up to 7 sweeps
 * in float and 15 in double have been seen; after SVD_SWEEPS it is given up (ERR_TIMEOUT). */
#ifndef REFLUX_NUM_SVD_H
#define REFLUX_NUM_SVD_H

#include "num/matrix.h"

#define SVD_SWEEPS 30

struct svd {
    uint8_t rows, cols;   /* of A */
    uint8_t sweeps;       /* so far */
    real_t s[MATRIX_MAX]; /* min(rows, cols) singular values, largest first */
    struct matrix u,
        v;     /* square, orthogonal; columns past the rank span the null spaces of A' and A */
    bool wide; /* works on A' */
    bool done;
    real_t scale; /* A was divided by it, a power of two */
};

/* ERR_RANGE and ERR_NOT_FINITE as matrix_check. Then svd_step until it no longer says ERR_BUSY: one sweep a call, at most 1.5e5 instructions. a is not needed after svd_begin. */
MUST_CHECK enum err svd_begin(struct svd *svd, const struct matrix *a);
MUST_CHECK enum err svd_step(struct svd *svd);
/* All at once: where time does not matter, or the matrix is small. */
MUST_CHECK enum err svd_decompose(struct svd *svd, const struct matrix *a);

/* Singular values above tolerance s[0]; tolerance 0 means max(rows, cols) REAL_EPSILON. */
unsigned svd_rank(const struct svd *svd, real_t tolerance);
/* s[0] / s[last]; infinite when s[last] is 0 or lost in rounding (svd_rank with tolerance 0). */
real_t svd_condition(const struct svd *svd);
/* V diag(1/s) U' over the first `rank` singular values; ERR_RANGE when one of them is 0 or rank is 0. */
MUST_CHECK enum err svd_pseudo_inverse(const struct svd *svd, unsigned rank,
                                       struct matrix *inverse);

#endif
