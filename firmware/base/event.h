/* Events: what happened, when in plant time, to whom. Written by either context into its own queue,
 * printed by the console as `! <time> <level> <CODE> <subject> <text>`. */
#ifndef REFLUX_BASE_EVENT_H
#define REFLUX_BASE_EVENT_H

#include <stdint.h>

#include "base/channel.h"
#include "base/spsc.h"

enum event_level { EVENT_INFO, EVENT_WARNING, EVENT_ALARM };

/* Name and text of each are in event.c, in this order. */
enum event_code {
    EVENT_STARTED,
    EVENT_LINK_UP,
    EVENT_LINK_DOWN,
    EVENT_LINK_VERSION,
    EVENT_CHANNEL_MISSING,
    EVENT_CHANNEL_UNIT,
    EVENT_SAFE_STATE,
    EVENT_CONFIG_APPLIED,
    EVENT_CONFIG_REFUSED,
    EVENT_MODE,
    EVENT_MODE_REFUSED,
    EVENT_SETPOINT,
    EVENT_OUTPUT,
    EVENT_REQUEST_REFUSED,
    EVENT_SAMPLE_TWICE,
    EVENT_SAMPLE_EARLY,
    EVENT_SAMPLE_LATE,
    EVENT_SAMPLE_MISSING,
    EVENT_MEASUREMENT_BAD,
    EVENT_MEASUREMENT_GOOD,
    EVENT_INTERLOCK_ON,
    EVENT_INTERLOCK_OFF,
    EVENT_NOT_FOLLOWING,
    EVENT_FOLLOWING,
    EVENT_TELEMETRY_LOST,
    EVENT_COUNT
};

struct event {
    uint64_t time_ms; /* plant time */
    uint8_t code;     /* enum event_code */
    uint8_t detail;   /* meaning by code: a mode, an error code as -code */
    char subject[CHANNEL_NAME_SIZE];
    float value; /* meaning by code; EU where there is a channel */
};

const char *event_name(uint8_t code); /* "LINK_UP"; "?" out of range */
const char *event_text(uint8_t code); /* what the value means, in words */
enum event_level event_level(uint8_t code);
const char *event_level_name(enum event_level level);

#define EVENT_QUEUE_SIZE 32

struct event_queue {
    struct spsc index;
    struct event slot[EVENT_QUEUE_SIZE];
    uint32_t lost; /* events that found no room */
};

void event_queue_init(struct event_queue *queue);
/* subject may be NULL. Never waits: a full queue counts the loss. */
void event_put(struct event_queue *queue, uint64_t time_ms, enum event_code code,
               const char *subject, float value, uint8_t detail);

#endif
