/* Estimates of blocks that stand in for a lost reading (meas.infer). Within supervise only. */
#ifndef REFLUX_SUPERVISE_ESTIMATES_H
#define REFLUX_SUPERVISE_ESTIMATES_H

#include "exchange/state.h"

/* Whether the measurement, which a block writes, was valid at the end of the last tick; with which value, EU. */
bool estimate_stands_in(const struct measurement_state *m, float *value);

#if CONFIG_BLOCKS
/* Before any measurement is validated: what estimates are at the end of the last tick, for those that they stand in for. */
void estimates_keep(struct supervisor *s);
#else
#define estimates_keep(s) ((void)(s))
#endif

#endif
