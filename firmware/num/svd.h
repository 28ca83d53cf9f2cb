/* Singular value decomposition A = U diag(s) V' by one-sided Jacobi rotations: Hestenes (1958); order of rotations and
 * convergence test after Demmel and Veselic, SIAM J. Matrix Anal. Appl. 13 (1992) 1204.
 *
 * Accuracy in float: |s - exact| <= 20 REAL_EPSILON s[0]; U and V are orthogonal to 20 REAL_EPSILON. Tests have seen up to
 * 7 sweeps in float and 15 in double. After SVD_SWEEPS the decomposition gives up (ERR_TIMEOUT). */
#ifndef REFLUX_NUM_SVD_H
#define REFLUX_NUM_SVD_H

#include "num/matrix.h"

#define SVD_SWEEPS 30

struct svd {
    uint8_t rows, cols;   /* size of A */
    uint8_t sweeps;       /* sweeps so far */
    real_t s[MATRIX_MAX]; /* min(rows, cols) singular values, largest first */
    /* Square and orthogonal; columns past the rank span the null spaces of A' and A. */
    struct matrix u, v;
    bool wide; /* the sweeps work on A' */
    bool done;
    real_t scale; /* power of two by which A was divided */
};

/* Decompose a in steps. Call svd_begin(), then svd_step() until it no longer returns ERR_BUSY. A call of svd_step() does one sweep, at
 * most 1.5e5 instructions. a is not needed after svd_begin(). ERR_RANGE and ERR_NOT_FINITE as matrix_check(). */
MUST_CHECK enum err svd_begin(struct svd *svd, const struct matrix *a);
MUST_CHECK enum err svd_step(struct svd *svd);
/* Decomposes a at once, where time does not matter or the matrix is small. */
MUST_CHECK enum err svd_decompose(struct svd *svd, const struct matrix *a);

/* Returns the number of singular values above tolerance s[0]. tolerance 0 means max(rows, cols) REAL_EPSILON. */
unsigned svd_rank(const struct svd *svd, real_t tolerance);
/* Returns s[0] / s[last]; infinity when s[last] is 0 or lost in rounding (svd_rank() with tolerance 0). */
real_t svd_condition(const struct svd *svd);
/* Finds V diag(1/s) U' over the first `rank` singular values. ERR_RANGE: one of them is 0, or rank is 0. */
MUST_CHECK enum err svd_pseudo_inverse(const struct svd *svd, unsigned rank,
                                       struct matrix *inverse);

#endif
