/* Alarms on events of blocks. Within supervise only. */
#ifndef REFLUX_SUPERVISE_ALARMS_OF_BLOCKS_H
#define REFLUX_SUPERVISE_ALARMS_OF_BLOCKS_H

#include "exchange/state.h"

/* Keeps the value of the k-th event of block n, which holds in its step. */
void alarms_hear(struct supervisor *s, uint8_t n, uint8_t k, float value);
/* Return true if entry i is on an event of a block; the value of this event when it was last raised; and true if it
 * holds. alarms_of_blocks.c */
static inline bool alarm_is_of_block(const struct supervisor *s, uint8_t i)
{
    return CONFIG_BLOCKS && (s->plan->alarm[i] & ALARM_OF_BLOCK);
}
float alarm_event_value(const struct supervisor *s, uint8_t i);
bool alarm_event_is_raised(const struct supervisor *s, uint8_t of_event);

#endif
