/* Alarms: limits of measurements, distances from setpoints and what blocks say, with hysteresis, delay, latching,
 * acknowledgement, shelving, and a mark on the first of a group.
 *
 * Life of an entry
 *     off -> (condition holds for delay) -> on, not acknowledged -> acknowledged -> (condition over) -> off
 *     latch on:  condition over before it was acknowledged: stays on the list until it is
 *     shelved:   silent for a time of the plant's; what holds then comes on anew
 *
 * A measurement without a valid reading changes nothing: that it is bad is another alarm. Besides the entries, every loop that acts has
 * the alarm on its deviation that the group `deviation` of the parameters sets.
 */
#ifndef REFLUX_SUPERVISE_ALARMS_H
#define REFLUX_SUPERVISE_ALARMS_H

#include "exchange/state.h"

/* After control: looks at every entry. */
void alarms_run(struct supervisor *s);
/* REQUEST_ACK, REQUEST_SHELVE. */
void alarms_request(struct supervisor *s, const struct request *r);
/* Plant time has been set back: delays and shelves begin anew. */
void alarms_time_back(struct supervisor *s);
/* Entry i under a new plan. */
void alarms_place(struct supervisor *s, const struct plan *old, uint8_t i);

#endif
