/* Three contexts of execution: the board clock, the tick below it, and the main loop below both.
 *
 * The tick context runs app_tick() at its own priority, above the main loop and below the receive
 * interrupts. It is requested when bytes arrive on the link and every HAL_TICK_PERIOD_MS of the board's
 * clock. On a host without interrupts the port calls it between main-loop turns: same order, no overlap.
 *
 * On boards with devices at their own pins the board clock runs app_clock() once for every millisecond, above the tick and below the
 * interrupts of buses and lines, so that outputs are switched, and switched off, whatever the tick does.
 */
#ifndef REFLUX_HAL_TICK_H
#define REFLUX_HAL_TICK_H

#include <stdbool.h>

#define HAL_TICK_PERIOD_MS 50

/* Whether there is a board clock: not on boards without devices at their own pins (exchange/config.h). */
#if defined(CONFIG_DEVICES) && CONFIG_DEVICES == 0
#define HAL_BOARD_CLOCK 0
#else
#define HAL_BOARD_CLOCK 1
#endif

/* Asks for the tick context as soon as possible. Callable from anywhere. */
void hal_tick_request(void);

/* Holds the tick context off while the main loop copies something it shares; keep it to microseconds. The longest is
 * a plan put into force (service_settle), which the tick would have to do otherwise.
 * Locks nest: the tick context goes on after as many unlocks as locks. */
void hal_tick_lock(void);
void hal_tick_unlock(void);

/* Main loop has nothing to do: wait for the next interrupt (or for input on the host). wait = false spins:
 * a run-time choice, so that the image is the same on the chip and in an emulator counting instructions. */
void hal_idle(bool wait);

#endif
