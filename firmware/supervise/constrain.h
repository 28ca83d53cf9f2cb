/* The last step forwards: limits, rates, interlocks and the safe state decide the values for the plant. Within
 * supervise only. */
#ifndef REFLUX_SUPERVISE_CONSTRAIN_H
#define REFLUX_SUPERVISE_CONSTRAIN_H

#include "exchange/state.h"

/* Turns mv_state.commanded of every output into constrained and applied. */
void constrain_mvs(struct supervisor *s);

/* Returns applied less commanded, both without the test signal; 0 where no limit, rate, interlock or valve stands
 * between. */
num_t mv_shortfall(const struct mv_state *o);

/* Returns true if an interlock will hold MV j from this tick on. Call it before constrain_mvs(). */
bool interlock_begins(const struct supervisor *s, uint8_t j);

#endif
