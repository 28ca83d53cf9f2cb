/* Least squares fit of K, T and L of one output to a record, with offset and drift slope: the second opinion to the
 * moments, and the one that knows how sure it is.
 *
 * K, offset and slope are linear and solved for at every trial (variable projection, Golub and Pereyra 1973, with
 * Kaufman's simplification 1975); T and L are searched on a bounded grid, then by Levenberg-Marquardt steps. A point of
 * the record is a mean of samples, and so is the model's: whatever the block, a noise-free first-order record is met to
 * rounding. Residuals that hang together count for less: covariances are multiplied by (1 + r)/(1 - r), r the lag-one
 * correlation of the residuals (as many independent observations as n (1 - r)/(1 + r)).
 *
 * Works in pieces for a background job: fopdt_fit_begin() copies what it needs of the record (in the tick, or where no
 * tick can come between), fopdt_fit_run() does a bounded amount at a time on its own memory.
 */
#ifndef REFLUX_IDENTIFY_FOPDT_FIT_H
#define REFLUX_IDENTIFY_FOPDT_FIT_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "identify/excitation.h"
#include "identify/fit_bend.h"
#include "identify/fit_line.h"
#include "identify/identified.h"
#include "identify/record.h"
#include "num/real.h"

#define FOPDT_FIT_PLACES     11 /* where a bend is tried; none is the first */
#define FOPDT_FIT_POINTS_MIN 12 /* fewer points are refused */

struct fopdt_fit_options {
    /* What is known of offset (against the record's reference, time from sample 0) and drift. Each is estimated with
     * this as one more observation; a standard deviation of 0 means that it is exactly so. One step alone cannot tell
     * a drift from a slow response: let steady.h measure the drift before it. noise_sd (of one sample), when above 0,
     * is the least the residuals are taken to have. */
    struct baseline baseline;
    bool free_offset, free_slope; /* nothing is known of it: baseline's is not looked at */
    bool
        bent; /* the drift turns once, nobody knows when: baseline's is the line before (fit_bend.h) */
    real_t
        time_max_s; /* largest L + T looked for; 0: 4 times the time from the first edge to the end */
    const struct identified
        *start; /* another place to begin from, such as the moments' answer; NULL: the grid alone */
};

struct fopdt_fit_result {
    struct identified element;  /* NO_GAIN: the gain is that of a plain proportion, T and L are 0 */
    real_t covariance[6];       /* KK KT TT KL TL LL, seconds for the times */
    real_t offset, slope_per_s; /* against the record's reference, time from sample 0 */
    real_t bend_at_s, bend_per_s,
        bend_step;      /* when the drift turned, how much steeper it is then, how much higher */
    real_t squares;     /* sum that is left, of points and of what was known beforehand */
    real_t residual_sd; /* of one point */
    real_t
        misfit; /* of a point: what is left beyond the noise, since the plant is not of first order */
    real_t correlation; /* lag one, of the residuals */
    real_t
        significance; /* of the response: what it explains over what one point of noise has; 16 is the least */
    real_t
        plateau_gain; /* from the settled ends of the levels alone; 0 with sd 0: no two levels settled, or a bend */
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

/* options: NULL for free offset and slope, no start. ERR_EMPTY: fewer than FOPDT_FIT_POINTS_MIN points, or none after
 * the first edge; ERR_RANGE (no such output, an option, an input of less than 1e-6 or more than 1e6), ERR_NOT_FINITE. */
MUST_CHECK enum err fopdt_fit_begin(struct fopdt_fit *f, const struct record *r, uint32_t output,
                                    const struct fopdt_fit_options *options);

/* Goes on for units evaluations of the model over the record (each some 10 products a point and edge, and 5 exponentials
 * an edge; a stage once begun is ended, at most 3 more); true when it is finished. Finished after FOPDT_FIT_UNITS_MAX. */
#define FOPDT_FIT_UNITS_MAX 500
bool fopdt_fit_run(struct fopdt_fit *f, uint32_t units);

/* ERR_STATE while it is not finished. */
MUST_CHECK enum err fopdt_fit_result(const struct fopdt_fit *f, struct fopdt_fit_result *result);

/* The parts of fopdt_fit_run() that judge (fopdt_judge.c): covariance, significance, flags, plateau. */
void fopdt_fit_judge(struct fopdt_fit *f);
/* Line and bend out of a column. */
void fopdt_fit_take_out(const struct fopdt_fit *f, real_t *column);

#endif
