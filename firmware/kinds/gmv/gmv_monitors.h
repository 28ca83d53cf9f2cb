/* Monitors of the law: gains, swings of MV and PV, the PI's record, an MV stuck at a limit. In tuning they keep the PI's record. */
#ifndef REFLUX_GMV_GMV_MONITORS_H
#define REFLUX_GMV_GMV_MONITORS_H

#include "kinds/gmv/gmv_watched.h"

struct gmv_monitors;

/* The controller changes: PI to law or back. */
void gmv_monitors_begin(struct gmv_monitors *m);
/* Takes a step of the PIs. */
void gmv_monitors_keep_record(struct gmv_monitors *m, const struct gmv_supervise_config *c,
                              const struct gmv_observation *seen);
/* Takes a step of the law. Returns the alarm that sends it back to the PI, with the value that raised it. */
enum gmv_alarm gmv_monitors_step(struct gmv_monitors *m, const struct gmv_supervise_config *c,
                                 const struct gmv_observation *seen,
                                 const struct gmv_result *result, float *value);
/* Returns whether loop i's g_ii,0 may have this value: its sign, and not too small. */
bool gmv_gain_allowed(const struct gmv_supervise_config *c, unsigned i, float gain);
/* Returns whether the g_ii,0 of all loops that act are allowed. */
bool gmv_monitors_gains(const struct gmv_supervise_config *c, const struct gmv_result *result,
                        uint8_t acting);
/* Returns whether no setpoint of a loop that acts has moved within the regressors' reach. */
bool gmv_monitors_setpoints_rest(const struct gmv_monitors *m, const struct gmv_supervise_config *c,
                                 uint8_t acting);

#endif
