/* The safe state: loops in manual, outputs at their safe values, a sequence ended. */
#ifndef REFLUX_SUPERVISE_SAFE_STATE_H
#define REFLUX_SUPERVISE_SAFE_STATE_H

#include "exchange/state.h"

/* All loops manual, all outputs at their safe values, in the midst of a run. */
void supervisor_outputs_safe(struct supervisor *s, const char *reason);

/* Takes a safe state that something has ended once more, for the same reason. */
void supervisor_stay_safe(struct supervisor *s);

#endif
