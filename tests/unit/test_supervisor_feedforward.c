/* Feedforward from another manipulated variable, inside the supervisor: what it looks at, when, and who may feed whom.
 * Feedforward from a measurement: test_supervisor_decoupler.c. */
#include "supervisor_bench.h"

void setUp(void) {}
void tearDown(void) {}

/* Half of what reflux is moved goes to heat; reflux 5 of 10 calls for nothing. */
static void from_reflux(void)
{
    put_all((const char *const[]){"ff1.from", "reflux", "ff1.to", "heat", "ff1.gain", "0.5",
                                  "ff1.reference", "5", NULL});
}

static void bottom_in_automatic(void (*more)(void))
{
    bench_start_with(more);
    mode(BOTTOM, LOOP_AUTO);
    tick();
}

static void a_move_of_one_input_reaches_the_other_a_tick_later(void)
{
    bottom_in_automatic(from_reflux);
    out(TOP, 6);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.6, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.5, sent(HEAT));
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.55, sent(HEAT));
}

static void what_counts_is_what_was_sent_not_what_was_wanted(void)
{
    bottom_in_automatic(from_reflux);
    put_all((const char *const[]){"mv1.max", "7", "lock1.meas", "feed", "lock1.mv", "reflux",
                                  "lock1.limit", "9", "lock1.value", "2", NULL});
    apply();
    mode(TOP, LOOP_AUTO);
    reading(T1, 155); /* far too hot: all the reflux there is */
    ticks(300);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.7, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.6, sent(HEAT));
    reading(FEED, 10); /* and then none of it */
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.2, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.35, sent(HEAT));
}

static void a_read_back_that_differs_is_what_the_plant_got(void)
{
    bottom_in_automatic(from_reflux);
    bench.input.readback[REFLUX] = (struct reading){8.0f, QUALITY_GOOD};
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.65, sent(HEAT));
}

static void an_input_without_a_loop_may_be_fed_forward_too(void)
{
    bench_start();
    put_all((const char *const[]){"ff1.from", "spare", "ff1.to", "heat", "ff1.gain", "-1", NULL});
    put("mv3.hi", "4");
    put("mv3.max", "4");
    apply();
    mode(BOTTOM, LOOP_AUTO);
    tick();
    request(REQUEST_OUTPUT, PLAN_NONE, SPARE, 0, 1);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.25, sent(HEAT));
}

static void an_input_the_plant_does_not_have_calls_for_nothing(void)
{
    bottom_in_automatic(from_reflux);
    put("ff1.from", "spare");
    put("ff1.reference", "1");
    apply();
    bench.s.mv[SPARE].bound = false;
    ticks(3);
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    TEST_ASSERT_TRUE(num_eq(bench.s.loop[BOTTOM].feedforward, num_zero()));
}

/* Its last value would stand for ever. */
static void a_measurement_that_the_plant_has_lost_calls_for_nothing(void)
{
    bottom_in_automatic(from_reflux);
    put("ff1.from", "feed");
    put("ff1.reference", "0");
    apply();
    reading(FEED, 5);
    ticks(3);
    TEST_ASSERT_FALSE(num_eq(bench.s.loop[BOTTOM].feedforward, num_zero()));
    bench.s.measurement[FEED].bound = false;
    ticks(3);
    TEST_ASSERT_TRUE(num_eq(bench.s.loop[BOTTOM].feedforward, num_zero()));
}

static void it_goes_and_comes_without_a_bump_with_the_input_it_looks_at(void)
{
    bottom_in_automatic(from_reflux);
    out(TOP, 9);
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.7, sent(HEAT));
    bench.s.mv[REFLUX].bound = false;
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(BUMP, 0.7, sent(HEAT));
    bench.s.mv[REFLUX].bound = true; /* it has waited at its safe value, 0 */
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(BUMP, 0.7, sent(HEAT));
    out(TOP, 2);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.8, sent(HEAT)); /* and works again */
}

