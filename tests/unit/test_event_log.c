/* The history of events in memory that survives a reset, and what that memory may hold instead. */
#include <stddef.h>
#include <string.h>

#include "random_source.h"
#include "service/event_log.h"
#include "unity.h"

static struct event_record memory[EVENT_HISTORY];
static struct event_log event_log;

static void start(uint32_t boot)
{
    event_log_init(&event_log, memory, boot);
}

static void put(unsigned n)
{
    struct event e = event_make((uint64_t)1000u * n, EVENT_SETPOINT, "top", (float)n, 0);
    event_log_put(&event_log, &e);
}

static void holds(uint32_t sequence, float value, uint16_t boot)
{
    struct event e;
    TEST_ASSERT_TRUE(event_log_get(&event_log, sequence, &e));
    TEST_ASSERT_EQUAL_FLOAT(value, e.value);
    TEST_ASSERT_EQUAL_STRING("top", e.subject);
    TEST_ASSERT_EQUAL(boot, e.boot);
}

void setUp(void)
{
    memset(memory, 0xA5, sizeof memory);
    start(7);
}
void tearDown(void) {}

static void memory_after_a_loss_of_power_holds_no_events(void)
{
    struct random_source source = {.state = 99};
    TEST_ASSERT_EQUAL(0, event_log.count);
    memset(memory, 0, sizeof memory);
    start(7);
    TEST_ASSERT_EQUAL(0, event_log.count);
    memset(memory, 0xFF, sizeof memory);
    start(7);
    TEST_ASSERT_EQUAL(0, event_log.count);
    for (unsigned n = 0; n < 200; n++) {
        uint8_t *byte = (uint8_t *)memory;
        for (size_t i = 0; i < sizeof memory; i++)
            byte[i] = (uint8_t)random_next(&source);
        start(7);
        TEST_ASSERT_EQUAL(0, event_log.count);
    }
}

static void the_last_ones_are_kept(void)
{
    for (unsigned n = 0; n < EVENT_HISTORY * 3u + 5u; n++)
        put(n);
    TEST_ASSERT_EQUAL(EVENT_HISTORY * 2u + 5u, event_log_oldest(&event_log));
    struct event e;
    TEST_ASSERT_FALSE(event_log_get(&event_log, event_log_oldest(&event_log) - 1u, &e));
    for (uint32_t n = event_log_oldest(&event_log); n < event_log.count; n++)
        holds(n, (float)n, 7);
    TEST_ASSERT_FALSE(event_log_get(&event_log, event_log.count, &e));
}

static void a_reset_keeps_them_and_marks_them_by_their_boot(void)
{
    for (unsigned n = 0; n < EVENT_HISTORY + 20u; n++)
        put(n);
    start(8);
    TEST_ASSERT_EQUAL(EVENT_HISTORY + 20u, event_log.count);
    put(event_log.count);
    holds(EVENT_HISTORY + 19u, EVENT_HISTORY + 19u, 7);
    holds(EVENT_HISTORY + 20u, EVENT_HISTORY + 20u, 8);
}

static void a_reset_in_the_middle_of_any_write_costs_that_one_event(void)
{
    for (unsigned n = 0; n < EVENT_HISTORY + 3u; n++)
        put(n);
    struct event_record old = memory[3], new;
    put(EVENT_HISTORY + 3u);
    new = memory[3];
    for (size_t written = 0; written <= sizeof new; written++) {
        memcpy(&memory[3], &new, written);
        memcpy((uint8_t *)&memory[3] + written, (const uint8_t *)&old + written,
               sizeof new - written);
        start(8);
        bool known = memory[3].round == new.round; /* to be the newest, whole or not */
        TEST_ASSERT_EQUAL(EVENT_HISTORY + (known ? 4u : 3u), event_log.count);
        for (uint32_t n = 4; n < EVENT_HISTORY + 3u; n++)
            holds(n, (float)n, 7);
    }
}

static void a_damaged_newest_event_keeps_its_place(void)
{
    struct event e;
    for (unsigned n = 0; n < EVENT_HISTORY + 5u; n++)
        put(n);
    memory[4].value += 1.0f;
    start(8);
    TEST_ASSERT_EQUAL(EVENT_HISTORY + 5u, event_log.count);
    TEST_ASSERT_FALSE(event_log_get(&event_log, EVENT_HISTORY + 4u, &e));
    holds(EVENT_HISTORY + 3u, EVENT_HISTORY + 3u, 7);
    put(EVENT_HISTORY + 5u);
    start(9);
    TEST_ASSERT_EQUAL(EVENT_HISTORY + 6u, event_log.count);
}

