/* The state of a fit and its result, for the search (fopdt_fit.h) and for the judge (fopdt_judge.h). */
#ifndef REFLUX_IDENTIFY_FOPDT_FIT_STATE_H
#define REFLUX_IDENTIFY_FOPDT_FIT_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "identify/excitation.h"
#include "identify/fit_bend.h"
#include "identify/fit_line.h"
#include "identify/identified.h"
#include "num/real.h"

#define FOPDT_FIT_PLACES     11 /* where a bend is tried; none is the first */
#define FOPDT_FIT_POINTS_MIN 12 /* fewer points are refused */

struct fopdt_fit_result {
    struct identified element;  /* NO_GAIN: the gain is that of a plain proportion, T and L are 0 */
    real_t covariance[6];       /* KK KT TT KL TL LL, seconds for the times */
    real_t offset, slope_per_s; /* against the record's reference, time from sample 0 */
    real_t bend_at_s, bend_per_s,
        bend_step;      /* when the drift turned, how much steeper it is then, how much higher */
    real_t squares;     /* sum that is left, of points and of what was known beforehand */
    real_t residual_sd; /* of one point */
    /* Error of a point beyond the noise, because the plant is not of first order. */
    real_t misfit;
    real_t correlation; /* lag one, of the residuals */
    /* Squares that the response explains over the variance of one point of noise; 16 is the least. */
    real_t significance;
    /* Gain from the settled ends of the levels alone; 0 with sd 0: no two levels settled, or a bend. */
    real_t plateau_gain;
    real_t plateau_gain_sd;
    real_t moved; /* largest response seen, output unit, either sign */
    uint32_t points;
    uint32_t evaluations;
};

struct fopdt_fit {
    /* copied by begin */
    struct excitation input;
    struct baseline baseline;
    real_t h_s;
    uint32_t block, points;
    /* the search; times in samples */
    struct fit_line line;
    struct fit_bend bend;
    real_t bend_part[2]; /* of y */
    uint8_t phase;
    bool bent; /* a bend is still to be found */
    uint32_t bend_place, bend_next, bend_last, bend_best;
    real_t bend_squares, bend_lag, bend_dead, straight_lag, straight_dead;
    real_t place_squares[FOPDT_FIT_PLACES], place_gain[FOPDT_FIT_PLACES]; /* left and found there */
    bool has_start;
    uint32_t next, tries, evaluations;
    real_t start_lag, start_dead, lag_max, dead_max, shortest;
    real_t lag, dead, squares;           /* best so far */
    real_t damping, normal[3], right[2]; /* of the Levenberg-Marquardt step, in ln T and L */
    real_t gain, strength,
        along[2]; /* of the best: gain, square of its model, gain lost per ln T and L */
    real_t total; /* sum of squares without a response */
    real_t line_offset, line_slope; /* taken out of y */
    struct fopdt_fit_result result;
    real_t y[FIT_LINE_SIZE];         /* without the line */
    real_t column[3][FIT_LINE_SIZE]; /* model, its derivatives */
};

#endif
