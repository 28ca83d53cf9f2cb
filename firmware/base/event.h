/* Events: what happened, when in plant time, to whom. Written by either context into its own queue,
 * printed by the console as `! <time> <level> <CODE> <subject> <text>`. */
#ifndef REFLUX_BASE_EVENT_H
#define REFLUX_BASE_EVENT_H

#include <stdbool.h>
#include <stdint.h>

#include "base/channel.h"
#include "base/spsc.h"

enum event_level { EVENT_INFO, EVENT_WARNING, EVENT_ALARM, EVENT_ACTION };

/* A board without automatic start-up has no blocks either (CONFIG_BLOCKS): there these are not even absent. */
#if !defined(COMMISSION_CHANNELS) || COMMISSION_CHANNELS
#define EVENTS_OF_BLOCKS 1
#else
#define EVENTS_OF_BLOCKS 0
#endif

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
    EVENT_ALARM_ON,
    EVENT_ALARM_OFF,
    EVENT_ALARM_ACK,
    EVENT_ALARM_SHELVED,
    EVENT_SAMPLE_OVERDUE,
    EVENT_SAMPLE_STALLED,
    EVENT_RESTART_DONE,
    EVENT_RESTART_REFUSED,
    EVENT_WRONG_KEY,
    EVENT_PLANT_REFUSED,
    EVENT_SAMPLE_REFUSED,
    EVENT_STORAGE_LOADED,
    EVENT_STORAGE_OLDER,
    EVENT_STORAGE_CLIPPED,
    EVENT_STORAGE_REFUSED,
    EVENT_STORAGE_DAMAGED,
    EVENT_STORAGE_LEFT_OUT,
    EVENT_STORAGE_NEWER,
    EVENT_BLOCK_UNKNOWN,
    EVENT_IMAGE_DAMAGED,
    /* Sequences: value is the step; detail as supervise/sequence.h. */
    EVENT_SEQUENCE_STEP,
    EVENT_SEQUENCE_HELD,
    EVENT_SEQUENCE_GOES_ON,
    EVENT_SEQUENCE_CONFIRMED,
    EVENT_SEQUENCE_SKIPPED,
    EVENT_SEQUENCE_TIMEOUT,
    EVENT_SEQUENCE_DONE,
    EVENT_SEQUENCE_ABORTED,
    EVENT_OFFSET,
    EVENT_COMMISSION_BEGUN,
    EVENT_COMMISSION_ENDED,
    EVENT_TEST_STEP,
    EVENT_TEST_CUT,
    EVENT_TEST_DONE,
    EVENT_TEST_LONGER,
    EVENT_TEST_SMALLER,
    EVENT_TEST_EXTENDED,
    EVENT_RELAY_DONE,
    EVENT_PROPOSAL,
    EVENT_NOT_DETERMINED,
    EVENT_TRIAL_BEGUN,
    EVENT_TRIAL_KEPT,
    EVENT_TRIAL_FAILED,
    EVENT_JOB_LATE,
    EVENT_BLOCK_GAVE_UP,
    EVENT_BLOCK_ON,
#if EVENTS_OF_BLOCKS
    EVENT_CHANNEL_WRITTEN,
    EVENT_LOOP_DIVISOR,
    EVENT_BLOCK_VERB,
    EVENT_BLOCK_REFUSED,
    EVENT_BLOCK_EVENT, /* detail: place of the block's kind, whose words say more */
    EVENT_BLOCK_ALARM, /* likewise */
    EVENT_EXCITATION_BEGUN,
    EVENT_EXCITATION_ENDED,
    EVENT_BLOCK_PROPOSES,
    EVENT_BLOCK_ADOPTED,
    EVENT_PROPOSAL_REFUSED, /* detail: -code */
#endif
    EVENT_DEVIATION,
    EVENT_DEVIATION_OVER,
    EVENT_DOUBTFUL,
    EVENT_DOUBTFUL_OVER,
    EVENT_FIRST_READING,
    EVENT_SAME_READING,
    /* Actions: what was asked for at the console. Kept in the history, not announced. */
    EVENT_DO_MODE,
    EVENT_DO_SETPOINT,
    EVENT_DO_OUTPUT,
    EVENT_DO_SET,
    EVENT_DO_APPLY,
    EVENT_DO_STORAGE,
    EVENT_DO_ALARM,
    EVENT_DO_SEQUENCE,
    EVENT_DO_KEY,
    EVENT_DO_UNLOCK,
    EVENT_DO_LOCK,
    EVENT_DO_COMMISSION,
    EVENT_DO_REBOOT,
#if EVENTS_OF_BLOCKS
    EVENT_DO_BLOCK,
    EVENT_DO_PROPOSAL,
    EVENT_SWITCHED_OFF,
    EVENT_PROPOSAL_WITHDRAWN,
#endif
    EVENT_COUNT
};

/* Bit of the code of an entry of the history that is the latest of a run: its value says how many there were. */
#define EVENT_REPEATED 0x80u
_Static_assert(EVENT_COUNT <= EVENT_REPEATED, "codes leave that bit free");

#define EVENT_ENGINEER 1u /* bit of `detail` of an action: done on the engineer level */

struct event {
    uint64_t time_ms; /* plant time */
    uint8_t code;     /* enum event_code */
    uint8_t detail;   /* meaning by code: a mode, an error code as -code */
    char subject[CHANNEL_NAME_SIZE];
    uint16_t boot; /* low bits of the boot it belongs to; filled in by the history */
    float value;   /* meaning by code; EU where there is a channel */
};

const char *event_name(uint8_t code); /* "LINK_UP"; "?" out of range */
const char *event_text(uint8_t code); /* what the value means, in words */
enum event_level event_level(uint8_t code);
const char *event_level_name(enum event_level level);
/* Returns whether the event may come again and again, with nothing in its value that a count could not stand for. */
bool event_may_repeat(uint8_t code);

#ifndef EVENT_QUEUE_SIZE
#define EVENT_QUEUE_SIZE 64 /* power of two: all that one tick can say */
#endif

struct event_queue {
    struct spsc index;
    struct event slot[EVENT_QUEUE_SIZE];
    uint32_t lost; /* events that found no room */
};

/* subject may be NULL; what is too long is cut. */
struct event event_make(uint64_t time_ms, enum event_code code, const char *subject, float value,
                        uint8_t detail);

void event_queue_init(struct event_queue *queue);
/* subject may be NULL. Never waits: a full queue counts the loss. */
void event_put(struct event_queue *queue, uint64_t time_ms, enum event_code code,
               const char *subject, float value, uint8_t detail);

#endif
