/* How far outputs may go, as the setups of blocks say it. */
#ifndef REFLUX_EXCHANGE_REACH_H
#define REFLUX_EXCHANGE_REACH_H

#include "exchange/plan.h"

/* The largest |MV - feedforward| of the MV of loop i, fraction of span. */
float plan_own_reach(const struct plan *plan, uint8_t i);

/* The most that elements with a record add to an MV, either way. */
float plan_added_reach(const struct plan *plan, uint8_t output);
/* The largest |MV - feedforward| of the MV of loop i behind compensator n, fraction of span. */
float plan_member_reach(const struct plan *plan, uint8_t n, uint8_t i);

#endif
