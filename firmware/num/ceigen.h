/* Eigenvalues of a complex matrix. Rules as in num/matrix.h. */
#ifndef REFLUX_NUM_CEIGEN_H
#define REFLUX_NUM_CEIGEN_H

#include "num/cmatrix.h"

/* values[0 .. n-1] of a, which is destroyed, in no order. Hessenberg form by Householder's reflections, then QR with Wilkinson's shift by
 * rotations (Golub and Van Loan, Matrix Computations, 7.4 and 7.5): the eigenvalues of a matrix that differs from a by at most
 * 16 n REAL_EPSILON of its norm. 16 x 16: some 1e6 instructions. ERR_RANGE: not square; ERR_NOT_FINITE; ERR_TIMEOUT: 40 rounds an
 * eigenvalue were not enough. */
MUST_CHECK enum err ceigen_values(struct cmatrix *a, struct cplx *values);

/* Puts now[0 .. n-1] in the order of before[]: the two that are nearest become partners, then of the rest. For loci over
 * frequency. n to MATRIX_MAX. */
void ceigen_follow(const struct cplx *before, struct cplx *now, uint8_t n);

#endif
