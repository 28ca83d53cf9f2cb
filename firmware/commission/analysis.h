/* From the elements of a plant to a set of loops: gains, pairing, structure, decoupler, settings, and the prediction of setpoint
 * steps. Each stage runs in pieces. docs/use/commission.md describes the decisions. Main loop. */
#ifndef REFLUX_COMMISSION_ANALYSIS_H
#define REFLUX_COMMISSION_ANALYSIS_H

#include "commission/analysis_state.h"

/* The caller has filled in a->plant. ERR_RANGE, ERR_NOT_FINITE: plant or config. */
MUST_CHECK enum err analysis_begin(struct analysis *a, const struct analysis_config *config);
/* ERR_BUSY until everything is done; any other error is a fault in the plant's numbers. */
MUST_CHECK enum err analysis_step(struct analysis *a);

#endif