static void a_flipped_bit_costs_one_event_and_no_other(void)
{
    for (unsigned n = 0; n < EVENT_HISTORY; n++)
        put(n);
    for (size_t bit = 0; bit < sizeof memory * 8u; bit++) {
        uint8_t *byte = (uint8_t *)memory + bit / 8u;
        unsigned hit = (unsigned)(bit / 8u / sizeof memory[0]);
        *byte ^= (uint8_t)(1u << bit % 8u);
        start(8);
        struct event e;
        TEST_ASSERT_FALSE(event_log_get(&event_log, hit, &e));
        size_t at = bit / 8u % sizeof memory[0];
        bool placeless =
            at >= offsetof(struct event_record, boot) && at < offsetof(struct event_record, code);
        uint32_t count = EVENT_HISTORY;
        if (placeless && hit == EVENT_HISTORY - 1u)
            count--; /* nothing says that it is there */
        if (memory[0].round == 1u)
            count++; /* the oldest passes for the newest */
        TEST_ASSERT_EQUAL(count, event_log.count);
        *byte ^= (uint8_t)(1u << bit % 8u);
    }
}

static void comes_back(uint64_t time_ms, uint8_t code, const char *subject, float value,
                       uint8_t detail)
{
    struct event e = event_make(time_ms, (enum event_code)code, subject, value, detail), back;
    uint32_t at = event_log.count;
    event_log_put(&event_log, &e);
    e.boot = 7;
    TEST_ASSERT_TRUE(event_log_get(&event_log, at, &back));
    TEST_ASSERT_EQUAL_MEMORY(&e, &back, sizeof e);
}

static void everything_an_event_says_comes_back(void)
{
    comes_back(0, EVENT_STARTED, "power-on", 0.0f, 0);
    comes_back((UINT64_C(1) << 48) - 1u, EVENT_DO_REBOOT, "", -1e9f, 255);
    comes_back(1753000000123u, EVENT_COUNT - 1, "alarm16.hi_hi~,", 1e-6f, 1);
    comes_back(1, 255, "zzzzzzzzzzzzzzz", 5.0f, 3);
    struct random_source r = {.state = 5};
    for (unsigned turn = 0; turn < 1000; turn++) {
        char subject[CHANNEL_NAME_SIZE] = "";
        unsigned n = random_below(&r, CHANNEL_NAME_SIZE);
        for (unsigned i = 0; i < n; i++)
            subject[i] = (char)(',' + random_below(&r, '~' - ',' + 1));
        comes_back(random_next(&r) >> 16, (uint8_t)random_below(&r, EVENT_COUNT), subject,
                   (float)turn, (uint8_t)turn);
    }
}

static void what_a_record_cannot_hold_is_told_from_what_it_can(void)
{
    struct event e = event_make(UINT64_MAX, EVENT_MODE, "a b\x7f\xff+!", 0.0f, 0);
    event_log_put(&event_log, &e);
    TEST_ASSERT_TRUE(event_log_get(&event_log, event_log.count - 1u, &e));
    TEST_ASSERT_EQUAL_STRING("a?b????", e.subject);
    TEST_ASSERT_TRUE(e.time_ms == (UINT64_C(1) << 48) - 1u);
}

/* ---- runs of repeats ---- */

/* As the history keeps it once it has been announced. */
static void comes(uint64_t time_s, enum event_code code, const char *subject)
{
    struct event e = event_make(time_s * 1000u, code, subject, 0.25f, 0);
    event_log_put(&event_log, &e);
    (void)event_log_join(&event_log, event_log.count - 1u);
}

static void stands(uint32_t sequence, uint64_t time_s, uint8_t code, float value)
{
    struct event e;
    TEST_ASSERT_TRUE(event_log_get(&event_log, sequence, &e));
    TEST_ASSERT_EQUAL(code, e.code);
    TEST_ASSERT_TRUE(e.time_ms == time_s * 1000u);
    TEST_ASSERT_EQUAL_FLOAT(value, e.value);
}

static void of_a_run_of_repeats_the_first_and_the_latest_stand_with_the_count(void)
{
    for (unsigned k = 1; k <= 300; k++)
        comes(k, EVENT_SAMPLE_LATE, "");
    TEST_ASSERT_EQUAL(2, event_log.count);
    stands(0, 1, EVENT_SAMPLE_LATE, 0.25f);
    stands(1, 300, EVENT_SAMPLE_LATE | EVENT_REPEATED, 300.0f);
}

static void runs_that_alternate_take_two_entries_each_in_the_order_of_time(void)
{
    for (unsigned k = 1; k <= 300; k++)
        comes(k, k % 2 ? EVENT_SAMPLE_EARLY : EVENT_SAMPLE_LATE, "");
    TEST_ASSERT_EQUAL(4, event_log.count);
    stands(0, 1, EVENT_SAMPLE_EARLY, 0.25f);
    stands(1, 2, EVENT_SAMPLE_LATE, 0.25f);
    stands(2, 299, EVENT_SAMPLE_EARLY | EVENT_REPEATED, 150.0f);
    stands(3, 300, EVENT_SAMPLE_LATE | EVENT_REPEATED, 150.0f);
}

