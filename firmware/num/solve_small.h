/* Solves a few equations with several right sides, such as those of one stage of a column. All functions are expanded at the call, with
 * the number of unknowns known there, because loops of two turns cost more than their bodies. */
#ifndef REFLUX_NUM_SOLVE_SMALL_H
#define REFLUX_NUM_SOLVE_SMALL_H

#include <stdbool.h>
#include <stddef.h>

#include "num/real.h"

#define ALWAYS_INLINE inline __attribute__((always_inline))

static ALWAYS_INLINE void solve_small_swap(real_t *a, real_t *b, size_t width)
{
    for (size_t j = 0; j < width; j++) {
        real_t kept = a[j];
        a[j] = b[j];
        b[j] = kept;
    }
}

/* Solves by Gauss and Jordan with the largest pivot of each column. There are m rows of `width` numbers, `stride` apart: the m x m
 * matrix, then the right sides, which become the solutions. Returns false where no pivot is above `least`, or one is NaN. */
static ALWAYS_INLINE bool solve_small_above(real_t least, size_t m, size_t width, size_t stride,
                                            real_t *rows)
{
    for (size_t p = 0; p < m; p++) {
        size_t largest = p;
        for (size_t i = p + 1; i < m; i++)
            if (real_abs(rows[i * stride + p]) > real_abs(rows[largest * stride + p]))
                largest = i;
        if (!(real_abs(rows[largest * stride + p]) > least))
            return false;
        if (largest != p)
            solve_small_swap(&rows[p * stride], &rows[largest * stride], width);
        real_t *pivot = &rows[p * stride], scale = REAL_C(1.0) / pivot[p];
        for (size_t j = p + 1; j < width; j++)
            pivot[j] *= scale;
        for (size_t i = 0; i < m; i++) {
            if (i == p)
                continue;
            real_t part = rows[i * stride + p];
            for (size_t j = p + 1; j < width; j++)
                rows[i * stride + j] -= part * pivot[j];
        }
    }
    return true;
}

/* Solves likewise. A pivot must be above `share` of the largest element of the matrix. */
static ALWAYS_INLINE bool solve_small_scaled(real_t share, size_t m, size_t width, size_t stride,
                                             real_t *rows)
{
    real_t largest = REAL_C(0.0);
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++)
            if (real_abs(rows[i * stride + j]) > largest)
                largest = real_abs(rows[i * stride + j]);
    return solve_small_above(share * largest, m, width, stride, rows);
}

/* Solves likewise. Returns false where the matrix is singular, or a pivot is NaN. */
static ALWAYS_INLINE bool solve_small(size_t m, size_t width, size_t stride, real_t *rows)
{
    return solve_small_above(REAL_C(0.0), m, width, stride, rows);
}

#endif
