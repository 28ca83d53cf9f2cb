/* The rows of sequences in a configuration and in a plan, words for the state of a sequence, and the readings that
 * rows look at. */
#ifndef REFLUX_EXCHANGE_SEQUENCE_ROWS_H
#define REFLUX_EXCHANGE_SEQUENCE_ROWS_H

#include "exchange/state.h"

/* Returns the first row of a sequence after row `after` (-1: from the start), or PLAN_NONE. */
uint8_t sequence_next(const struct config *config, enum sequence_kind kind, int after);

/* Returns true if the plan disturbs a sequence that runs under the old one: other rows, or loops and outputs in
 * other places. */
bool sequence_differs(const struct plan *plan, const struct plan *old);

/* Reads the value that a condition or guard looks at, EU. Returns false if it is not valid now. */
bool sequence_reading(const struct supervisor *s, uint8_t measurement, float *value);
/* Return the words for a state, a kind and a reason: "held", "start", "time-out". */
const char *sequence_state_text(uint8_t state);
const char *sequence_kind_text(uint8_t kind);
const char *sequence_reason_text(uint8_t reason);

#endif
