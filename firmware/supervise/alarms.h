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

/* The k-th event of block n holds in its step, with that value. */
void alarms_hear(struct supervisor *s, uint8_t n, uint8_t k, float value);
/* Entry i is on an event of a block: its value when it was last raised; whether it holds. alarms_of_blocks.c */
static inline bool alarm_is_of_block(const struct supervisor *s, uint8_t i)
{
    return CONFIG_BLOCKS && (s->plan->alarm[i] & ALARM_OF_BLOCK);
}
float alarm_event_value(const struct supervisor *s, uint8_t i);
bool alarm_event_is_raised(const struct supervisor *s, uint8_t of_event);

#endif
