/* Products of m x m matrices, row by row. What they write is none of what they read.
 *
 * Whoever includes this says with SMALL_BLOCKS_M how many m are: 2, and everything is expanded where it is called, as in
 * num/solve_small.h; or nothing, and they are functions for any m up to BLOCK_M_MAX. */
#ifndef REFLUX_COMPOSITION_SMALL_BLOCKS_H
#define REFLUX_COMPOSITION_SMALL_BLOCKS_H

#include "num/solve_small.h"

#ifdef SMALL_BLOCKS_M
#define BLOCK_FUNCTION ALWAYS_INLINE
#else
#define BLOCK_FUNCTION __attribute__((unused))
#endif

/* to = from */
static BLOCK_FUNCTION void block_copy(size_t count, const real_t *from, real_t *to)
{
    for (size_t i = 0; i < count; i++)
        to[i] = from[i];
}

/* to = part from + a b */
static BLOCK_FUNCTION void block_times(size_t m, real_t part, const real_t *from, const real_t *a,
                                       const real_t *b, real_t *to)
{
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++) {
            real_t sum = part * from[i * m + j];
            for (size_t k = 0; k < m; k++)
                sum = real_fma(a[i * m + k], b[k * m + j], sum);
            to[i * m + j] = sum;
        }
}

/* to = part from + a b' */
static BLOCK_FUNCTION void block_times_turned(size_t m, real_t part, const real_t *from,
                                              const real_t *a, const real_t *b, real_t *to)
{
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++) {
            real_t sum = part * from[i * m + j];
            for (size_t k = 0; k < m; k++)
                sum = real_fma(a[i * m + k], b[j * m + k], sum);
            to[i * m + j] = sum;
        }
}

/* to = a b */
static BLOCK_FUNCTION void block_product(size_t m, const real_t *a, const real_t *b, real_t *to)
{
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++) {
            real_t sum = a[i * m] * b[j];
            for (size_t k = 1; k < m; k++)
                sum = real_fma(a[i * m + k], b[k * m + j], sum);
            to[i * m + j] = sum;
        }
}

/* to = a b' */
static BLOCK_FUNCTION void block_product_turned(size_t m, const real_t *a, const real_t *b,
                                                real_t *to)
{
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++) {
            real_t sum = a[i * m] * b[j * m];
            for (size_t k = 1; k < m; k++)
                sum = real_fma(a[i * m + k], b[j * m + k], sum);
            to[i * m + j] = sum;
        }
}

/* Copies the elements right of the diagonal to the left of it. */
static BLOCK_FUNCTION void block_mirror(size_t m, real_t *a)
{
    for (size_t i = 1; i < m; i++)
        for (size_t j = 0; j < i; j++)
            a[i * m + j] = a[j * m + i];
}

/* A symmetric matrix as L D L'. */
#define BLOCK_M_MAX 3
struct block_factors {
    real_t lower[BLOCK_M_MAX * BLOCK_M_MAX], inverse[BLOCK_M_MAX]; /* of D */
};

/* Part of a pivot's first value; less is rounding. */
#define BLOCK_PIVOT_LEAST REAL_C(2e-6)

/* Factors a covariance. A number that follows from those in front of it, to rounding, is left out of products with the inverse: nothing is lost,
 * because it adds nothing to them. v_00 is above 0. */
static BLOCK_FUNCTION void block_factor(size_t m, const real_t *v, struct block_factors *f)
{
    for (size_t j = 0; j < m; j++) {
        real_t pivot = v[j * m + j];
        for (size_t k = 0; k < j; k++) /* inverse 0: so was the column */
            pivot =
                real_fma(-f->lower[j * m + k] * f->lower[j * m + k], f->lower[k * m + k], pivot);
        bool says = pivot > BLOCK_PIVOT_LEAST * v[j * m + j];
        f->lower[j * m + j] = pivot;
        f->inverse[j] = says ? 1 / pivot : 0;
        for (size_t i = j + 1; i < m; i++) {
            real_t sum = v[i * m + j];
            for (size_t k = 0; k < j; k++)
                sum =
                    real_fma(-f->lower[i * m + k] * f->lower[j * m + k], f->lower[k * m + k], sum);
            f->lower[i * m + j] = sum * f->inverse[j];
        }
    }
}

/* x <- v^-1 x, elements `stride` apart. */
static BLOCK_FUNCTION void block_solve(size_t m, const struct block_factors *f, size_t stride,
                                       real_t *x)
{
    for (size_t i = 1; i < m; i++)
        for (size_t k = 0; k < i; k++)
            x[i * stride] = real_fma(-f->lower[i * m + k], x[k * stride], x[i * stride]);
    for (size_t i = 0; i < m; i++)
        x[i * stride] *= f->inverse[i];
    for (size_t i = m - 1; i-- > 0;)
        for (size_t k = i + 1; k < m; k++)
            x[i * stride] = real_fma(-f->lower[k * m + i], x[k * stride], x[i * stride]);
}

#endif
