/* Dense matrices of real_t, up to 16 x 16: LU decomposition, inverse, determinant, pseudo-inverse of full rank.
 *
 * Rules
 *  1. A matrix carries its size; element (row i, column j) is value[i][j], both from 0. Functions neither read nor write
 *     elements outside the size.
 *  2. The caller owns work and results, because a matrix is 1 KiB (float), too much for the stack of a board.
 *  3. Results may not overlap operands unless the function says so. On an error results are undefined and operands whole.
 *  4. Loops run in a fixed order, so the same numbers give the same bits. At 16 x 16, equilibration and the pseudo-inverse
 *     take up to 1e5 instructions, the others up to 6e4 (tools/bench counts them). */
#ifndef REFLUX_NUM_MATRIX_H
#define REFLUX_NUM_MATRIX_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "num/double_symbols.h"
#include "num/real.h"

#define MATRIX_MAX 16

struct matrix {
    uint8_t rows, cols; /* 1 to MATRIX_MAX */
    real_t value[MATRIX_MAX][MATRIX_MAX];
};

/* Factors P A = L U. value holds U and, below its diagonal, L. row[k] is the row of A that became row k. */
struct lu {
    uint8_t n;
    int16_t sign; /* sign of the permutation */
    uint8_t row[MATRIX_MAX];
    real_t value[MATRIX_MAX][MATRIX_MAX];
};

/* Checks a matrix. ERR_RANGE: its size. ERR_NOT_FINITE: an element is NaN or infinite, or its magnitude exceeds 1e15. */
MUST_CHECK enum err matrix_check(const struct matrix *a);

/* c = a b; a->cols must equal b->rows (ERR_RANGE). */
MUST_CHECK enum err matrix_multiply(const struct matrix *a, const struct matrix *b,
                                    struct matrix *c);
void matrix_transpose(const struct matrix *a, struct matrix *t);

/* Finds factors r and c such that the rows of diag(r) A diag(c) have about the same norm, and so have the columns. It divides
 * every row, then every column, by its Euclidean norm, in rounds (Sinkhorn and Knopp 1967; Ruiz 2001). r and c have an element
 * for every row and column; it is 1 for a row or column of zeros. exact: twenty rounds. Otherwise there are six rounds, and the
 * factors are powers of two, so that scaling by them rounds nothing. */
void matrix_equilibrate(const struct matrix *a, bool exact, real_t *r, real_t *c);

/* Factors a by Gaussian elimination with row-scaled partial pivoting (Golub and Van Loan, Matrix Computations, 3.4).
 * ERR_RANGE: not square. ERR_NOT_FINITE. ERR_SINGULAR: a pivot is at most n REAL_EPSILON of the largest element with which its
 * row began. */
MUST_CHECK enum err lu_factor(const struct matrix *a, struct lu *lu);
/* Solves A x = b; x may be b. */
void lu_solve(const struct lu *lu, const real_t *b, real_t *x);
void lu_inverse(const struct lu *lu, struct matrix *inverse);
/* Finds det A = *sign exp(*log_magnitude). The natural logarithm neither overflows nor vanishes. */
void lu_determinant(const struct lu *lu, int *sign, real_t *log_magnitude);

/* Moore-Penrose inverse of a matrix of full rank. A square matrix is inverted by LU, another one by Gram-Schmidt with
 * reorthogonalisation (a = Q R, a+ = R^-1 Q'; the transpose of a wide one). ERR_SINGULAR: the rank is not full to working
 * precision. num/svd.h takes a matrix of any rank. */
struct pseudo_inverse_work {
    struct lu lu;
    struct matrix q;
};
MUST_CHECK enum err matrix_pseudo_inverse(const struct matrix *a, struct pseudo_inverse_work *work,
                                          struct matrix *inverse);

#endif
