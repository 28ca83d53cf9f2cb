/* A Kalman filter's covariance in double and with full matrices, without what the banded form of kinds/composition/covariance_band.h leaves out:
 * steps by products, what is forgotten filled in again by the formula of the form's header, from the whole matrix. */
#ifndef REFLUX_TESTS_DENSE_BAND_H
#define REFLUX_TESTS_DENSE_BAND_H

#include "kinds/composition/covariance_band.h"

#include <math.h>
#include <string.h>

#define DENSE_MOST 80 /* states */

typedef double dense_square[DENSE_MOST][DENSE_MOST];

struct dense_band {
    size_t stages, m, n, q;
    bool whole;       /* nothing is left out */
    dense_square p;   /* of x and extras */
    double condition; /* largest of the correlations of a stage that were inverted so far */
};

static inline void dense_multiply(size_t n, dense_square a, dense_square b, bool turned,
                                  dense_square to)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            to[i][j] = 0;
            for (size_t k = 0; k < n; k++)
                to[i][j] += a[i][k] * (turned ? b[j][k] : b[k][j]);
        }
}

/* p <- a p a' */
static inline void dense_carry(size_t n, dense_square a, dense_square p)
{
    static dense_square half;
    dense_multiply(n, a, p, false, half);
    dense_multiply(n, half, a, true, p);
}

/* Gauss and Jordan. */
static inline void dense_inverse(size_t n, dense_square a, dense_square to)
{
    static dense_square work;
    memcpy(work, a, sizeof work);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            to[i][j] = i == j;
    for (size_t p = 0; p < n; p++) {
        size_t largest = p;
        for (size_t i = p + 1; i < n; i++)
            largest = fabs(work[i][p]) > fabs(work[largest][p]) ? i : largest;
        for (size_t j = 0; j < n; j++) {
            double w = work[p][j], t = to[p][j];
            work[p][j] = work[largest][j];
            work[largest][j] = w;
            to[p][j] = to[largest][j];
            to[largest][j] = t;
        }
        double scale = 1 / work[p][p];
        for (size_t j = 0; j < n; j++) {
            work[p][j] *= scale;
            to[p][j] *= scale;
        }
        for (size_t i = 0; i < n; i++) {
            double part = work[i][p];
            if (i == p)
                continue;
            for (size_t j = 0; j < n; j++) {
                work[i][j] -= part * work[p][j];
                to[i][j] -= part * to[p][j];
            }
        }
    }
}

/* The inverse of a diagonal block; notes the condition of its correlations, by the sum of squares of what scales them to 1. */
static inline void dense_block_inverse(struct dense_band *d, dense_square s, size_t stage,
                                       dense_square to)
{
    static dense_square block;
    size_t m = d->m, at = stage * m;
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++)
            block[i][j] = s[at + i][at + j];
    dense_inverse(m, block, to);
    for (size_t i = 0; i < m; i++)
        d->condition = fmax(d->condition, to[i][i] * block[i][i]);
}

/* Blocks beyond the neighbours. */
static inline void dense_complete(struct dense_band *d, dense_square s)
{
    static dense_square inverse;
    size_t m = d->m;
    if (d->whole)
        return;
    for (size_t u = 2; u < d->stages; u++) {
        dense_block_inverse(d, s, u - 1, inverse);
        for (size_t row = 0; row < (u - 1) * m; row++)
            for (size_t j = 0; j < m; j++) {
                double sum = 0;
                for (size_t k = 0; k < m; k++)
                    for (size_t l = 0; l < m; l++)
                        sum +=
                            s[row][(u - 1) * m + k] * inverse[k][l] * s[(u - 1) * m + l][u * m + j];
                s[row][u * m + j] = s[u * m + j][row] = sum;
            }
    }
}

/* p into s and what extras say; and back. */
static inline void dense_split(const struct dense_band *d, dense_square s, dense_square by)
{
    static dense_square t, inverse;
    size_t n = d->n, q = d->q;
    for (size_t e = 0; e < q; e++)
        for (size_t f = 0; f < q; f++)
            t[e][f] = d->p[n + e][n + f];
    dense_inverse(q, t, inverse);
    for (size_t i = 0; i < n; i++)
        for (size_t e = 0; e < q; e++) {
            by[i][e] = 0;
            for (size_t f = 0; f < q; f++)
                by[i][e] += d->p[i][n + f] * inverse[f][e];
        }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            s[i][j] = d->p[i][j];
            for (size_t e = 0; e < q; e++)
                s[i][j] -= by[i][e] * d->p[n + e][j];
        }
}

static inline void dense_join(struct dense_band *d, dense_square s, dense_square by)
{
    size_t n = d->n, q = d->q;
    for (size_t i = 0; i < n; i++) {
        for (size_t e = 0; e < q; e++) {
            d->p[i][n + e] = 0;
            for (size_t f = 0; f < q; f++)
                d->p[i][n + e] += by[i][f] * d->p[n + f][n + e];
            d->p[n + e][i] = d->p[i][n + e];
        }
    }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            d->p[i][j] = s[i][j];
            for (size_t e = 0; e < q; e++)
                d->p[i][j] += by[i][e] * d->p[n + e][j];
        }
}

