/* The history: the last EVENT_HISTORY events and actions, in memory that survives a reset. Main loop only.
 *
 * Each record carries its own checksum, so that a reset in the middle of a write costs that record alone and what a
 * loss of power left behind is not taken for events.
 */
#ifndef REFLUX_SERVICE_EVENT_LOG_H
#define REFLUX_SERVICE_EVENT_LOG_H

#include <stdbool.h>

#include "base/event.h"

#ifndef EVENT_HISTORY
#define EVENT_HISTORY 100
#endif

/* An event in 32 bytes. */
struct event_record {
    uint32_t subject[3]; /* five characters each */
    float value;
    uint32_t time_low; /* plant time, ms: 48 bits */
    uint16_t time_high;
    uint16_t boot;
    uint16_t
        round; /* sequence / EVENT_HISTORY, low bits; sequence counts events since the last loss of power */
    uint8_t code, detail;
    uint32_t checksum;
};

struct event_log {
    struct event_record *record; /* record[sequence % EVENT_HISTORY] */
    uint32_t count;              /* sequence of the next one */
    uint16_t boot;               /* of this start, low bits */
};

/* Takes over what the records hold of earlier starts. */
void event_log_init(struct event_log *log, struct event_record *record, uint32_t boot);
void event_log_put(struct event_log *log, const struct event *event);
/* Puts another event in the place of the one with that sequence number, which must still be there; it is then of this
 * start. */
void event_log_replace(struct event_log *log, uint32_t sequence, const struct event *event);
#ifndef EVENT_LOG_JOINS /* whether repeats take two entries; 0: each takes one of its own */
#define EVENT_LOG_JOINS 1
#endif
/* Where the event with that sequence number repeats one of the last hour of this start, it becomes the latest of the run, with
 * their count as its value (EVENT_REPEATED), and the one that was the latest goes. Returns whether one before it has gone: all
 * from there on have moved up by one. */
#if EVENT_LOG_JOINS
bool event_log_join(struct event_log *log, uint32_t sequence);
#else
#define event_log_join(log, sequence) ((void)(log), (void)(sequence), false)
#endif
/* The event with that sequence number; false when it is not there (any more). Characters that are in no name and in no
 * word of an event come back as '?'. */
bool event_log_get(const struct event_log *log, uint32_t sequence, struct event *event);
/* Sequence of the oldest one that may still be there. */
uint32_t event_log_oldest(const struct event_log *log);

#endif
