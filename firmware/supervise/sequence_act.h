/* What a row of a sequence does. Within supervise only. */
#ifndef REFLUX_SUPERVISE_SEQUENCE_ACT_H
#define REFLUX_SUPERVISE_SEQUENCE_ACT_H

#include "exchange/state.h"

/* Does the action of row k. False: it could not be done. */
bool sequence_act(struct supervisor *s, uint8_t k);
/* Switches the offset of measurement i; its value moves at once, loops on it make room. */
void measurement_offset(struct supervisor *s, uint8_t i, bool on);

#endif
