/* Memory that survives a reset, not a loss of power: one area for each who keeps something there.
 *
 * Rules
 *  1. After a loss of power an area holds anything. Whoever uses one keeps a checksum in it and looks at that
 *     before anything else; hal_reset_cause() tells nothing about the contents.
 *  2. A reset may come between any two writes.
 *  3. An area stays where it is from start to start of the same image; another image may lay it out anew.
 */
#ifndef REFLUX_HAL_RETAINED_H
#define REFLUX_HAL_RETAINED_H

#include <stddef.h>
#include <stdint.h>

#ifndef HAL_RETAINED_RESTART_BYTES
#define HAL_RETAINED_RESTART_BYTES 320 /* modes, setpoints, outputs: supervise/restart.h */
#endif
#ifndef HAL_RETAINED_EVENTS_BYTES
#define HAL_RETAINED_EVENTS_BYTES 3200 /* 32 for each of EVENT_HISTORY (service/event_log.h) */
#endif

#define HAL_RETAINED_STARTS_BYTES 8 /* service/early_resets.h */
#define HAL_RETAINED_KEYS_BYTES   8 /* wrong keys: operate/access.c */

enum hal_retained_area {
    HAL_RETAINED_RESTART,
    HAL_RETAINED_EVENTS,
    HAL_RETAINED_STARTS,
    HAL_RETAINED_KEYS
};

/* The area, aligned for anything; NULL when this board keeps fewer than n bytes for it. */
void *hal_retained(enum hal_retained_area area, size_t n);

/* For ports: one of these where a reset leaves it alone, and a hal_retained() that asks it. */
struct hal_retained_memory {
    uint64_t restart[(HAL_RETAINED_RESTART_BYTES + 7) / 8];
    uint64_t events[(HAL_RETAINED_EVENTS_BYTES + 7) / 8];
    uint64_t starts[(HAL_RETAINED_STARTS_BYTES + 7) / 8];
    uint64_t keys[(HAL_RETAINED_KEYS_BYTES + 7) / 8];
};

static inline void *hal_retained_in(struct hal_retained_memory *memory, enum hal_retained_area area,
                                    size_t n)
{
    if (area == HAL_RETAINED_RESTART)
        return n <= sizeof memory->restart ? memory->restart : NULL;
    if (area == HAL_RETAINED_STARTS)
        return n <= sizeof memory->starts ? memory->starts : NULL;
    if (area == HAL_RETAINED_KEYS)
        return n <= sizeof memory->keys ? memory->keys : NULL;
    return n <= sizeof memory->events ? memory->events : NULL;
}

#endif
