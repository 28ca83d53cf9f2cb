/* Resets by a fault or by the watchdog, in a row, each soon after its start: settings that bring the firmware down would
 * do so at every start. From EARLY_RESETS_MOST on the stored ones are left out (storage/storage.h).
 *
 * The count lies in memory that survives a reset. Any other kind of start, a `reboot` too, begins it anew: somebody is
 * there and wants another try.
 */
#ifndef REFLUX_SERVICE_EARLY_RESETS_H
#define REFLUX_SERVICE_EARLY_RESETS_H

#include "hal/identity.h"

#define EARLY_RESETS_MOST 3
#define EARLY_RESETS_MS   60000u /* a start that has lasted so long was a good one */

/* In memory that survives a reset; looked at only when it checks. */
struct early_resets_record {
    uint32_t count; /* resets in a row before this start; a bit beside it: this one has lasted */
    uint32_t check;
};

struct early_resets {
    struct early_resets_record *record; /* NULL: the board has no such memory */
    uint32_t born_ms;
};

/* After a start. memory: sizeof(struct early_resets_record), or NULL. now_ms: the board's clock, low bits. Returns the
 * resets in a row that led here: 0 .. 255. */
uint8_t early_resets_init(struct early_resets *e, void *memory, enum hal_reset cause,
                          uint32_t now_ms);
/* Now and then, more often than every 24 days. */
void early_resets_poll(struct early_resets *e, uint32_t now_ms);

#endif
