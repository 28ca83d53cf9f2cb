/* Whether the watchdog may be fed. It is fed at a fixed rate from the tick context, while
 *
 *     the tick context comes round (who stands still does not feed),
 *     the main loop has turned within half the time-out, and
 *     ticks are not late one upon another: the last two took longer than their deadline, and since then less than a
 *     quarter of the time-out has passed. One late tick, whatever comes after it, starves nobody.
 *
 * Plain arithmetic on the board's clock; knows no board.
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
    uint32_t turns; /* of the main loop, when last looked at */
    uint64_t turned_ms;
    uint64_t tick_ms; /* when the tick under way began, or the last one ended */
    uint8_t late;     /* ticks in a row that ended past their deadline, up to HEARTBEAT_LATE */
};

void heartbeat_init(struct heartbeat *h, uint32_t timeout_ms);
/* Around the work of a tick; deadline_ms: longest it may take. */
void heartbeat_tick_begins(struct heartbeat *h, uint64_t now_ms);
void heartbeat_tick_ends(struct heartbeat *h, uint64_t now_ms, uint32_t deadline_ms);
/* Feed now? now_ms: not before the end of the last tick; turns: any number that changes with each turn of the main
 * loop. */
bool heartbeat_due(struct heartbeat *h, uint64_t now_ms, uint32_t turns);

#endif
