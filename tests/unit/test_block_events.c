/* Events of blocks: an event for each occurrence, and alarms on it. The kinds are of this test alone. */
#include "plan/plan_build.h"
#include "settings/block_pool.h"
#include "verb_bench.h"

void setUp(void)
{
    pair_is_spent = pair_gives_up = false;
}
void tearDown(void) {}

/* T1 is 85 of 60 .. 160; the limit is half of that, 110. */
static void alarmed(void)
{
    watch_and_pair();
    put("alarm1.on", "block1.high");
}

static void an_event_is_told_once_for_each_occurrence_with_its_value(void)
{
    bench_start_with(watch_and_pair);
    reading(T1, 120);
    ticks(5);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_ALARM, "block1.high"));
    TEST_ASSERT_EQUAL_FLOAT(0.6f, last(EVENT_BLOCK_ALARM)->value);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_EVENT, "block1.crossed"));
    TEST_ASSERT_TRUE(block_kinds[last(EVENT_BLOCK_ALARM)->detail] == &watch_kind);
    reading(T1, 100);
    ticks(5);
    TEST_ASSERT_EQUAL_UINT(2, happened(EVENT_BLOCK_EVENT, "block1.crossed"));
    reading(T1, 120);
    ticks(5);
    TEST_ASSERT_EQUAL_UINT(2, happened(EVENT_BLOCK_ALARM, "block1.high"));
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_ALARM_ON, NULL)); /* no entry asks for one */
}

static void an_alarm_on_it_is_listed_latched_and_acknowledged_like_any_other(void)
{
    bench_start_with(alarmed);
    put("alarm1.latch", "on");
    apply();
    reading(T1, 120);
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_ON, "block1.high"));
    TEST_ASSERT_EQUAL_FLOAT(0.6f, last(EVENT_ALARM_ON)->value);
    reading(T1, 100);
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_OFF, "block1.high"));
    TEST_ASSERT_TRUE(bench.s.alarm[0].listed);
    request(REQUEST_ACK, PLAN_NONE, 0, 0, 0);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_ACK, "block1.high"));
    TEST_ASSERT_FALSE(bench.s.alarm[0].listed);
}

static void its_delay_counts_and_its_limit_does_not(void)
{
    bench_start_with(alarmed);
    put_all((const char *const[]){"alarm1.delay", "3", "alarm1.limit", "1e6", "alarm1.side", "lo",
                                  NULL});
    apply();
    reading(T1, 120);
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_ALARM_ON, NULL));
    reading(T1, 130);
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_ON, "block1.high"));
    TEST_ASSERT_EQUAL_FLOAT(0.7f, last(EVENT_ALARM_ON)->value); /* the latest */
}

static void a_shelved_one_is_silent_and_comes_on_anew(void)
{
    bench_start_with(alarmed);
    request(REQUEST_SHELVE, PLAN_NONE, 0, 0, 5);
    reading(T1, 120);
    ticks(4);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_ALARM_ON, NULL));
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_ON, "block1.high"));
}

static void a_momentary_one_comes_and_goes_and_is_kept_by_its_latch(void)
{
    bench_start_with(alarmed);
    put_all((const char *const[]){"alarm1.on", "block1.crossed", "alarm1.latch", "on", NULL});
    apply();
    reading(T1, 120);
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_ON, "block1.crossed"));
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_OFF, "block1.crossed"));
    TEST_ASSERT_TRUE(bench.s.alarm[0].listed);
}

static void pair_alarmed(void)
{
    watch_and_pair();
    put("alarm2.on", "block2.spent");
}

static void both_auto(void)
{
    bench_start_with(pair_alarmed);
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    tick();
}

static void a_block_that_makes_no_steps_raises_nothing(void)
{
    both_auto();
    pair_is_spent = true;
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_ON, "block2.spent"));
    mode(TOP, LOOP_MANUAL);
    tick();
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_ALARM_OFF, NULL)); /* the other still acts */
    mode(BOTTOM, LOOP_MANUAL);
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_OFF, "block2.spent"));
    mode(TOP, LOOP_AUTO);
    tick();
    TEST_ASSERT_EQUAL_UINT(2, happened(EVENT_BLOCK_ALARM, "block2.spent"));
    request(REQUEST_BLOCK, PLAN_NONE, PAIR, 0, 0);
    tick();
    TEST_ASSERT_EQUAL_UINT(2, happened(EVENT_ALARM_OFF, "block2.spent"));
}

