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
#include "identify/fopdt_fit_state.h"
#include "identify/identified.h"
#include "identify/record.h"
#include "num/real.h"

struct fopdt_fit_options {
    /* Prior knowledge of offset (against the record's reference, time from sample 0) and drift. Each is estimated with
     * this as one more observation; a standard deviation of 0 means that it is exactly so. One step alone cannot tell
     * a drift from a slow response: let steady.h measure the drift before it. noise_sd (of one sample), when above 0,
     * is the least the residuals are taken to have. */
    struct baseline baseline;
    bool free_offset, free_slope; /* nothing is known of it: baseline's is not looked at */
    /* The drift turns once, nobody knows when: baseline's is the line before (fit_bend.h). */
    bool bent;
    /* Largest L + T looked for; 0: 4 times the time from the first edge to the end. */
    real_t time_max_s;
    /* Another place to begin from, such as the moments' answer; NULL: the grid alone. */
    const struct identified *start;
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

#endif
