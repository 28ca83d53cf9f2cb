/* The alarms that every loop has while it acts. One comes if its PV has been far from its setpoint for long
 * (parameters deviation.width and deviation.delay); a loop with an alarm entry of side `dev` has that entry
 * instead. The other comes if its PV has been uncertain for longer than meas.hold. Within supervise only. */
#ifndef REFLUX_SUPERVISE_DEVIATIONS_H
#define REFLUX_SUPERVISE_DEVIATIONS_H

#include "exchange/state.h"

#if CONFIG_LOOP_GUARD
/* After control: runs the alarms. */
void deviations_run(struct supervisor *s);
/* Plant time has been set back: delays begin anew. */
void deviations_time_back(struct supervisor *s);
#else
static inline void deviations_run(struct supervisor *s)
{
    (void)s;
}
static inline void deviations_time_back(struct supervisor *s)
{
    (void)s;
}
#endif

#endif
