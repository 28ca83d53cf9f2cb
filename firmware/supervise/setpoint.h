/* The setpoint of a loop. Within supervise only; i is the index of a loop of the plan in force. */
#ifndef REFLUX_SUPERVISE_SETPOINT_H
#define REFLUX_SUPERVISE_SETPOINT_H

#include "exchange/state.h"

/* Within the limits in force, fraction of span. */
num_t setpoint_clamp(const struct supervisor *s, uint8_t i, num_t setpoint);
/* What an outer loop finds that is to drive it: where it goes on without a bump. */
num_t setpoint_found(const struct supervisor *s, uint8_t i);
/* The loop's turn, in auto or cascade: the next value of ramp and filter, or what the outer loop gives. */
void setpoint_advance(struct supervisor *s, uint8_t i);
/* In manual. */
void setpoint_idle(struct supervisor *s, uint8_t i);
/* That with which the loop leaves manual, for its mode. */
void setpoint_start(struct supervisor *s, uint8_t i);
/* Ramp and filter are at rest there. */
void setpoint_rest(struct loop_state *l, num_t at);
/* In cascade, in the loop's turn: takes what the outer loop gives. */
void setpoint_from_outer(struct supervisor *s, uint8_t i);
#if CONFIG_BLOCKS
/* What loop i makes of a setpoint that its outer loop gives: within its limits, and near the last good one while the outer loop
 * acts on an estimate that is not good. */
num_t setpoint_taken(const struct supervisor *s, uint8_t i, num_t given);
/* An outer loop that acts and has lost its estimate gives the setpoint to return to. It is put into manual next, and stays with that. */
void setpoint_return(struct supervisor *s, uint8_t outer);
#else
#define setpoint_taken(s, i, given) setpoint_clamp(s, i, given)
#define setpoint_return(s, outer)   ((void)(s), (void)(outer))
#endif

#endif
