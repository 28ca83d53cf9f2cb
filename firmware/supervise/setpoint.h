/* The setpoint of a loop. Within supervise only; i is the index of a loop of the plan in force. */
#ifndef REFLUX_SUPERVISE_SETPOINT_H
#define REFLUX_SUPERVISE_SETPOINT_H

#include "exchange/state.h"

/* What an outer loop finds that is to drive it: where it goes on without a bump. */
num_t setpoint_found(const struct supervisor *s, uint8_t i);
/* The loop's turn, in auto or cascade: the next value of ramp and filter, or what the outer loop gives. */
void setpoint_advance(struct supervisor *s, uint8_t i);
/* In manual. */
void setpoint_idle(struct supervisor *s, uint8_t i);
/* That with which the loop leaves manual, for its mode. */
void setpoint_start(struct supervisor *s, uint8_t i);

#endif
