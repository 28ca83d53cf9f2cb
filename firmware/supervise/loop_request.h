/* Mode, setpoint and output of a loop, or of a manipulated variable without one, as asked. Within supervise only. */
#ifndef REFLUX_SUPERVISE_LOOP_REQUEST_H
#define REFLUX_SUPERVISE_LOOP_REQUEST_H

#include "exchange/state.h"

/* REQUEST_MODE, REQUEST_SETPOINT, REQUEST_OUTPUT under the plan in force. Whether it is now as asked; an event says so too. */
bool loop_request(struct supervisor *s, const struct request *r);

#endif
