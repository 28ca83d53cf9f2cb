/* Whether the watchdog may be fed. It is fed at a fixed rate from the tick context, while
 *
 *     the tick context comes round (who stands still does not feed),
 *     the main loop has turned within half the time-out, and
 *     no tick is past its deadline: the last one took no longer than that.
 *
 * Plain arithmetic on the board's clock; knows no board.
 */
#ifndef REFLUX_SERVICE_HEARTBEAT_H
#define REFLUX_SERVICE_HEARTBEAT_H

#include <stdbool.h>
#include <stdint.h>

#define HEARTBEAT_RATE 8 /* feedings in a time-out */

struct heartbeat {
    uint32_t timeout_ms;
    uint64_t fed_ms;
    bool fed;
    uint32_t turns; /* of the main loop, when last looked at */
    uint64_t turned_ms;
    uint64_t began_ms; /* of the tick under way */
    bool late;         /* the last tick ended past its deadline */
};

void heartbeat_init(struct heartbeat *h, uint32_t timeout_ms);
/* Around the work of a tick; deadline_ms: longest it may take. */
void heartbeat_tick_begins(struct heartbeat *h, uint64_t now_ms);
void heartbeat_tick_ends(struct heartbeat *h, uint64_t now_ms, uint32_t deadline_ms);
/* Feed now? turns: any number that changes with each turn of the main loop. */
bool heartbeat_due(struct heartbeat *h, uint64_t now_ms, uint32_t turns);

#endif
