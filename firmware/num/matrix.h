/* Dense matrices of real_t, up to 16 x 16: LU decomposition, inverse, determinant, pseudo-inverse of full rank.
 *
 * Rules
 *  1. A matrix carries its size; element (row i, column j) is value[i][j], both from 0. What lies outside the size is
 *     neither read nor written.
 *  2. A matrix is 1 KiB (float), too much for the stack of a board: work and results belong to the caller.
 *  3. Results may not overlap operands unless the function says so. On error results are undefined, operands whole.
 *  4. Plain loops in a fixed order: same numbers in, same bits out. At 16 x 16 equilibration and the pseudo-inverse take
 *     up to 1e5 instructions, the others up to 6e4 (tools/bench counts them). */
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

/* P A = L U: value holds U and, below its diagonal, L; row[k] is the row of A that became row k. */
struct lu {
    uint8_t n;
    int16_t sign; /* of the permutation */
    uint8_t row[MATRIX_MAX];
    real_t value[MATRIX_MAX][MATRIX_MAX];
};

/* ERR_RANGE: size; ERR_NOT_FINITE: an element is NaN or infinite, or its magnitude exceeds 1e15. */
MUST_CHECK enum err matrix_check(const struct matrix *a);

/* c = a b; a->cols must equal b->rows (ERR_RANGE). */
MUST_CHECK enum err matrix_multiply(const struct matrix *a, const struct matrix *b,
                                    struct matrix *c);
void matrix_transpose(const struct matrix *a, struct matrix *t);

/* Factors r and c such that diag(r) A diag(c) has rows of about one norm and columns of about one norm: every row, then
 * every column, is divided by its Euclidean norm, again and again (Sinkhorn and Knopp 1967; Ruiz 2001). r and c have an
 * element for every row and column; of a row or column of zeros it is 1. exact: twenty rounds; else six, and the factors
 * are powers of two, so that scaling by them rounds nothing. */
void matrix_equilibrate(const struct matrix *a, bool exact, real_t *r, real_t *c);

/* Gaussian elimination with row-scaled partial pivoting (Golub and Van Loan, Matrix Computations, 3.4). ERR_RANGE: not
 * square; ERR_NOT_FINITE; ERR_SINGULAR: a pivot at most n REAL_EPSILON of the largest element its row began with. */
MUST_CHECK enum err lu_factor(const struct matrix *a, struct lu *lu);
/* A x = b; x may be b. */
void lu_solve(const struct lu *lu, const real_t *b, real_t *x);
void lu_inverse(const struct lu *lu, struct matrix *inverse);
/* det A = *sign exp(*log_magnitude); natural logarithm, so that it neither overflows nor vanishes. */
void lu_determinant(const struct lu *lu, int *sign, real_t *log_magnitude);

/* Moore-Penrose inverse of a matrix of full rank: inverse of a square one by LU, else by Gram-Schmidt with
 * reorthogonalisation (a = Q R, a+ = R^-1 Q'; of a wide one the transpose). ERR_SINGULAR: rank not full to working
 * precision. For a matrix of any rank: num/svd.h. */
struct pseudo_inverse_work {
    struct lu lu;
    struct matrix q;
};
MUST_CHECK enum err matrix_pseudo_inverse(const struct matrix *a, struct pseudo_inverse_work *work,
                                          struct matrix *inverse);

#endif
