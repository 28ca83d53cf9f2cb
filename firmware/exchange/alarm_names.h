/* Names of alarms, and words for the faults of readings. */
#ifndef REFLUX_EXCHANGE_ALARM_NAMES_H
#define REFLUX_EXCHANGE_ALARM_NAMES_H

#include "exchange/state.h"

/* "T10.hi_hi", "bottom.dev", "block2.drift"; what it is on is cut where that does not fit. */
void alarm_name(const struct config *config, uint8_t i, char name[CHANNEL_NAME_SIZE]);
/* By that name, or by "alarm3"; PLAN_NONE. */
uint8_t alarm_find(const struct config *config, const char *name);

/* "not a number", ... for enum measurement_fault. */
const char *measurement_fault_text(uint8_t fault);

#endif
