/* The rows of sequences, in a configuration and in a plan; words for how one goes; what a row looks at. */
#ifndef REFLUX_EXCHANGE_SEQUENCE_ROWS_H
#define REFLUX_EXCHANGE_SEQUENCE_ROWS_H

#include "exchange/state.h"

/* First row of a sequence after row `after` (-1: from the start), or PLAN_NONE. */
uint8_t sequence_next(const struct config *config, enum sequence_kind kind, int after);

/* Would this plan disturb a sequence that runs under the old one: other rows, or channels elsewhere? */
bool sequence_differs(const struct plan *plan, const struct plan *old);

/* What a condition or guard looks at, EU. False: nothing that is valid now. */
bool sequence_reading(const struct supervisor *s, uint8_t measurement, float *value);
/* "held", "start", "time-out". */
const char *sequence_state_text(uint8_t state);
const char *sequence_kind_text(uint8_t kind);
const char *sequence_reason_text(uint8_t reason);

#endif
