/* Bumpless transfer: a loop that acts from this tick on begins at the output it finds. Within supervise only. */
#ifndef REFLUX_SUPERVISE_TRANSFER_H
#define REFLUX_SUPERVISE_TRANSFER_H

#include "exchange/state.h"

/* Transfers loops before they run. before: the feedforward of the tick before, for each loop, fraction of span. */
void bumpless_transfer(struct supervisor *s, const num_t *before);

#endif
