/* Small dense matrices in double, row by row: what the linear plants need to step exactly.
 *
 * Rules
 *  1. An n x m matrix a is a[i * m + j]. Results never overlap their operands.
 *  2. What can fail returns false: no memory, or a matrix that is singular to working precision.
 *  3. Plain loops in a fixed order: same numbers in, same bits out. */
#ifndef REFLUX_HOST_SIM_DENSE_H
#define REFLUX_HOST_SIM_DENSE_H

#include <stdbool.h>
#include <stddef.h>

/* c (n x m) = a (n x k) b (k x m) */
void dense_multiply(size_t n, size_t k, size_t m, const double *a, const double *b, double *c);

/* Solves a x = b for m right-hand sides, rows scaled, partial pivots. a is destroyed, b becomes x. False
 * when a pivot is smaller than 1e-13 of the largest element its row began with. */
bool dense_solve(size_t n, size_t m, double *a, double *b);

/* e = exp(a): balanced, scaled and squared, Pade (13, 13) after N. J. Higham (2005). */
bool dense_exp(size_t n, const double *a, double *e);

/* x(t + h) = ad x(t) + bd u for dx/dt = a x + b u with u held: zero-order hold, exact. */
bool dense_hold(size_t n, size_t m, const double *a, const double *b, double h, double *ad,
                double *bd);

#endif
