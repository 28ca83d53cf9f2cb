/* Decides whether the tick context may feed the watchdog. It feeds at a fixed rate as long as
 *
 *     the tick context runs (a context that stands still does not feed),
 *     the main loop has turned within half the time-out, and
 *     ticks are not late in a row. They are if the last two took longer than their deadline and less than a quarter of
 *     the time-out has passed since. A single late tick never stops the feeding.
 *
 * The code is plain arithmetic on the board's clock and knows no board.
 */
#ifndef REFLUX_SERVICE_HEARTBEAT_H
#define REFLUX_SERVICE_HEARTBEAT_H

#include <stdbool.h>
#include <stdint.h>

#define HEARTBEAT_RATE 8 /* feedings in a time-out */
#define HEARTBEAT_LATE 2 /* ticks past their deadline, in a row, that stop the feeding */

struct heartbeat {
    uint32_t timeout_ms;
    uint64_t fed_ms;
    bool fed;
    uint32_t turns;     /* turns of the main loop at the last look */
    uint64_t turned_ms; /* board time at which the main loop last turned */
    uint64_t tick_ms;   /* board time at which the present tick began, or the last one ended */
    uint8_t late;       /* ticks in a row that ended past their deadline, up to HEARTBEAT_LATE */
};

void heartbeat_init(struct heartbeat *h, uint32_t timeout_ms);
/* The watchdog has another time-out from the next feeding on, which comes at once if it may. */
void heartbeat_change(struct heartbeat *h, uint32_t timeout_ms);
/* Call these before and after the work of a tick. deadline_ms: longest time that a tick may take. */
void heartbeat_tick_begins(struct heartbeat *h, uint64_t now_ms);
void heartbeat_tick_ends(struct heartbeat *h, uint64_t now_ms, uint32_t deadline_ms);
/* Returns whether to feed the watchdog now. now_ms: not before the end of the last tick. turns: any number that changes
 * with each turn of the main loop. */
bool heartbeat_due(struct heartbeat *h, uint64_t now_ms, uint32_t turns);

#endif