static void what_comes_between_stays_where_it_was(void)
{
    for (unsigned k = 1; k <= 300; k++)
        comes(k, k % 100 ? EVENT_SAMPLE_LATE : EVENT_DO_MODE, "");
    TEST_ASSERT_EQUAL(5, event_log.count);
    stands(0, 1, EVENT_SAMPLE_LATE, 0.25f);
    for (unsigned k = 1; k <= 2; k++)
        stands(k, 100u * k, EVENT_DO_MODE, 0.25f);
    stands(3, 299, EVENT_SAMPLE_LATE | EVENT_REPEATED, 297.0f);
    stands(4, 300, EVENT_DO_MODE, 0.25f);
}

static void another_subject_an_hour_or_a_start_begins_a_new_run(void)
{
    comes(1, EVENT_MEASUREMENT_BAD, "T1");
    comes(2, EVENT_MEASUREMENT_BAD, "T2");
    comes(3602, EVENT_MEASUREMENT_BAD, "T1"); /* 3601 s later */
    start(8);
    comes(3603, EVENT_MEASUREMENT_BAD, "T1");
    TEST_ASSERT_EQUAL(4, event_log.count);
    for (unsigned k = 0; k < 4; k++) {
        struct event e;
        TEST_ASSERT_TRUE(event_log_get(&event_log, k, &e));
        TEST_ASSERT_EQUAL(EVENT_MEASUREMENT_BAD, e.code);
    }
}

static void what_says_something_with_its_value_is_never_counted(void)
{
    static const enum event_code each[] = {EVENT_SETPOINT,         EVENT_MODE,
                                           EVENT_OUTPUT,           EVENT_DO_SET,
                                           EVENT_SEQUENCE_SKIPPED, EVENT_WRONG_KEY};
    for (unsigned n = 0; n < sizeof each / sizeof each[0]; n++)
        for (unsigned k = 0; k < 3; k++)
            comes(n, each[n], "top");
    TEST_ASSERT_EQUAL(18, event_log.count);
}

/* Power stays, the processor begins anew, after any number of the records that a join writes. */
static void a_reset_while_a_run_is_counted_loses_none_that_is_not_of_it(void)
{
    static struct event_record before[EVENT_HISTORY], after[EVENT_HISTORY];
    comes(1, EVENT_SAMPLE_LATE, "");
    comes(2, EVENT_SAMPLE_LATE, "");
    for (unsigned k = 3; k < 8; k++)
        comes(k, EVENT_DO_SETPOINT, "top");
    struct event e = event_make(8000, EVENT_SAMPLE_LATE, "", 0.25f, 0);
    event_log_put(&event_log, &e);
    memcpy(before, memory, sizeof before);
    TEST_ASSERT_TRUE(event_log_join(&event_log, event_log.count - 1u));
    memcpy(after, memory, sizeof after);
    for (unsigned written = 0; written <= 8; written++) {
        unsigned found = 0;
        memcpy(memory, before, sizeof memory);
        memcpy(memory, after, written * sizeof memory[0]);
        start(8);
        for (uint32_t k = 0; k < event_log.count; k++)
            found += event_log_get(&event_log, k, &e) && e.code == EVENT_DO_SETPOINT;
        TEST_ASSERT_TRUE(found >= 5);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(memory_after_a_loss_of_power_holds_no_events);
    RUN_TEST(the_last_ones_are_kept);
    RUN_TEST(everything_an_event_says_comes_back);
    RUN_TEST(what_a_record_cannot_hold_is_told_from_what_it_can);
    RUN_TEST(a_reset_keeps_them_and_marks_them_by_their_boot);
    RUN_TEST(a_reset_in_the_middle_of_any_write_costs_that_one_event);
    RUN_TEST(a_damaged_newest_event_keeps_its_place);
    RUN_TEST(a_flipped_bit_costs_one_event_and_no_other);
    RUN_TEST(of_a_run_of_repeats_the_first_and_the_latest_stand_with_the_count);
    RUN_TEST(runs_that_alternate_take_two_entries_each_in_the_order_of_time);
    RUN_TEST(what_comes_between_stays_where_it_was);
    RUN_TEST(another_subject_an_hour_or_a_start_begins_a_new_run);
    RUN_TEST(what_says_something_with_its_value_is_never_counted);
    RUN_TEST(a_reset_while_a_run_is_counted_loses_none_that_is_not_of_it);
    return UNITY_END();
}
