#include "service/early_resets.h"

#include <stddef.h>

#define LASTED 0x100u      /* bit of the count: this start has lasted EARLY_RESETS_MS */
#define CHECK  0x53524552u /* "RERS" */

static void keep_count(struct early_resets_record *record, uint32_t count)
{
    record->count = count;
    record->check = ~count ^ CHECK;
}

static bool record_holds(const struct early_resets_record *record)
{
    return record->check == (~record->count ^ CHECK) && record->count <= (LASTED | 0xFFu);
}

uint8_t early_resets_init(struct early_resets *e, void *memory, enum hal_reset cause,
                          uint32_t now_ms)
{
    *e = (struct early_resets){.record = memory, .born_ms = now_ms};
    if (!e->record)
        return 0;
    bool early = (cause == HAL_RESET_FAULT || cause == HAL_RESET_WATCHDOG) &&
                 record_holds(e->record) && (e->record->count & LASTED) == 0;
    uint32_t count = early ? e->record->count + 1u : 0;
    keep_count(e->record, count < 0xFFu ? count : 0xFFu);
    return (uint8_t)e->record->count;
}

void early_resets_poll(struct early_resets *e, uint32_t now_ms)
{
    if (e->record && (e->record->count & LASTED) == 0 && now_ms - e->born_ms >= EARLY_RESETS_MS)
        keep_count(e->record, e->record->count | LASTED);
}
