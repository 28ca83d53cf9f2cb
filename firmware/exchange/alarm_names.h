/* Names of alarms, and words for the faults of readings. */
#ifndef REFLUX_EXCHANGE_ALARM_NAMES_H
#define REFLUX_EXCHANGE_ALARM_NAMES_H

#include "exchange/state.h"

/* Writes the name of entry i: "T10.hi_hi", "bottom.dev", "block2.drift". The name of its subject is cut where it
 * does not fit. */
void alarm_name(const struct config *config, uint8_t i, char name[CHANNEL_NAME_SIZE]);
/* Returns the entry with that name, or with the name "alarm3" and the like, or PLAN_NONE. */
uint8_t alarm_find(const struct config *config, const char *name);

/* Returns the words for an enum measurement_fault, such as "not a number". */
const char *measurement_fault_text(uint8_t fault);

#endif
