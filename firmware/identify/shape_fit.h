/* Least squares fits of four formulas to one output of a record, and the choice among them: one lag, two lags or a damped
 * element, the same with a zero of either sign, an integrator with a lag. It begins from the one lag that fopdt_fit.h has found
 * on the same record and with the same baseline; a drift that turns must have been taken off the record before.
 *
 * A point of the record is a mean of samples, and so is the model's. shape_search.h says how a formula is fitted,
 * shape_choice.h how one is chosen, shape_found.h what is kept.
 *
 * Works in pieces for a background job: shape_fit_begin() copies what it needs (in the tick, or where no tick can come
 * between), shape_fit_run() does a bounded amount at a time on its own memory. */
#ifndef REFLUX_IDENTIFY_SHAPE_FIT_H
#define REFLUX_IDENTIFY_SHAPE_FIT_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "identify/fopdt_fit.h"
#include "identify/record.h"
#include "identify/shape_fit_state.h"
#include "identify/shape_found.h"

/* options: as of the fit of one lag (baseline, free_offset, free_slope, time_max_s; start is not looked at); NULL for a free
 * offset and slope. Take the baseline from before the test: a line through the means before and after it would use the end
 * of the record twice. one: result of that fit. ERR_EMPTY: fewer than SHAPE_FIT_POINTS_MIN points, or none after the first
 * edge; ERR_RANGE (no such output, an option, options->bent, an input of less than 1e-6 or more than 1e6); ERR_NOT_FINITE.
 * After an error *f is not to be run. */
#define SHAPE_FIT_POINTS_MIN 16
MUST_CHECK enum err shape_fit_begin(struct shape_fit *f, const struct record *r, uint32_t output,
                                    const struct fopdt_fit_options *options,
                                    const struct fopdt_fit_result *one);

/* Goes on for units evaluations of a model over the record (the last stage takes one more); true when it is finished. An
 * evaluation of a full record with 12 edges takes about 5e4 instructions. Finished after SHAPE_FIT_UNITS_MAX. */
#define SHAPE_FIT_UNITS_MAX 1320
bool shape_fit_run(struct shape_fit *f, uint32_t units);

/* ERR_STATE while it is not finished. */
MUST_CHECK enum err shape_fit_result(const struct shape_fit *f, struct shape_found *found);

#endif
