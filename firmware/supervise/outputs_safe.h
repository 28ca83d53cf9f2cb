/* The lower half of the safe state: loops and outputs, without sequences above them. Within supervise only. */
#ifndef REFLUX_SUPERVISE_OUTPUTS_SAFE_H
#define REFLUX_SUPERVISE_OUTPUTS_SAFE_H

#include "exchange/state.h"

/* Puts all loops into manual and all outputs to their safe values. reason: kept for later queries. */
void outputs_take_safe(struct supervisor *s, const char *reason);

#endif
