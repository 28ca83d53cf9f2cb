/* Polynomials of degree up to 31 and matrices of them up to 4 x 4.
 *
 * value[k] is the coefficient of x^k; n coefficients count, and n = 0 is the zero polynomial. For a plant in discrete time x is
 * z^-1, and leading zeros are a dead time. Results may not overlap operands. ERR_FULL: a product has more than POLYNOMIAL_MOST
 * coefficients. ERR_RANGE: a size. The caller owns all matrices, because one is 2.1 KiB (float). */
#ifndef REFLUX_NUM_POLYNOMIAL_H
#define REFLUX_NUM_POLYNOMIAL_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "num/cmatrix.h"
#include "num/double_symbols.h"
#include "num/real.h"

#define POLYNOMIAL_MOST        32
#define POLYNOMIAL_MATRIX_MOST 4

struct polynomial {
    uint8_t n; /* coefficients, 0 to POLYNOMIAL_MOST */
    real_t value[POLYNOMIAL_MOST];
};

struct polynomial_matrix {
    uint8_t rows, cols; /* 1 to POLYNOMIAL_MATRIX_MOST */
    struct polynomial value[POLYNOMIAL_MATRIX_MOST][POLYNOMIAL_MATRIX_MOST];
};

/* Sets a polynomial of n coefficients. Coefficients past POLYNOMIAL_MOST are left away. */
void polynomial_set(struct polynomial *p, const real_t *coefficient, unsigned n);
/* Checks a polynomial. ERR_RANGE: n. ERR_NOT_FINITE: a coefficient is NaN or infinite, or its magnitude exceeds 1e15. */
MUST_CHECK enum err polynomial_check(const struct polynomial *p);

/* sum += scale a b. */
MUST_CHECK enum err polynomial_add_product(struct polynomial *sum, real_t scale,
                                           const struct polynomial *a, const struct polynomial *b);
/* Returns the number of leading coefficients that are 0, at most n. */
unsigned polynomial_delay(const struct polynomial *p);
/* Multiplies p by x^-k: leaves its first k coefficients away. */
void polynomial_advance(struct polynomial *p, unsigned k);
/* Removes coefficients that are 0 from the end. */
void polynomial_trim(struct polynomial *p);
/* Returns p(x) by Horner's scheme; p(1) is the gain at rest. */
real_t polynomial_value(const struct polynomial *p, real_t x);
/* Returns the sum of the magnitudes of the coefficients, a bound of |p(x)| on the unit circle. */
real_t polynomial_size(const struct polynomial *p);

/* Returns whether all zeros in z of p(z^-1), p(0) not 0, are inside the circle of that radius, above 0. It uses the recursion of
 * Schur and Cohn. */
bool polynomial_zeros_within(const struct polynomial *p, real_t radius);

MUST_CHECK enum err polynomial_matrix_check(const struct polynomial_matrix *m);
/* c = a b. */
MUST_CHECK enum err polynomial_matrix_multiply(const struct polynomial_matrix *a,
                                               const struct polynomial_matrix *b,
                                               struct polynomial_matrix *c);

/* Determinant and adjugate (adj m m = det m) of a square matrix, by Laplace's expansion. It has no division, so they exist also
 * where m has no inverse. A coefficient of 32 REAL_EPSILON of the sum of the magnitudes of its terms, or less, is lost in rounding and
 * becomes 0, so that delays and degrees can be read off. The adjugate of a 1 x 1 matrix is 1. On an error results are undefined. */
struct polynomial_minors {
    struct polynomial two[6], two_size[6]; /* minors of two rows, by pairs of columns */
    struct polynomial three, three_size, part, part_size;
};
MUST_CHECK enum err polynomial_determinant(const struct polynomial_matrix *m,
                                           struct polynomial_minors *work, struct polynomial *det);
MUST_CHECK enum err polynomial_adjugate(const struct polynomial_matrix *m,
                                        struct polynomial_minors *work,
                                        struct polynomial_matrix *adj);

/* Zeros of p by the iteration of Aberth (Math. Comp. 27 (1973) 339), all at once, from points on circles. Outside the unit circle
 * the reversed polynomial is evaluated, so that nothing overflows (Bini, Numer. Algorithms 13 (1996) 179). A zero is found as soon as
 * |p| there is within its rounding. */
struct polynomial_roots {
    uint8_t n;      /* number of zeros, which is the degree; zeros at 0 are last */
    uint8_t sweeps; /* sweeps that the iteration took */
    struct cplx value[POLYNOMIAL_MOST];
    /* Radius around value[k] within which there is a zero, whatever the rounding of the coefficients and of the evaluation:
     * degree |p/p'| (Henrici, Applied and Computational Complex Analysis 1, theorem 6.4g), p with the bound of its rounding. It is
     * huge where p' is 0. */
    real_t radius[POLYNOMIAL_MOST];
};
#define POLYNOMIAL_SWEEPS 200
/* Finds the zeros, of magnitudes between 1e-9 and 1e9 (float). A sweep takes up to 1.5e5 instructions at degree 31. ERR_RANGE: p is
 * zero. ERR_NOT_FINITE. ERR_TIMEOUT: POLYNOMIAL_SWEEPS were not enough; the zeros so far are in *roots, and their radii hold. */
MUST_CHECK enum err polynomial_find_roots(const struct polynomial *p,
                                          struct polynomial_roots *roots);

#endif
