/* The rows of sequences, in a configuration and in a plan. */
#ifndef REFLUX_EXCHANGE_SEQUENCE_ROWS_H
#define REFLUX_EXCHANGE_SEQUENCE_ROWS_H

#include "exchange/plan.h"

#if CONFIG_STEPS
/* First row of a sequence after row `after` (-1: from the start), or PLAN_NONE. */
uint8_t sequence_next(const struct config *config, enum sequence_kind kind, int after);

/* Would this plan disturb a sequence that runs under the old one: other rows, or channels elsewhere? */
bool sequence_differs(const struct plan *plan, const struct plan *old);
#endif

#endif
