/* Events: a code, the plant time and the subject. The tick writes events into a queue, the main loop into the history.
 * The console prints them as `! <time> <level> <CODE> <subject> <text>`. */
#ifndef REFLUX_BASE_EVENT_H
#define REFLUX_BASE_EVENT_H

#include <stdbool.h>
#include <stdint.h>

#include "base/channel.h"
#include "base/event_list.h"
#include "base/spsc.h"

enum event_level { EVENT_INFO, EVENT_WARNING, EVENT_ALARM, EVENT_ACTION };

/* The codes, EVENT_STARTED and so on, in the order of event_list.h. */
#define EVENT_CODE(name, text, level, unit) EVENT_##name,
#define EVENT_NO_CODE(name, text, level, unit)
/* What boards without blocks or checks leave out; the codes that they still have are for code that they never reach. */
#if defined(COMMISSION_CHANNELS) && COMMISSION_CHANNELS == 0
#define EVENT_CODE_OF_BLOCK EVENT_NO_CODE
#define EVENT_BLOCKS_LACK   EVENT_CHANNEL_WRITTEN = EVENT_COUNT, EVENT_BLOCK_EVENT = EVENT_COUNT,
#else
#define EVENT_CODE_OF_BLOCK EVENT_CODE
#define EVENT_BLOCKS_LACK
#endif
#if defined(BOARD_CHECKS) && BOARD_CHECKS == 0
#define EVENT_CODE_OF_CHECK EVENT_NO_CODE
#define EVENT_CHECKS_LACK   EVENT_RAM_FAILED = EVENT_COUNT,
#else
#define EVENT_CODE_OF_CHECK EVENT_CODE
#define EVENT_CHECKS_LACK
#endif
/* Nobody names an event of devices where there are none. */
#if defined(CONFIG_DEVICES) && CONFIG_DEVICES == 0
#define EVENT_CODE_OF_PINS EVENT_NO_CODE
#else
#define EVENT_CODE_OF_PINS EVENT_CODE
#endif
enum event_code {
    EVENT_LIST(EVENT_CODE, EVENT_CODE, EVENT_CODE, EVENT_CODE, EVENT_CODE, EVENT_CODE_OF_BLOCK,
               EVENT_CODE_OF_CHECK, EVENT_CODE_OF_PINS) EVENT_COUNT,
    EVENT_BLOCKS_LACK EVENT_CHECKS_LACK
};

/* Bit in the code of a history entry that is the latest of a run of repeats. Its value is their number. */
#define EVENT_REPEATED 0x80u
_Static_assert(EVENT_COUNT <= EVENT_REPEATED, "codes leave that bit free");

#define EVENT_ENGINEER 1u /* bit of `detail` of an action: done on the engineer level */

struct event {
    uint64_t time_ms; /* plant time */
    uint8_t code;     /* enum event_code */
    uint8_t detail;   /* meaning by code: a mode, an error code as -code */
    char subject[CHANNEL_NAME_SIZE];
    uint16_t boot; /* low bits of the start it belongs to; the history fills it in */
    float value;   /* meaning by code; EU where there is a channel */
};

/* Returns the name, "LINK_UP"; "?" out of range. */
const char *event_name(uint8_t code);
/* Returns the description, which also says what the value means; "?" out of range. */
const char *event_text(uint8_t code);
enum event_level event_level(uint8_t code);
const char *event_level_name(enum event_level level);
/* Returns whether the event may repeat often, and a count may replace its value. */
bool event_may_repeat(uint8_t code);

#ifndef EVENT_QUEUE_SIZE
#define EVENT_QUEUE_SIZE 64 /* power of two; room for all events of one tick */
#endif

struct event_queue {
    struct spsc index;
    struct event slot[EVENT_QUEUE_SIZE];
    uint32_t lost; /* events that found no room */
};

/* Returns an event. subject may be NULL; a subject that is too long is cut. */
struct event event_make(uint64_t time_ms, enum event_code code, const char *subject, float value,
                        uint8_t detail);

void event_queue_init(struct event_queue *queue);
/* Puts an event into the queue; subject may be NULL. The function never waits: it counts a loss where the queue is full. */
void event_put(struct event_queue *queue, uint64_t time_ms, enum event_code code,
               const char *subject, float value, uint8_t detail);

#endif
