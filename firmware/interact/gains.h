/* The gain matrix as a whole: singular values, condition numbers, and how many directions are there at all, given how
 * well the gains are known. */
#ifndef REFLUX_INTERACT_GAINS_H
#define REFLUX_INTERACT_GAINS_H

#include "interact/plant.h"
#include "num/svd.h"

struct gains {
    /* Results. k = min(outputs, inputs) singular values. */
    real_t singular[INTERACT_MAX]; /* of the gains in spans, largest first */
    real_t condition;              /* of them; infinite when numerically singular */
    /* Combination of inputs, in spans, unit length, that moves the outputs least: right singular vector of the smallest value. */
    real_t weakest[INTERACT_MAX];
    /* With rows and columns equilibrated: about the least over all scalings. */
    real_t condition_scaled;
    uint8_t rank;       /* directions that stand out of the gains' uncertainty */
    uint8_t rank_exact; /* the gains taken as exact: rounding only */
    /* Ratio of the smallest singular value to its standard deviation, noise-weighted; 0 where gain_sd is 0. */
    real_t smallest_in_sd;
    /* Work, and what the null vectors are read from. */
    struct svd svd;
    struct matrix k, sd, scaled;
    const struct interact_plant *plant;
    real_t floor;
    real_t row_scale[INTERACT_MAX], col_scale[INTERACT_MAX];
    uint8_t stage;
};

/* floor: relative standard deviation below which no gain is valid (a first-order model is not the plant), [0, 0.5];
 * added in quadrature to gain_sd. Then gains_step until it is not ERR_BUSY: one sweep of an SVD a call.
 *
 * Rank: rows and columns are weighted so that the gains' errors have about unit variance; the rank is the least r for
 * which the energy of the singular values past r is no more than noise would leave in so many directions: sum of s^2
 * below the 95 % point of chi-square with (p - r)(m - r) degrees of freedom (Wilson and Hilferty 1931); idea of the
 * test: Kleibergen and Paap, J. Econometrics 133 (2006) 97. Without errors (all 0): rank_exact. Rows that were measured along a
 * direction have smaller errors there (interact/direction.h). plant must live and stay as it is until the end. */
MUST_CHECK enum err gains_begin(struct gains *g, const struct interact_plant *plant, real_t floor);
MUST_CHECK enum err gains_step(struct gains *g);

/* Combination of inputs, unit length, that moves no output beyond the uncertainty: k-th of inputs - rank (k from 0).
 * ERR_RANGE past the last. gains_null_output: of outputs that no input moves. In spans. */
MUST_CHECK enum err gains_null_input(const struct gains *g, unsigned k, real_t *x);
MUST_CHECK enum err gains_null_output(const struct gains *g, unsigned k, real_t *y);

#endif
