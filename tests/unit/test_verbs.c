/* Verbs of blocks in the tick: who runs, with what, and what refuses. The kinds are of this test alone. */
#include "verb_bench.h"

void setUp(void) {}
void tearDown(void) {}

enum { FREEZE, THAW, TUNE };

static bool verb(uint8_t block, uint8_t which, const float *number)
{
    struct request r = {.kind = REQUEST_VERB,
                        .loop = number != NULL,
                        .output = block,
                        .mode = which,
                        .plan = bench.s.plan->serial,
                        .value = number ? *number : 0.0f};
    bool done = supervisor_request(&bench.s, &r);
    bench_events();
    return done;
}

static void a_verb_acts_on_the_state_and_an_event_tells_that_it_has(void)
{
    bench_start_with(watch_and_pair);
    TEST_ASSERT_TRUE(verb(WATCH, FREEZE, NULL));
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_VERB, "block1.freeze"));
    reading(T1, 95);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 85, seen_value());
    TEST_ASSERT_TRUE(verb(WATCH, THAW, NULL));
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 95, seen_value());
}

static void its_number_reaches_it_and_so_does_that_there_is_none(void)
{
    float number = 12.5f;
    bench_start_with(watch_and_pair);
    TEST_ASSERT_TRUE(verb(WATCH, TUNE, &number));
    TEST_ASSERT_EQUAL_FLOAT(12.5f, watch_state->tuned);
    TEST_ASSERT_EQUAL_FLOAT(12.5f, last(EVENT_BLOCK_VERB)->value);
    TEST_ASSERT_TRUE(verb(WATCH, TUNE, NULL));
    TEST_ASSERT_EQUAL_FLOAT(-1, watch_state->tuned); /* none */
    TEST_ASSERT_EQUAL_UINT(2, watch_state->tunings);
}

static void what_the_block_refuses_is_told_with_its_word(void)
{
    bench_start_with(watch_and_pair);
    (void)verb(WATCH, FREEZE, NULL);
    TEST_ASSERT_FALSE(verb(WATCH, FREEZE, NULL));
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_VERB, NULL));
    TEST_ASSERT_EQUAL_STRING("frozen", last(EVENT_BLOCK_REFUSED)->subject);
    TEST_ASSERT_EQUAL_FLOAT(1, last(EVENT_BLOCK_REFUSED)->value); /* block 1 */
}

static void a_controller_is_told_also_in_manual_but_not_while_it_is_off(void)
{
    float number = 3;
    bench_start_with(watch_and_pair);
    TEST_ASSERT_TRUE(verb(PAIR, 0, &number));
    TEST_ASSERT_EQUAL_UINT(1, pair_state->tunings);
    request(REQUEST_BLOCK, PLAN_NONE, PAIR, 0, 0);
    TEST_ASSERT_FALSE(verb(PAIR, 0, &number));
    TEST_ASSERT_EQUAL_STRING("off", last(EVENT_BLOCK_REFUSED)->subject);
    TEST_ASSERT_EQUAL_UINT(1, pair_state->tunings);
    request(REQUEST_BLOCK, PLAN_NONE, PAIR, 1, 0);
    TEST_ASSERT_TRUE(verb(PAIR, 0, &number));
}

static void what_is_not_there_is_refused(void)
{
    bench_start_with(watch_and_pair);
    TEST_ASSERT_FALSE(verb(WATCH, TUNE + 1, NULL));
    TEST_ASSERT_FALSE(verb(2, 0, NULL)); /* no such block */
    TEST_ASSERT_FALSE(verb(CONFIG_BLOCKS, 0, NULL));
    TEST_ASSERT_FALSE(verb(PLAN_NONE, 0, NULL));
    TEST_ASSERT_EQUAL_UINT(4, happened(EVENT_REQUEST_REFUSED, NULL));
    strcpy(bench.config.block[WATCH].kind, "ekf"); /* a kind this build lacks */
    apply();
    TEST_ASSERT_FALSE(verb(WATCH, FREEZE, NULL));
    TEST_ASSERT_EQUAL_UINT(5, happened(EVENT_REQUEST_REFUSED, NULL));
}

static void one_that_was_asked_of_another_plan_is_refused(void)
{
    bench_start_with(watch_and_pair);
    struct request r = {
        .kind = REQUEST_VERB, .output = WATCH, .mode = FREEZE, .plan = bench.s.plan->serial};
    apply();
    TEST_ASSERT_FALSE(supervisor_request(&bench.s, &r));
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_REQUEST_REFUSED, "plan"));
    TEST_ASSERT_FALSE(watch_state->frozen);
}

static void why_a_block_is_off_is_remembered(void)
{
    bench_start_with(watch_and_pair);
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    tick();
    request(REQUEST_BLOCK, PLAN_NONE, PAIR, 0, 0);
    TEST_ASSERT_EQUAL_STRING("asked", bench.s.numbered[PAIR].gave_up);
    request(REQUEST_BLOCK, PLAN_NONE, PAIR, 1, 0);
    bad_reading(FEED, QUALITY_BAD, 0);
    ticks(4);
    TEST_ASSERT_TRUE(bench.s.block[BLOCK_NUMBERED + PAIR].off);
    TEST_ASSERT_NULL(bench.s.numbered[PAIR].gave_up); /* its input */
    TEST_ASSERT_EQUAL_UINT8(0, bench.s.numbered[PAIR].input);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_verb_acts_on_the_state_and_an_event_tells_that_it_has);
    RUN_TEST(its_number_reaches_it_and_so_does_that_there_is_none);
    RUN_TEST(what_the_block_refuses_is_told_with_its_word);
    RUN_TEST(a_controller_is_told_also_in_manual_but_not_while_it_is_off);
    RUN_TEST(what_is_not_there_is_refused);
    RUN_TEST(one_that_was_asked_of_another_plan_is_refused);
    RUN_TEST(why_a_block_is_off_is_remembered);
    return UNITY_END();
}
