/* Setpoint limits, and a setpoint at rest. Within supervise only. */
#ifndef REFLUX_SUPERVISE_SETPOINT_LIMITS_H
#define REFLUX_SUPERVISE_SETPOINT_LIMITS_H

#include "exchange/state.h"

/* Returns the setpoint within the limits in force, fraction of span. */
num_t setpoint_clamp(const struct supervisor *s, uint8_t i, num_t setpoint);
/* Puts ramp and filter at rest at a setpoint. */
void setpoint_rest(struct loop_state *l, num_t at);

#endif
