/* Actions of the rows of a sequence. Within supervise only. */
#ifndef REFLUX_SUPERVISE_SEQUENCE_ACT_H
#define REFLUX_SUPERVISE_SEQUENCE_ACT_H

#include "exchange/state.h"

/* Does the action of row k. Returns false if that is not possible now. */
bool sequence_act(struct supervisor *s, uint8_t k);
/* Switches the offset of measurement i on or off. Its value moves at once, and the loops on it take over without a
 * bump. */
void measurement_offset(struct supervisor *s, uint8_t i, bool on);

#endif
