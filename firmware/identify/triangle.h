/* Least squares by orthogonal rotations, a row at a time: the triangle R of  Q'[X Z] = [R S]  stands for all rows that have
 * been taken in. No squares of the data are formed, so float has the digits that normal equations would need double for.
 *
 * Of least squares the last column is what is to be explained: of columns x_1 .. x_n y the triangle holds R, Q'y and, at its
 * corner, the root of the sum of squared errors. Columns on the right are rotated along and not eliminated.
 *
 * Source: G. H. Golub and C. F. Van Loan, Matrix Computations, 5.2.3 (Givens) and 12.5 (row by row).
 *
 * Accuracy: R is that of rows changed by at most 6 (columns) REAL_EPSILON of their size each; sums over many rows lose no
 * more than rows/2 REAL_EPSILON, in practice its root. Magnitudes of rows up to 1e15. */
#ifndef REFLUX_IDENTIFY_TRIANGLE_H
#define REFLUX_IDENTIFY_TRIANGLE_H

#include <stddef.h>
#include <stdint.h>

#include "base/assertion.h"
#include "base/error.h"
#include "num/real.h"

#define TRIANGLE_MOST 84 /* columns and those on the right, together */

struct triangle {
    uint8_t columns, right;
    /* The caller's, triangle_count() numbers: row by row from its diagonal on. */
    real_t *cells;
};

static inline size_t triangle_count(size_t columns, size_t right)
{
    return columns * (columns + 1) / 2 + columns * right;
}

/* No rows yet. columns from 1, columns + right to TRIANGLE_MOST. */
void triangle_begin(struct triangle *t, size_t columns, size_t right, real_t *memory);

/* row [columns + right] is used up: what is left of the right is what no column explains. */
void triangle_row(struct triangle *t, real_t *row);

/* Row i from its diagonal on. */
static inline real_t *triangle_at(const struct triangle *t, size_t i)
{
    REFLUX_ASSERT(i < t->columns);
    size_t width = (size_t)t->columns + t->right;
    return &t->cells[i * width - i * (i - (i > 0)) / 2];
}

/* The triangle of some columns of another, n of them in this order, as if only they had been there: without the rows,
 * which are gone. memory: triangle_count(n, 0). from has nothing on the right. */
void triangle_select(const struct triangle *from, const uint8_t *column, size_t n,
                     struct triangle *to, real_t *memory);

/* theta [columns - 1]: what explains the last column best. ERR_SINGULAR: a column is a combination of others but for
 * rounding, its diagonal at most 8 columns REAL_EPSILON of the column's norm. */
MUST_CHECK enum err triangle_solve(const struct triangle *t, real_t *theta);

/* Sum of squared errors of the last column. */
real_t triangle_rest(const struct triangle *t);

/* Fills spread with the standard deviation of each theta [columns - 1] over that of the noise, if that is white: the root of the diagonal of
 * (X'X)^-1. Only after triangle_solve has succeeded. */
void triangle_spread(const struct triangle *t, real_t *spread);

#endif
