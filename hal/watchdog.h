/* The independent watchdog: once started it cannot be stopped, and resets the board when not fed. */
#ifndef REFLUX_HAL_WATCHDOG_H
#define REFLUX_HAL_WATCHDOG_H

#include <stdbool.h>
#include <stdint.h>

/* Starts it; false where the board has none or it did not start (said by `version`). */
bool hal_watchdog_start(uint32_t timeout_ms);

/* Tick. Changes the time-out of a watchdog that runs, to twice the one it was started with at most. Never waits: a new value takes up to half a
 * millisecond to arrive, so call it again until it returns true. The time-out holds from the feeding after that. */
bool hal_watchdog_change(uint32_t timeout_ms);

void hal_watchdog_feed(void);

#endif
