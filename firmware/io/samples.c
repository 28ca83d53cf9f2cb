#include "io/samples.h"

#include <stddef.h>

#include "base/elapsed.h"

static void say(const struct samples *s, struct event_queue *events, enum event_code code,
                float value)
{
    event_put(events, s->time_ms, code, NULL, value, 0);
}

void samples_forget(struct samples *s, uint64_t now_ms)
{
    uint64_t time_ms = s->time_ms;
    *s = (struct samples){.seen_ms = now_ms, .time_ms = time_ms};
}

/* Returns the longest allowed board time with samples and without a tick, ms. */
static uint32_t stall_limit_ms(float tick_s, uint32_t miss_limit)
{
    float limit = ((float)miss_limit + 1.0f) * tick_s * 1000.0f;
    if (limit < (float)SAMPLES_STALL_LEAST_MS)
        return SAMPLES_STALL_LEAST_MS;
    return limit < 2e9f ? (uint32_t)limit : 2000000000u;
}

/* Counts a sample that makes no tick and came gap_ms after the one before. Returns whether that has gone on for too long. */
static bool stalls(struct samples *s, const struct io_sample *sample, uint64_t gap_ms, float tick_s,
                   uint32_t miss_limit)
{
    uint32_t limit = stall_limit_ms(tick_s, miss_limit), half = limit / 2u;
    /* A plant is allowed to withhold a sample for hours. So a gap counts for half of the limit at most. */
    s->idle_ms += gap_ms < half ? (uint32_t)gap_ms : half;
    /* A repeated sample gets its answer as often as it comes. Only the clock limits that. */
    bool again = sample->number == s->number || (s->idle && sample->number == s->idle_number);
    s->idle += !again;
    s->idle_number = sample->number;
    return s->idle_ms >= limit || s->idle > miss_limit;
}

/* Judges a sample by plant time alone. */
static enum sample_verdict on_plant_time(const struct samples *s, const struct io_sample *sample,
                                         float tick_s, uint32_t miss_limit,
                                         struct event_queue *events)
{
    if (!s->any)
        return SAMPLE_TICK;
    if (sample->time <= s->time_ms) {
        if (!s->stalled) /* while stalled, SAMPLE_STALLED reports them all */
            say(s, events, EVENT_SAMPLE_TWICE, (float)sample->number);
        return SAMPLE_NO_TICK;
    }
    float passed_s = elapsed_ms(sample->time, s->time_ms) / 1000.0f;
    if (passed_s < 0.875f * tick_s) {
        if (!s->stalled)
            say(s, events, EVENT_SAMPLE_EARLY, tick_s - passed_s);
        return SAMPLE_NO_TICK;
    }
    if (passed_s >= 1.5f * tick_s) {
        float missing = passed_s / tick_s - 0.5f;
        uint32_t whole = missing < 1e9f ? (uint32_t)missing : 1000000000u;
        say(s, events, EVENT_SAMPLE_MISSING, (float)whole);
        return whole > miss_limit ? SAMPLE_TICK_LOST : SAMPLE_TICK;
    }
    if (passed_s > 1.125f * tick_s)
        say(s, events, EVENT_SAMPLE_LATE, passed_s - tick_s);
    return SAMPLE_TICK;
}

enum sample_verdict samples_judge(struct samples *s, const struct io_sample *sample,
                                  uint64_t now_ms, float tick_s, uint32_t miss_limit,
                                  struct event_queue *events)
{
    enum sample_verdict verdict = on_plant_time(s, sample, tick_s, miss_limit, events);
    uint64_t gap_ms = now_ms - s->seen_ms;
    s->seen_ms = now_ms;
    s->overdue = false;
    if (verdict == SAMPLE_NO_TICK) {
        if (!stalls(s, sample, gap_ms, tick_s, miss_limit))
            return verdict;
        if (!s->stalled)
            say(s, events, EVENT_SAMPLE_STALLED, (float)s->idle_ms / 1000.0f);
        s->stalled = true;
        verdict = SAMPLE_TICK_STALLED;
    } else {
        s->stalled = false;
    }
    s->any = true;
    s->time_ms = sample->time;
    s->number = sample->number;
    s->idle = s->idle_ms = 0;
    return verdict;
}

bool samples_overdue(struct samples *s, uint64_t now_ms, float timeout_s,
                     struct event_queue *events)
{
    float waited_s = elapsed_ms(now_ms, s->seen_ms) / 1000.0f;
    if (timeout_s == 0.0f || waited_s < timeout_s || s->overdue)
        return false;
    s->overdue = true;
    say(s, events, EVENT_SAMPLE_OVERDUE, waited_s);
    return true;
}
