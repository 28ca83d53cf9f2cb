/* A checksum over the events that are kept over a reset, as the history reads them, with what of them is never shown. By
 * their names: the numbers of events are nobody's business but the firmware's. */
#ifndef REFLUX_TESTS_EVENT_SUM_H
#define REFLUX_TESTS_EVENT_SUM_H

#include <stdio.h>
#include <string.h>

#include "base/crc32.h"
#include "hal/retained.h"
#include "service/event_log.h"
#include "unity.h"

static inline uint32_t event_sum(uint32_t sum)
{
    struct event_log log;
    struct event e;
    char text[120];
    void *kept = hal_retained(HAL_RETAINED_EVENTS, HAL_RETAINED_EVENTS_BYTES);
    TEST_ASSERT_NOT_NULL(kept);
    event_log_init(&log, kept, 0);
    for (uint32_t k = event_log_oldest(&log); k < log.count; k++) {
        if (!event_log_get(&log, k, &e))
            continue;
        snprintf(text, sizeof text, "%llu %s %s %.9g %u %u\n", (unsigned long long)e.time_ms,
                 event_name(e.code), e.subject, (double)e.value, (unsigned)e.detail,
                 (unsigned)e.boot);
        sum = crc32_update(sum, text, strlen(text));
    }
    return sum;
}

#endif
