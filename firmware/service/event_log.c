#include "service/event_log.h"

#include <stddef.h>
#include <string.h>

#include "base/crc32.h"

/* Not 0: records of nothing but zeros are none. Changes with the layout of a record and the meaning of codes. */
#define SALT (0x45564C00u + EVENT_COUNT)

static uint32_t checksum(const struct event_record *r)
{
    return crc32_update(SALT, r, offsetof(struct event_record, checksum));
}

static bool whole(const struct event_record *r, unsigned slot)
{
    return r->checksum == checksum(r) && r->sequence % EVENT_HISTORY == slot;
}

void event_log_init(struct event_log *log, struct event_record *record, uint32_t boot)
{
    *log = (struct event_log){.record = record, .count = 0, .boot = (uint16_t)boot};
    for (unsigned i = 0; i < EVENT_HISTORY; i++)
        if (whole(&record[i], i) && record[i].sequence >= log->count)
            log->count = record[i].sequence + 1u;
}

void event_log_put(struct event_log *log, const struct event *event)
{
    struct event_record *r = &log->record[log->count % EVENT_HISTORY];
    r->event = *event;
    r->event.boot = log->boot;
    r->sequence = log->count++;
    r->checksum = checksum(r);
}

const struct event *event_log_get(const struct event_log *log, uint32_t sequence)
{
    unsigned slot = sequence % EVENT_HISTORY;
    const struct event_record *r = &log->record[slot];
    return whole(r, slot) && r->sequence == sequence ? &r->event : NULL;
}

uint32_t event_log_oldest(const struct event_log *log)
{
    return log->count > EVENT_HISTORY ? log->count - EVENT_HISTORY : 0;
}
