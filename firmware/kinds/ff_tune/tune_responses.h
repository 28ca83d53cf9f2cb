/* Frequency responses of a block of the kind `ff_tune`, on a grid of frequencies: what the estimator says of the loop and of the disturbance,
 * the ratio Gd/Gp and the process from them, and the band in which a feedforward helps. */
#ifndef REFLUX_FF_TUNE_TUNE_RESPONSES_H
#define REFLUX_FF_TUNE_TUNE_RESPONSES_H

#include "kinds/ff_tune/tune_results.h"
#include "kinds/ff_tune/tune_settings.h"
#include "kinds/ff_tune/tune_stage.h"

struct tune_responses;

/* Makes the grid: from the band that is set, or wide. */
void tune_responses_grid(struct tune_responses *r, const struct tune_context *c);
/* The estimator has begun anew: no look has found the responses settled. */
void tune_responses_begin(struct tune_responses *r);
void tune_responses_unsettle(struct tune_responses *r);

/* A look at the responses, a point at a time: from 0 to band->points - 1. Errors as high_order_response(). */
void tune_responses_look(struct tune_responses *r);
MUST_CHECK enum err tune_responses_point(struct tune_responses *r, const struct tune_context *c,
                                         const struct high_order *estimator, unsigned i,
                                         bool of_loop);
void tune_responses_looked(struct tune_responses *r);
/* Counts a look that is over. Returns true when enough of them in a row have found no change. */
bool tune_responses_settled(struct tune_responses *r, const struct tune_context *c);
/* Change of the response from one look to the next, over its size. */
real_t tune_responses_change(const struct tune_responses *r);

/* Finds ratio, process and band from the responses; or a verdict why there are none. */
enum tune_verdict tune_responses_ratio(struct tune_responses *r, const struct tune_context *c);
const struct tune_band *tune_responses_band(const struct tune_responses *r);

#endif