static void it_begins_changes_and_goes_without_a_bump(void)
{
    static const char *const changes[][2] = {
        {"ff1.gain", "0.1"},    {"ff1.reference", "2"}, {"ff1.lag", "30"}, {"ff1.dead", "20"},
        {"ff1.to", "reflux"},   {"ff1.from", "-"},      {"ff1.lo", "0"},   {"ff1.from", "T1"},
        {"ff2.from", "reflux"}, {"mv1.lo", "-10"},      {"mv1.hi", "12"}};
    for (unsigned k = 0; k < sizeof changes / sizeof changes[0]; k++) {
        bottom_in_automatic(from_reflux);
        put_all((const char *const[]){"ff2.to", "heat", "ff2.gain", "-0.3", NULL});
        out(TOP, 7);
        ticks(5);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.6, sent(HEAT));
        if (strcmp(changes[k][1], "reflux") == 0)
            put("ff1.from", "feed"); /* what feeds itself is refused: test_plan.c */
        if (strcmp(changes[k][0], "ff2.from") == 0)
            put("ff1.from", "reflux");
        double heat = sent(HEAT);
        set_and_apply(changes[k][0], changes[k][1]);
        tick();
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(BUMP, heat, sent(HEAT), changes[k][0]);
        tick();
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(2e-5, heat, sent(HEAT), changes[k][0]);
    }
}

static void automatic_begins_without_a_bump(void)
{
    bench_start_with(from_reflux);
    out(TOP, 9);
    ticks(3);
    mode(BOTTOM, LOOP_AUTO);
    tick();
    ASSERT_NO_BUMP(0.5, sent(HEAT));
}

static void corrections_go_on_from_input_to_input_a_tick_each(void)
{
    bench_start();
    put_all((const char *const[]){"ff1.from",   "reflux", "ff1.to",   "heat",  "ff1.gain",   "0.5",
                                  "ff2.from",   "heat",   "ff2.to",   "spare", "ff2.gain",   "0.5",
                                  "loop3.name", "more",   "loop3.pv", "T5",    "loop3.gain", "0.1",
                                  "loop3.ti",   "0",      NULL});
    put_all((const char *const[]){"loop3.out", "spare", "mv3.hi", "1", "mv3.max", "1", NULL});
    apply();
    mode(BOTTOM, LOOP_AUTO);
    mode(OUTER, LOOP_AUTO);
    ticks(2);
    double spare = sent(SPARE);
    out(TOP, 7);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.6, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, spare, sent(SPARE));
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, spare + 0.05, sent(SPARE));
}

static void an_input_that_is_sent_to_its_safe_value_lets_loops_begin_without_a_bump(void)
{
    bottom_in_automatic(from_reflux);
    out(TOP, 8);
    ticks(3);
    supervisor_go_safe(&bench.s, "for this test");
    ticks(2);
    out(BOTTOM, 1);
    tick();
    mode(BOTTOM, LOOP_AUTO);
    tick();
    ASSERT_NO_BUMP(0.5, sent(HEAT));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_move_of_one_input_reaches_the_other_a_tick_later);
    RUN_TEST(what_counts_is_what_was_sent_not_what_was_wanted);
    RUN_TEST(a_read_back_that_differs_is_what_the_plant_got);
    RUN_TEST(an_input_without_a_loop_may_be_fed_forward_too);
    RUN_TEST(an_input_the_plant_does_not_have_calls_for_nothing);
    RUN_TEST(a_measurement_that_the_plant_has_lost_calls_for_nothing);
    RUN_TEST(it_goes_and_comes_without_a_bump_with_the_input_it_looks_at);
    RUN_TEST(it_begins_changes_and_goes_without_a_bump);
    RUN_TEST(automatic_begins_without_a_bump);
    RUN_TEST(corrections_go_on_from_input_to_input_a_tick_each);
    RUN_TEST(an_input_that_is_sent_to_its_safe_value_lets_loops_begin_without_a_bump);
    return UNITY_END();
}
