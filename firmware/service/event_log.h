/* The history: the last EVENT_HISTORY events and actions, in memory that survives a reset. Main loop only.
 *
 * Each record carries its own checksum. A reset in the middle of a write therefore costs that record alone, and random
 * contents after a loss of power do not count as events.
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
    /* Low bits of sequence / EVENT_HISTORY. The sequence number counts events since the last loss of power. */
    uint16_t round;
    uint8_t code, detail;
    uint32_t checksum;
};

struct event_log {
    struct event_record *record; /* record[sequence % EVENT_HISTORY] */
    uint32_t count;              /* sequence number of the next event */
    uint16_t boot;               /* low bits of the number of this start */
};

/* Takes over the records of earlier starts. */
void event_log_init(struct event_log *log, struct event_record *record, uint32_t boot);
void event_log_put(struct event_log *log, const struct event *event);
/* Replaces the event with that sequence number, which must still be in the history. The new event belongs to this start. */
void event_log_replace(struct event_log *log, uint32_t sequence, const struct event *event);
#ifndef EVENT_LOG_JOINS
/* 1: a run of repeats takes two entries. 0: each repeat takes an entry of its own. */
#define EVENT_LOG_JOINS 1
#endif
/* Joins the event with that sequence number to a run, where it repeats an event of the last hour of this start. It becomes the
 * latest of the run (EVENT_REPEATED), with the count of the run as its value, and the latest one before it is removed. Returns
 * whether an event was removed; all later events then have moved up by one. */
#if EVENT_LOG_JOINS
bool event_log_join(struct event_log *log, uint32_t sequence);
#else
#define event_log_join(log, sequence) ((void)(log), (void)(sequence), false)
#endif
/* Gets the event with that sequence number. Returns false when it is not in the history. A character of the subject that no
 * record can hold comes back as '?'. */
bool event_log_get(const struct event_log *log, uint32_t sequence, struct event *event);
/* Returns the sequence number of the oldest event that may still be in the history. */
uint32_t event_log_oldest(const struct event_log *log);

#endif
