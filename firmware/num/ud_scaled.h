/* P = U D U' without floating point, as num/ud.h. Each column of U and each element of D has an exponent of its own, so that
 * range and resolution exceed those of num_t. Only the fixed build has it; identify/ reaches it through num/ud_num.h.
 *
 * P is kept in ud_scaled_cells(n) words: the packed triangle of mantissas (column j is U_0j ... U_(j-1)j, then D_j), then the exponents
 * of the columns, then those of D. Mantissas of a column of U stay below 2^27, the largest of them at or above 2^24. Rounding errors
 * are therefore 2^-25 of the column's largest. D has 30 bits. */
#ifndef REFLUX_NUM_UD_SCALED_H
#define REFLUX_NUM_UD_SCALED_H

#include "num/scaled.h"

#ifdef REFLUX_FIXED_POINT

#include <stddef.h>

typedef int32_t ud_cell_t;

#define UD_SCALED_MAX 35

static inline size_t ud_scaled_cells(size_t n)
{
    return n * (n + 1) / 2 + 2 * n;
}

/* The functions work as their namesakes in num/ud.h. Numbers that are no num_t are scaled_t, and n is up to UD_SCALED_MAX. Gains that
 * ud_scaled_correct() leaves in g may have short mantissas. With n above 24, every |phi| must be below 64. */
void ud_scaled_set_diagonal(ud_cell_t *ud, size_t n, const scaled_t *p);
void ud_scaled_project(const ud_cell_t *ud, size_t n, const num_t *phi, scaled_t *f, scaled_t *g);
scaled_t ud_scaled_variance(const scaled_t *f, const scaled_t *g, size_t n);
scaled_t ud_scaled_correct(ud_cell_t *ud, size_t n, const scaled_t *f, scaled_t *g, scaled_t r,
                           scaled_t growth);
void ud_scaled_add(ud_cell_t *ud, size_t n, scaled_t c, scaled_t *v);
void ud_scaled_scale(ud_cell_t *ud, size_t n, scaled_t factor);
void ud_scaled_multiply(const ud_cell_t *ud, size_t n, const scaled_t *x, scaled_t *y);
void ud_scaled_solve(const ud_cell_t *ud, size_t n, const scaled_t *x, scaled_t *y);
scaled_t ud_scaled_trace(const ud_cell_t *ud, size_t n);
scaled_t ud_scaled_element(const ud_cell_t *ud, size_t n, size_t i, size_t j);
void ud_scaled_extremes(const ud_cell_t *ud, size_t n, scaled_t *least, scaled_t *most);
bool ud_scaled_clamp(ud_cell_t *ud, size_t n, size_t j, scaled_t lo, scaled_t hi);

#endif
#endif
