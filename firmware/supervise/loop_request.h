/* Requests for the mode, setpoint and output of a loop, or for an MV without a loop. Within supervise only. */
#ifndef REFLUX_SUPERVISE_LOOP_REQUEST_H
#define REFLUX_SUPERVISE_LOOP_REQUEST_H

#include "exchange/state.h"

/* Carries out REQUEST_MODE, REQUEST_SETPOINT and REQUEST_OUTPUT under the plan in force. Returns true if the
 * request is fulfilled; an event says so too. */
bool loop_request(struct supervisor *s, const struct request *r);

#endif
