/* Alarms on events of blocks. Within supervise only. */
#ifndef REFLUX_SUPERVISE_ALARMS_OF_BLOCKS_H
#define REFLUX_SUPERVISE_ALARMS_OF_BLOCKS_H

#include "exchange/state.h"

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
