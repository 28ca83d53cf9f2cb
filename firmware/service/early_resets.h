/* Counts resets in a row by a fault or the watchdog, each soon after its start. Settings that bring the firmware down
 * would do so at every start. From EARLY_RESETS_MOST on the firmware leaves the stored settings out (storage/storage.h).
 *
 * The count is in memory that survives a reset. Any other kind of start, a `reboot` too, sets it to 0, because somebody
 * is present and wants another try.
 */
#ifndef REFLUX_SERVICE_EARLY_RESETS_H
#define REFLUX_SERVICE_EARLY_RESETS_H

#include "hal/identity.h"

#define EARLY_RESETS_MOST 3
#define EARLY_RESETS_MS   60000u /* board time after which a start counts as good, ms */

/* Record in memory that survives a reset. It is valid only if `check` fits `count`. */
struct early_resets_record {
    uint32_t count; /* resets in a row before this start; another bit: this start has lasted */
    uint32_t check;
};

struct early_resets {
    struct early_resets_record *record; /* NULL: the board has no such memory */
    uint32_t born_ms;
};

/* Counts this start. memory: sizeof(struct early_resets_record) bytes, or NULL. now_ms: low bits of the board's clock.
 * Returns the number of resets in a row before this start: 0 .. 255. */
uint8_t early_resets_init(struct early_resets *e, void *memory, enum hal_reset cause,
                          uint32_t now_ms);
/* Marks the start as good after EARLY_RESETS_MS. Call it more often than every 24 days. */
void early_resets_poll(struct early_resets *e, uint32_t now_ms);

#endif
