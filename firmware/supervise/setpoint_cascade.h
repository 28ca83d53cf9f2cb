/* The setpoint that an outer loop gives. Within supervise only. */
#ifndef REFLUX_SUPERVISE_SETPOINT_CASCADE_H
#define REFLUX_SUPERVISE_SETPOINT_CASCADE_H

#include "exchange/state.h"
#include "supervise/setpoint_limits.h"

/* In cascade, in the loop's turn: takes the setpoint that the outer loop gives. */
void setpoint_from_outer(struct supervisor *s, uint8_t i);
#if CONFIG_BLOCKS
/* Returns the setpoint that loop i takes of the one its outer loop gives: within its limits, and near the last good
 * one while the outer loop acts on an estimate that is not good. */
num_t setpoint_taken(const struct supervisor *s, uint8_t i, num_t given);
/* Makes an outer loop that acts and has lost its estimate give the setpoint to return to. The outer loop goes to
 * manual next, and keeps that output. */
void setpoint_return(struct supervisor *s, uint8_t outer);
#else
#define setpoint_taken(s, i, given) setpoint_clamp(s, i, given)
#define setpoint_return(s, outer)   ((void)(s), (void)(outer))
#endif

#endif
