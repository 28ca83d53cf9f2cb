/* Back-calculation: from what was applied to the controllers. Within supervise only. */
#ifndef REFLUX_SUPERVISE_BACK_CALCULATE_H
#define REFLUX_SUPERVISE_BACK_CALCULATE_H

#include "exchange/state.h"

/* Every controller is told what took effect of its output; those that do not act follow it. */
void back_calculate_loops(struct supervisor *s);

#endif
