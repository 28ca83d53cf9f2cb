/* Back-calculation: from the applied MVs back to the controllers. Within supervise only. */
#ifndef REFLUX_SUPERVISE_BACK_CALCULATE_H
#define REFLUX_SUPERVISE_BACK_CALCULATE_H

#include "exchange/state.h"

/* Tells every controller that acts what took effect of its output; the others follow it. */
void back_calculate_loops(struct supervisor *s);

#endif
