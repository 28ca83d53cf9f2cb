/* The constant compensator with which an inverse Nyquist array is the most dominant at its worst frequency.
 *
 * With K = G^-1, H^-1 = K F^-1, so row i of H^-1 is row i of K times F^-1 and nothing else: by rows there is a problem of n numbers
 * for every row, the least over k of the largest over frequency of
 *     sum over j other than i of |k f_j(omega)| / |k f_i(omega)|,    f_j column j of F^-1.
 * By columns all rows matter at once, n^2 numbers. A maximum of ratios has kinks and more than one valley, so it is searched directly:
 * steps along the axes of a frame that is turned at random before every round (what reaches into the cone of descent of a kink
 * sooner or later), halved where none helps; from the given G, from pseudo-diagonalisation (D. J. Hawkins, Proc. IEE 119 (1972)
 * 337: least sum over frequencies of the squares off the diagonal for the square on it, an eigenvalue problem), and from random
 * places. The result is never worse than the given G. That it is the best there is, is not proved. */
#ifndef REFLUX_INTERACT_INA_SEARCH_H
#define REFLUX_INTERACT_INA_SEARCH_H

#include "interact/ina.h"
#include "num/random.h"

#define INA_POINTS_MOST 2000
#define INA_STARTS_MOST 50

struct ina_search_config {
    enum ina_by by;
    /* 1 to INA_STARTS_MOST: the given G, pseudo-diagonalisation, then random ones. */
    uint8_t starts;
    /* Largest relative gain of G, K .* (K^-1)' of all its elements: 1 to 1e6. Where nothing is dominant, rows of K that are nearly the
     * same would be the best by columns: ratios of 1, and a G next to singular. */
    real_t lambda_hi;
    uint64_t seed;
};

/* 9 KiB (float) and the caller's table. */
struct ina_search {
    /* Results: G by rows as ina_normalise leaves it; by columns, where the sizes of its columns count, with positive diagonal and its
     * largest element 1. */
    struct matrix g;
    real_t lambda; /* largest relative gain of G */
    /* Largest ratio over rows (columns) and frequencies, of the given G and of this one. */
    real_t before, after;
    real_t ratio[INA_MOST]; /* by rows: of each; by columns: all of them `after` */
    uint32_t looks;         /* how often a K was looked at */

    /* Work */
    const struct cplx *inverse;
    struct ina_search_config config;
    struct random random;
    struct lu lu;
    struct matrix k, a, b;
    real_t x[INA_MOST * INA_MOST], best[INA_MOST * INA_MOST], trial[INA_MOST * INA_MOST];
    real_t turn[INA_MOST * INA_MOST];
    real_t size, found, step; /* size: the ratio of best */
    uint16_t points, hardest, rounds;
    uint8_t n, row, start, idle, numbers, stage;
};

/* by rows, 8 starts, relative gains of G to 100, seed 1. */
void ina_search_config_default(struct ina_search_config *config);

/* inverse: F^-1 at `points` frequencies, 1 to INA_POINTS_MOST, each n x n row by row; it must live to the end. g: from where, n x n with
 * an inverse. ERR_RANGE, ERR_NOT_FINITE: config, table or g; ERR_SINGULAR: g. Then ina_search_step until it is not ERR_BUSY: a
 * round a call, at most 2 n (by columns 2 n^2) times n^2 points complex products. ERR_SINGULAR from a step: by rows, the best
 * rows found make a G past lambda_hi, or none; by columns, no start was within it. */
MUST_CHECK enum err ina_search_begin(struct ina_search *s, const struct cplx *inverse,
                                     uint16_t points, const struct matrix *g,
                                     const struct ina_search_config *config);
MUST_CHECK enum err ina_search_step(struct ina_search *s);

#endif
