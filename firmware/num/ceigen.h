/* Eigenvalues of a complex matrix. Rules as in num/matrix.h. */
#ifndef REFLUX_NUM_CEIGEN_H
#define REFLUX_NUM_CEIGEN_H

#include "num/cmatrix.h"

/* Puts the eigenvalues of a into values[0 .. n-1], in no order, and destroys a. The method is Hessenberg form by Householder's
 * reflections, then QR with Wilkinson's shift by rotations (Golub and Van Loan, Matrix Computations, 7.4 and 7.5). The result is
 * exact for a matrix that differs from a by at most 16 n REAL_EPSILON of its norm. A 16 x 16 matrix takes some 1e6 instructions.
 * ERR_RANGE: not square. ERR_NOT_FINITE. ERR_TIMEOUT: 40 rounds per eigenvalue were not enough. */
MUST_CHECK enum err ceigen_values(struct cmatrix *a, struct cplx *values);

/* Puts now[0 .. n-1] in the order of before[], n up to MATRIX_MAX. The nearest pair become partners first, then the nearest of the
 * rest. Loci over frequency use it. */
void ceigen_follow(const struct cplx *before, struct cplx *now, uint8_t n);

#endif
