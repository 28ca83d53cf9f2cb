/* How far outputs may go, as the setups of blocks need it. */
#ifndef REFLUX_EXCHANGE_REACH_H
#define REFLUX_EXCHANGE_REACH_H

#include "exchange/plan.h"

/* Returns the largest |MV - feedforward| of the MV of loop i, fraction of span. */
float plan_own_reach(const struct plan *plan, uint8_t i);

/* Returns the largest value that feedforward elements with a number (blockN) add to an MV, either way, fraction of
 * span. */
float plan_added_reach(const struct plan *plan, uint8_t output);
/* Returns the largest |MV - feedforward| of the MV of loop i behind compensator n, fraction of span. */
float plan_member_reach(const struct plan *plan, uint8_t n, uint8_t i);

#endif
