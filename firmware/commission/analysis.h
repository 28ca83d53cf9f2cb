/* From the elements of a plant to a set of loops: gains, pairing, structure, decoupler, settings, and what a step will
 * look like. One after the other in pieces, for a background job. docs/commissioning.md says what each decides. */
#ifndef REFLUX_COMMISSION_ANALYSIS_H
#define REFLUX_COMMISSION_ANALYSIS_H

#include "commission/analysis_state.h"

/* a->plant is filled in by the caller before. ERR_RANGE, ERR_NOT_FINITE: plant or config. */
MUST_CHECK enum err analysis_begin(struct analysis *a, const struct analysis_config *config);
/* ERR_BUSY until everything is done; anything else than ERR_OK then is a fault in the plant's numbers. */
MUST_CHECK enum err analysis_step(struct analysis *a);

/* A result without an analysis: one loop with these settings, and what is predicted of its setpoint step. */
void analysis_single_loop(struct analysis *a, const struct tuning *tuning, real_t step,
                          const struct trial_loop *predicted, real_t horizon_s);

#endif
