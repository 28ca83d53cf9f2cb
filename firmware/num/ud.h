/* Covariances as P = U D U': U is upper triangular with ones on its diagonal, D is diagonal. P stays symmetric whatever the
 * rounding, and positive as long as D is positive; Bierman's measurement update keeps D positive.
 *
 * P is kept in one packed triangle of n(n+1)/2 numbers, column by column: column j is U_0j ... U_(j-1)j, then D_j.
 * These functions compute in real_t. num/ud_scaled.h is the same with exponents, for builds without floating point.
 * identify/rls.c takes the one of its build.
 *
 * Sources: G. J. Bierman, Factorization Methods for Discrete Sequential Estimation (1977), ch. V (measurement update; rank-one
 * addition after Agee and Turner).
 *
 * Order of calls for a measurement: ud_project(), then ud_correct() with its results. n is at least 1; the largest user,
 * the whole covariance of `composition`, has 128. No function allocates or checks: the caller gives finite numbers and a
 * positive D. */
#ifndef REFLUX_NUM_UD_H
#define REFLUX_NUM_UD_H

#include <stddef.h>

#include "num/double_symbols.h"
#include "num/real.h"

/* Returns the count of numbers in a packed triangle. */
static inline size_t ud_count(size_t n)
{
    return n * (n + 1) / 2;
}

/* P = diag(p), p positive. */
void ud_set_diagonal(real_t *ud, size_t n, const real_t *p);

/* Returns phi'P phi = f'g, from the results of ud_project(). */
static inline real_t ud_variance(const real_t *f, const real_t *g, size_t n)
{
    real_t sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += f[i] * g[i];
    return sum;
}

/* f = U'phi, g = D f. */
void ud_project(const real_t *ud, size_t n, const real_t *phi, real_t *f, real_t *g);

/* Takes in a measurement whose noise has the variance r > 0: P becomes (P - P phi phi'P/alpha) * growth, alpha = r + phi'P phi.
 * f and g are the results of ud_project(); g becomes P phi with the P of before, so the gain is g/alpha. Returns alpha. growth is
 * 1/v when old data is forgotten with the factor v, else 1. ud_correct_from(): phi has its first element at `from` and the elements
 * of f and g before it are 0. It leaves the columns before `from` alone, so growth must be 1 there. */
real_t ud_correct_from(real_t *ud, size_t n, size_t from, const real_t *f, real_t *g, real_t r,
                       real_t growth);
static inline real_t ud_correct(real_t *ud, size_t n, const real_t *f, real_t *g, real_t r,
                                real_t growth)
{
    return ud_correct_from(ud, n, 0, f, g, r, growth);
}

/* P += c v v', c >= 0. The function destroys v. */
void ud_add(real_t *ud, size_t n, real_t c, real_t *v);
/* P_at,at += c > 0, all D above 0. v is space for `at` numbers. It takes the time of the columns up to `at`. ud_add_pair() also adds
 * `below` > 0 to the diagonal element before, at >= 1, with space for 2 at - 1 numbers, in two thirds of the time of two calls. */
void ud_add_at(real_t *ud, size_t at, real_t c, real_t *v);
void ud_add_pair(real_t *ud, size_t at, real_t c, real_t below, real_t *v);

/* P *= factor, factor > 0. */
void ud_scale(real_t *ud, size_t n, real_t factor);

/* Compute y = P x, and y = P^-1 x. x and y may be the same. */
void ud_multiply(const real_t *ud, size_t n, const real_t *x, real_t *y);
void ud_solve(const real_t *ud, size_t n, const real_t *x, real_t *y);

real_t ud_trace(const real_t *ud, size_t n);
/* Returns P_ij. */
real_t ud_element(const real_t *ud, size_t n, size_t i, size_t j);
/* Finds the smallest and the largest D. */
void ud_extremes(const real_t *ud, size_t n, real_t *least, real_t *most);
/* Brings D_j into [lo, hi]. Returns whether D_j changed. */
bool ud_clamp(real_t *ud, size_t n, size_t j, real_t lo, real_t hi);

#endif
