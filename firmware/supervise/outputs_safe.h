/* The lower half of the safe state: loops and outputs, not what runs above them. Within supervise only. */
#ifndef REFLUX_SUPERVISE_OUTPUTS_SAFE_H
#define REFLUX_SUPERVISE_OUTPUTS_SAFE_H

#include "exchange/state.h"

/* All loops manual, all outputs at their safe values. reason: kept for whoever asks later. */
void outputs_take_safe(struct supervisor *s, const char *reason);

#endif
