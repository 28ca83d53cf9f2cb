/* Least squares fit of K, T and L of one output to a record, with offset and drift slope: the second opinion to the
 * moments, and the one that knows how sure it is.
 *
 * K, offset and slope are linear and solved for at every trial (variable projection, Golub and Pereyra 1973); T and L
 * are searched on a bounded grid, then by Levenberg-Marquardt steps. A point of the record is a mean of samples, and so
 * is the model's: whatever the block, a noise-free first-order record is met to rounding. Residuals that hang
 * together count for less: covariances are multiplied by (1 + r)/(1 - r), r the lag-one correlation of the residuals.
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
#include "identify/identified.h"
#include "identify/record.h"
#include "num/real.h"

#define FOPDT_FIT_POINTS_MIN 12 /* fewer points are refused */

struct fopdt_fit_options {
    bool fit_offset; /* estimate the offset; else baseline.offset is taken as it is */
    bool
        fit_slope; /* estimate the drift; else baseline.slope_per_s. One step alone cannot tell a drift
                                    from a slow response: give it one that was measured before */
    struct baseline
        baseline; /* offset against the record's reference, time from sample 0. Its noise_sd, when above
                                    0, is a floor for the residuals' own. */
    real_t
        time_max_s; /* largest L + T looked for; 0: 4 times the time from the first edge to the end */
    const struct identified
        *start; /* another place to begin from, such as the moments' answer; NULL: the grid alone */
};

struct fopdt_fit_result {
    struct identified element;
    real_t covariance[6]; /* KK KT TT KL TL LL, seconds for the times */
    real_t offset, slope_per_s;
    real_t residual_sd; /* of one point */
    real_t correlation; /* lag one, of the residuals */
    real_t
        plateau_gain; /* from the settled ends of the levels alone, without T and L; 0 with sd 0: none settled */
    real_t plateau_gain_sd;
    real_t moved; /* largest response seen, output unit, either sign */
    uint32_t points;
    uint32_t evaluations;
};

struct fopdt_fit {
    /* copied by begin */
    struct excitation input;
    struct fopdt_fit_options options;
    real_t h_s;
    uint32_t block, points;
    /* state of the search; times in samples */
    uint8_t phase;
    uint32_t grid, tries, evaluations;
    real_t best_t, best_l, best_rss, damping, time_max;
    real_t basis_mean, basis_norm; /* of the projected-out line */
    real_t total;                  /* sum of squares without a response */
    struct fopdt_fit_result result;
    real_t y[RECORD_POINTS]; /* line projected out */
    real_t model[3][RECORD_POINTS];
};

/* ERR_EMPTY: fewer than FOPDT_FIT_POINTS_MIN points, or no edge in time to be seen; ERR_RANGE, ERR_NOT_FINITE: an option
 * or a point of the record. */
MUST_CHECK enum err fopdt_fit_begin(struct fopdt_fit *f, const struct record *r, uint32_t output,
                                    const struct fopdt_fit_options *options);

/* Goes on for at most units evaluations (each about points (edges + 3) products); true when it is finished. At most
 * FOPDT_FIT_UNITS_MAX in all. */
#define FOPDT_FIT_UNITS_MAX 200
bool fopdt_fit_run(struct fopdt_fit *f, uint32_t units);

/* ERR_STATE while it is not finished. */
MUST_CHECK enum err fopdt_fit_result(const struct fopdt_fit *f, struct fopdt_fit_result *result);

#endif
