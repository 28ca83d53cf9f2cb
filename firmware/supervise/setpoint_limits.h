/* A setpoint within its limits, and at rest. Within supervise only. */
#ifndef REFLUX_SUPERVISE_SETPOINT_LIMITS_H
#define REFLUX_SUPERVISE_SETPOINT_LIMITS_H

#include "exchange/state.h"

/* Within the limits in force, fraction of span. */
num_t setpoint_clamp(const struct supervisor *s, uint8_t i, num_t setpoint);
/* Ramp and filter are at rest there. */
void setpoint_rest(struct loop_state *l, num_t at);

#endif
