/* Alarms: limits of measurements, deviations from setpoints, and events of blocks, with hysteresis, delay,
 * latching, acknowledgement, shelving, and a mark on the first of a group.
 *
 * Life of an entry
 *     off -> (condition holds for delay) -> on, not acknowledged -> acknowledged -> (condition over) -> off
 *     latch on:  if the condition ends before it was acknowledged, it stays on the list until it is
 *     shelved:   silent for a span of plant time; if its condition holds then, it comes on anew
 *
 * A measurement without a valid reading changes nothing, because its loss is another alarm. Besides the entries,
 * every loop that acts has the deviation alarm that the group `deviation` of the parameters sets. */
#ifndef REFLUX_SUPERVISE_ALARMS_H
#define REFLUX_SUPERVISE_ALARMS_H

#include "exchange/state.h"

/* After control: runs every entry. */
void alarms_run(struct supervisor *s);
/* Carries out a REQUEST_ACK or REQUEST_SHELVE. */
void alarms_request(struct supervisor *s, const struct request *r);
/* Plant time has been set back: delays begin anew, and shelving ends. */
void alarms_time_back(struct supervisor *s);
/* Keeps or clears entry i under a new plan. */
void alarms_place(struct supervisor *s, const struct plan *old, uint8_t i);

#endif
