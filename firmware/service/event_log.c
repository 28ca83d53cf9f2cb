#include "service/event_log.h"

#include <stddef.h>
#include <string.h>

#include "base/crc32.h"

/* Start of the checksum. It is not 0, so that a record of zeros is invalid. It changes with the layout of a record and the meaning of
 * codes. */
#define SALT (0x45564D00u + EVENT_COUNT)

/* A subject has 84 symbols: the 83 characters ',' to '~', and its end. Five symbols make a word. */
#define SYMBOLS   84u
#define FIVE      5u
#define BEFORE    '+'
#define TIME_MOST ((UINT64_C(1) << 48) - 1u)
_Static_assert(sizeof(struct event_record) == 32, "no gaps, which the checksum would cover");
_Static_assert(CHANNEL_NAME_SIZE - 1 == 3 * FIVE, "a subject fills its words");

static uint32_t event_checksum(const struct event_record *r)
{
    return crc32_update(SALT, r, offsetof(struct event_record, checksum));
}

static bool event_is_whole(const struct event_record *r)
{
    return r->checksum == event_checksum(r);
}

static void pack_subject(const char *subject, uint32_t word[3])
{
    for (unsigned w = 0; w < 3; w++) {
        word[w] = 0;
        for (unsigned i = 0; i < FIVE; i++) {
            char c = *subject;
            subject += c != 0;
            if (c && (c <= BEFORE || c > '~'))
                c = '?';
            word[w] = word[w] * SYMBOLS + (uint32_t)(c ? c - BEFORE : 0);
        }
    }
}

static void unpack_subject(const uint32_t word[3], char *subject)
{
    for (unsigned w = 0; w < 3; w++) {
        uint32_t left = word[w];
        for (unsigned i = FIVE; i-- > 0;) {
            uint32_t symbol = left % SYMBOLS;
            left /= SYMBOLS;
            subject[w * FIVE + i] = (char)(symbol ? BEFORE + symbol : 0);
        }
    }
}

/* Returns whether one that is not whole follows the last whole one: round and start go on, as those of old or random records do not. */
static bool newest_is_damaged(const struct event_log *log)
{
    const struct event_record *r = &log->record[log->count % EVENT_HISTORY];
    return log->count && r->round == (uint16_t)(log->count / EVENT_HISTORY) &&
           r->boot == log->record[(log->count - 1u) % EVENT_HISTORY].boot;
}

void event_log_init(struct event_log *log, struct event_record *record, uint32_t boot)
{
    *log = (struct event_log){.record = record, .count = 0, .boot = (uint16_t)boot};
    for (unsigned i = 0; i < EVENT_HISTORY; i++) {
        uint32_t sequence = (uint32_t)record[i].round * EVENT_HISTORY + i;
        if (event_is_whole(&record[i]) && sequence >= log->count)
            log->count = sequence + 1u;
    }
    if (EVENT_LOG_JOINS && newest_is_damaged(log))
        log->count++;
}

void event_log_replace(struct event_log *log, uint32_t sequence, const struct event *event)
{
    struct event_record *r = &log->record[sequence % EVENT_HISTORY];
    uint64_t time_ms = event->time_ms < TIME_MOST ? event->time_ms : TIME_MOST;
    pack_subject(event->subject, r->subject);
    r->value = event->value;
    r->time_low = (uint32_t)time_ms;
    r->time_high = (uint16_t)(time_ms >> 32);
    r->boot = log->boot;
    r->round = (uint16_t)(sequence / EVENT_HISTORY);
    r->code = event->code;
    r->detail = event->detail;
    r->checksum = event_checksum(r);
}

void event_log_put(struct event_log *log, const struct event *event)
{
    event_log_replace(log, log->count, event);
    log->count++;
}

bool event_log_get(const struct event_log *log, uint32_t sequence, struct event *event)
{
    const struct event_record *r = &log->record[sequence % EVENT_HISTORY];
    if (!event_is_whole(r) || r->round != (uint16_t)(sequence / EVENT_HISTORY))
        return false;
    memset(event, 0, sizeof *event);
    unpack_subject(r->subject, event->subject);
    event->time_ms = (uint64_t)r->time_high << 32 | r->time_low;
    event->value = r->value;
    event->boot = r->boot;
    event->code = r->code;
    event->detail = r->detail;
    return true;
}

uint32_t event_log_oldest(const struct event_log *log)
{
    return log->count > EVENT_HISTORY ? log->count - EVENT_HISTORY : 0;
}
