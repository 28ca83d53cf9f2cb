/* The safe state: loops in manual, outputs at their safe values, a sequence ended. */
#ifndef REFLUX_SUPERVISE_SAFE_STATE_H
#define REFLUX_SUPERVISE_SAFE_STATE_H

#include "exchange/state.h"

/* Puts all loops into manual and all outputs to their safe values, in the midst of a run. */
void supervisor_outputs_safe(struct supervisor *s, const char *reason);

/* Takes the safe state again, for the same reason, if something has ended it. */
void supervisor_stay_safe(struct supervisor *s);

#endif