static inline void dense_forget(struct dense_band *d)
{
    static dense_square s, by;
    if (d->whole)
        return;
    dense_split(d, s, by);
    dense_complete(d, s);
    dense_join(d, s, by);
}

/* Makes the matrices of the sweep down and of the one up. */
static inline void dense_sweeps(const struct column_transition *t, dense_square down,
                                dense_square up)
{
    size_t m = t->m, n = t->stages * m;
    static double vapour[DENSE_MOST][DENSE_MOST];
    memset(down, 0, sizeof(dense_square));
    memset(up, 0, sizeof(dense_square));
    memset(vapour, 0, sizeof vapour);
    for (size_t s = t->stages; s-- > 0;) {
        const real_t *p = &t->factors[s * column_transition_stride(m)];
        for (size_t i = 0; i < m; i++)
            for (size_t k = 0; k < m; k++) {
                down[s * m + i][s * m + k] += (double)p[i * m + k];
                for (size_t j = 0; s + 1 < t->stages && j < n; j++)
                    down[s * m + i][j] +=
                        (double)p[i * m + k] * (double)p[3 * m * m] * down[(s + 1) * m + k][j];
            }
    }
    for (size_t s = 0; s < t->stages; s++) {
        const real_t *by = &t->factors[s * column_transition_stride(m)] + m * m, *g = by + m * m;
        for (size_t i = 0; i < m; i++) {
            up[s * m + i][s * m + i] = 1;
            for (size_t k = 0; k < m; k++)
                for (size_t j = 0; j < n; j++)
                    up[s * m + i][j] += (double)by[i * m + k] * vapour[k][j];
        }
        for (size_t i = 0; i < m; i++)
            for (size_t j = 0; j < n; j++) {
                vapour[i][j] *= (double)g[m * m + 1];
                for (size_t k = 0; k < m; k++)
                    vapour[i][j] += (double)g[i * m + k] * up[s * m + k][j];
            }
    }
}

static inline void dense_step_of(struct dense_band *d, const struct covariance_step *step)
{
    static dense_square down, up, by, s, a;
    size_t n = d->n, q = d->q, all = n + q;
    for (size_t k = 0; k < step->noise_count; k++) {
        size_t i = (step->noise_first + k) % n;
        d->p[i][i] += (double)step->noise[i];
    }
    dense_forget(d);
    for (size_t i = 0; i < all; i++)
        for (size_t j = 0; j < all; j++)
            a[i][j] = i == j            ? i < n ? 1 : (double)step->keep[i - n]
                                 : i < n && j >= n ? (double)step->push[(j - n) * n + i]
                                        : 0;
    dense_carry(all, a, d->p);
    for (size_t e = 0; e < q; e++)
        d->p[n + e][n + e] += (double)step->grown[e];
    dense_forget(d);
    dense_sweeps(step->transition, down, up);
    for (size_t i = 0; i < all; i++)
        for (size_t j = 0; j < all; j++)
            if (i >= n || j >= n)
                down[i][j] = up[i][j] = i == j;
    dense_carry(all, down, d->p);
    dense_forget(d);
    dense_carry(all, up, d->p);
    dense_split(d, s, by);
    for (size_t i = 0; i < n; i++)
        d->p[i][i] += s[i][i] * ((double)COVARIANCE_BAND_GROWTH - 1);
    dense_forget(d);
}

static inline void dense_slopes(const struct dense_band *d, const struct covariance_measurement *z,
                                double *h)
{
    for (size_t i = 0; i < d->n + d->q; i++)
        h[i] = 0;
    for (size_t i = 0; i < z->count; i++)
        h[z->first + i] = (double)z->slope[i];
    if (z->extra < d->q)
        h[d->n + z->extra] = (double)z->extra_slope;
}

static inline double dense_of(const struct dense_band *d, const struct covariance_measurement *z)
{
    double h[DENSE_MOST], sum = 0;
    dense_slopes(d, z, h);
    for (size_t i = 0; i < d->n + d->q; i++)
        for (size_t j = 0; j < d->n + d->q; j++)
            sum += h[i] * d->p[i][j] * h[j];
    return sum;
}

static inline double dense_take(struct dense_band *d, const struct covariance_measurement *z,
                                double *gain)
{
    double h[DENSE_MOST], alpha = dense_of(d, z) + (double)z->variance;
    size_t all = d->n + d->q;
    dense_slopes(d, z, h);
    for (size_t i = 0; i < all; i++) {
        gain[i] = 0;
        for (size_t j = 0; j < all; j++)
            gain[i] += d->p[i][j] * h[j] / alpha;
    }
    for (size_t i = 0; i < all; i++)
        for (size_t j = 0; j < all; j++)
            d->p[i][j] -= gain[i] * gain[j] * alpha;
    return alpha;
}

static inline void dense_begin(struct dense_band *d, size_t stages, size_t m, size_t q,
                               const real_t *variance, bool whole)
{
    memset(d, 0, sizeof *d);
    d->stages = stages;
    d->m = m;
    d->n = stages * m;
    d->q = q;
    d->whole = whole;
    d->condition = 1;
    for (size_t i = 0; i < d->n + q; i++)
        d->p[i][i] = (double)variance[i];
}

#endif
