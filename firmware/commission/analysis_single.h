/* The result of a relay test in the form of an analysis. Tick. */
#ifndef REFLUX_COMMISSION_ANALYSIS_SINGLE_H
#define REFLUX_COMMISSION_ANALYSIS_SINGLE_H

#include "commission/analysis_state.h"

/* A result without an analysis: one loop with these settings, and what is predicted of its setpoint step. */
void analysis_single_loop(struct analysis *a, const struct tuning *tuning, real_t step,
                          const struct trial_loop *predicted, real_t horizon_s);

#endif
