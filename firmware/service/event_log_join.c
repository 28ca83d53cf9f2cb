/* Joins repeats of an event to a run in the history (event_log_join). */
#include <string.h>

#include "service/event_log.h"

/* Longest plant time between two events of a run, ms. */
#define RUN_GAP_MS 3600000u

/* Removes an event. All events after it must be of this start, because event_log_replace() gives them its number. */
static void take_out(struct event_log *log, uint32_t sequence)
{
    struct event e;
    for (uint32_t k = sequence; k + 1u < log->count; k++) {
        if (event_log_get(log, k + 1u, &e))
            event_log_replace(log, k, &e);
        else
            memset(&log->record[k % EVENT_HISTORY], 0, sizeof log->record[0]);
    }
    log->count--;
    memset(&log->record[log->count % EVENT_HISTORY], 0, sizeof log->record[0]);
}

bool event_log_join(struct event_log *log, uint32_t sequence)
{
    struct event e, before;
    if (!event_log_get(log, sequence, &e) || !event_may_repeat(e.code))
        return false;
    for (uint32_t k = sequence; k-- > event_log_oldest(log);) {
        if (!event_log_get(log, k, &before))
            continue;
        if (before.boot != e.boot || e.time_ms < before.time_ms ||
            e.time_ms - before.time_ms > RUN_GAP_MS)
            return false;
        if ((before.code & ~EVENT_REPEATED) != e.code || before.detail != e.detail ||
            strcmp(before.subject, e.subject) != 0)
            continue;
        bool latest = before.code & EVENT_REPEATED;
        e.code |= EVENT_REPEATED;
        e.value = latest ? before.value + 1.0f : 2.0f;
        event_log_replace(log, sequence, &e);
        if (latest)
            take_out(log, k);
        return latest;
    }
    return false;
}