static void what_it_raised_when_it_gave_up_stays_until_it_is_on_again(void)
{
    both_auto();
    pair_is_spent = pair_gives_up = true;
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_GAVE_UP, "spent"));
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_ALARM, "block2.spent"));
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_ON, "block2.spent"));
    mode(TOP, LOOP_MANUAL);
    mode(BOTTOM, LOOP_MANUAL);
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_ALARM_OFF, NULL));
    request(REQUEST_BLOCK, PLAN_NONE, PAIR, 1, 0);
    pair_is_spent = pair_gives_up = false;
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_OFF, "block2.spent"));
}

static void what_it_raised_ends_when_it_gives_up_without_an_input(void)
{
    both_auto();
    pair_is_spent = true;
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_ON, "block2.spent"));
    bad_reading(FEED, QUALITY_BAD, 0);
    ticks(4); /* held for 2 s */
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_GAVE_UP, "feed"));
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_OFF, "block2.spent"));
    reading(FEED, 5);
    tick();
    request(REQUEST_BLOCK, PLAN_NONE, PAIR, 1, 0);
    tick();
    TEST_ASSERT_EQUAL_UINT(2, happened(EVENT_BLOCK_ALARM, "block2.spent"));
}

static void without_its_second_input_it_gives_up_for_that(void)
{
    bench_start_with(watch_and_pair);
    put_block(PAIR, "pair", "top bottom", "T5 feed", "");
    apply();
    mode(TOP, LOOP_AUTO);
    tick();
    bad_reading(FEED, QUALITY_BAD, 0);
    ticks(4); /* held for 2 s */
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_GAVE_UP, "feed"));
    TEST_ASSERT_NULL(bench.s.numbered[PAIR].gave_up);
    TEST_ASSERT_EQUAL_UINT8(1, bench.s.numbered[PAIR].input);
}

static void what_another_block_raised_in_its_place_is_forgotten(void)
{
    bench_start_with(alarmed);
    reading(T1, 120);
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_ON, "block1.high"));
    strcpy(bench.config.block[WATCH].inputs, "T10"); /* another block, as far as states go: 115 */
    reading(T10, 100);
    apply();
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_OFF, "block1.high"));
}

static void refused(const char *on)
{
    struct config_fault fault;
    struct plan *next = &bench.plan[1 - bench.current];
    put("alarm1.on", on);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_UNKNOWN, plan_build(next, &bench.config, 1.0f, &fault), on);
    TEST_ASSERT_EQUAL_STRING("alarm", fault.group);
    TEST_ASSERT_EQUAL_STRING("on", fault.field);
    TEST_ASSERT_EQUAL_STRING(on, fault.subject);
}

static void an_alarm_on_what_no_block_says_is_refused(void)
{
    bench_start_with(watch_and_pair);
    refused("block1.spent");
    refused("block1.");
    refused("block1.highe");
    refused("block3.high");
    refused("block9.high");
    refused("block0.high");
    refused("block");
    refused("T1.high");
    refused(".");
}

static void one_on_a_kind_that_this_build_lacks_is_kept_and_waits(void)
{
    bench_start_with(alarmed);
    TEST_ASSERT_TRUE(record_restore(&bench.config, WATCH, "watch"));
    strcpy(bench.config.block[WATCH].kind, "ekf");
    apply();
    reading(T1, 120);
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_ALARM_ON, NULL));
    TEST_ASSERT_EQUAL_STRING("block1.high", bench.s.plan->config.alarm[0].on);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_event_is_told_once_for_each_occurrence_with_its_value);
    RUN_TEST(an_alarm_on_it_is_listed_latched_and_acknowledged_like_any_other);
    RUN_TEST(its_delay_counts_and_its_limit_does_not);
    RUN_TEST(a_shelved_one_is_silent_and_comes_on_anew);
    RUN_TEST(a_momentary_one_comes_and_goes_and_is_kept_by_its_latch);
    RUN_TEST(a_block_that_makes_no_steps_raises_nothing);
    RUN_TEST(what_it_raised_when_it_gave_up_stays_until_it_is_on_again);
    RUN_TEST(what_it_raised_ends_when_it_gives_up_without_an_input);
    RUN_TEST(without_its_second_input_it_gives_up_for_that);
    RUN_TEST(what_another_block_raised_in_its_place_is_forgotten);
    RUN_TEST(an_alarm_on_what_no_block_says_is_refused);
    RUN_TEST(one_on_a_kind_that_this_build_lacks_is_kept_and_waits);
    return UNITY_END();
}
