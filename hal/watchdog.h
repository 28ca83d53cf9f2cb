/* The independent watchdog: once started it cannot be stopped, and resets the board when not fed. */
#ifndef REFLUX_HAL_WATCHDOG_H
#define REFLUX_HAL_WATCHDOG_H

#include <stdbool.h>
#include <stdint.h>

/* Starts it; false where the board has none or it did not start (said by `version`). */
bool hal_watchdog_start(uint32_t timeout_ms);
void hal_watchdog_feed(void);

#endif
