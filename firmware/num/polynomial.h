/* Polynomials of degree up to 31 and matrices of them up to 4 x 4.
 *
 * value[k] is the coefficient of x^k; n coefficients count, n = 0 is the zero polynomial. Of a plant in discrete time x is z^-1,
 * and leading zeros are a dead time. Results may not overlap operands. ERR_FULL: a product has more than POLYNOMIAL_MOST
 * coefficients; ERR_RANGE: a size. A matrix of them is 2.1 KiB (float): it belongs to the caller. */
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

/* n coefficients; more than POLYNOMIAL_MOST are left away. */
void polynomial_set(struct polynomial *p, const real_t *coefficient, unsigned n);
/* ERR_RANGE: n; ERR_NOT_FINITE: a coefficient is NaN or infinite, or its magnitude exceeds 1e15. */
MUST_CHECK enum err polynomial_check(const struct polynomial *p);

/* sum += scale a b. */
MUST_CHECK enum err polynomial_add_product(struct polynomial *sum, real_t scale,
                                           const struct polynomial *a, const struct polynomial *b);
/* Leading coefficients that are 0, at most n. */
unsigned polynomial_delay(const struct polynomial *p);
/* x^-k p: its first k coefficients are left away. */
void polynomial_advance(struct polynomial *p, unsigned k);
/* Coefficients at the end that are 0 no longer count. */
void polynomial_trim(struct polynomial *p);
/* p(x); p(1) is the gain at rest. Horner. */
real_t polynomial_value(const struct polynomial *p, real_t x);
/* Sum of the magnitudes of its coefficients: the largest |p(x)| on the unit circle is no more. */
real_t polynomial_size(const struct polynomial *p);

/* Whether all zeros in z of p(z^-1), p(0) not 0, are inside the circle of that radius, above 0: the recursion of Schur and Cohn. */
bool polynomial_zeros_within(const struct polynomial *p, real_t radius);

MUST_CHECK enum err polynomial_matrix_check(const struct polynomial_matrix *m);
/* c = a b. */
MUST_CHECK enum err polynomial_matrix_multiply(const struct polynomial_matrix *a,
                                               const struct polynomial_matrix *b,
                                               struct polynomial_matrix *c);

/* Determinant and adjugate (adj m m = det m) of a square matrix, by Laplace's expansion: no division, so they exist also where
 * m has no inverse. A coefficient that is lost in rounding, 32 REAL_EPSILON of the sum of the magnitudes of its terms or less, is
 * 0: only so delays and degrees can be read off. The adjugate of a 1 x 1 matrix is 1. On error results are undefined. */
struct polynomial_minors {
    struct polynomial two[6], two_size[6]; /* minors of two rows, by pairs of columns */
    struct polynomial three, three_size, part, part_size;
};
MUST_CHECK enum err polynomial_determinant(const struct polynomial_matrix *m,
                                           struct polynomial_minors *work, struct polynomial *det);
MUST_CHECK enum err polynomial_adjugate(const struct polynomial_matrix *m,
                                        struct polynomial_minors *work,
                                        struct polynomial_matrix *adj);

/* Zeros of p by the iteration of Aberth (Math. Comp. 27 (1973) 339), all at once, from points on a circle; outside the unit circle
 * the reversed polynomial is evaluated, so that nothing overflows (Bini, Numer. Algorithms 13 (1996) 179). A zero stands as soon as
 * |p| there is within its rounding. */
struct polynomial_roots {
    uint8_t n;      /* as many as the degree, those at 0 last */
    uint8_t sweeps; /* it took */
    struct cplx value[POLYNOMIAL_MOST];
    /* Within so much of value[k] there is one, whatever the coefficients' and the evaluation's rounding: degree |p/p'| (Henrici,
     * Applied and Computational Complex Analysis 1, theorem 6.4g), p with the bound of its rounding. Huge where p' is 0. */
    real_t radius[POLYNOMIAL_MOST];
};
#define POLYNOMIAL_SWEEPS 200
/* ERR_RANGE: p is zero; ERR_NOT_FINITE; ERR_TIMEOUT after POLYNOMIAL_SWEEPS, with what there was by then: the radii hold all the
 * same. Zeros of magnitudes between 1e-9 and 1e9 (float). Up to 1.5e5 instructions a sweep at degree 31. */
MUST_CHECK enum err polynomial_find_roots(const struct polynomial *p,
                                          struct polynomial_roots *roots);

#endif
