/* Estimates of blocks that stand in for a lost reading (meas.infer). Within supervise only. */
#ifndef REFLUX_SUPERVISE_ESTIMATES_H
#define REFLUX_SUPERVISE_ESTIMATES_H

#include "exchange/state.h"

/* Returns true if the measurement, which a block writes, was valid at the end of the last tick; writes its value
 * then, EU. */
bool estimate_stands_in(const struct measurement_state *m, float *value);

#if CONFIG_BLOCKS
/* Before any measurement is validated: keeps the estimates as they are at the end of the last tick, for the
 * readings that they stand in for. */
void estimates_keep(struct supervisor *s);
#else
#define estimates_keep(s) ((void)(s))
#endif

#endif
