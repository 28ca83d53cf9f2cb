/* The setpoint of a loop. Within supervise only; i is the index of a loop of the plan in force. */
#ifndef REFLUX_SUPERVISE_SETPOINT_H
#define REFLUX_SUPERVISE_SETPOINT_H

#include "exchange/state.h"

/* Returns the output that an outer loop finds before it drives loop i: from there it continues without a bump. */
num_t setpoint_found(const struct supervisor *s, uint8_t i);
/* In the loop's turn, in auto or cascade: takes the next value of ramp and filter, or the setpoint of the outer
 * loop. */
void setpoint_advance(struct supervisor *s, uint8_t i);
/* In manual: keeps the setpoint ready for automatic. */
void setpoint_idle(struct supervisor *s, uint8_t i);
/* Sets the setpoint with which the loop leaves manual, for its mode. */
void setpoint_start(struct supervisor *s, uint8_t i);

#endif
