/* Readings that are not valid, and what each measurement does then. */
#include "supervisor_bench.h"

void setUp(void)
{
    bench_start();
}
void tearDown(void) {}

static double value(unsigned i)
{
    return 60.0 + 100.0 * D(bench.s.measurement[i].value);
}

static void fault_is(enum measurement_fault fault)
{
    tick();
    TEST_ASSERT_EQUAL(fault, bench.s.measurement[T10].fault);
    TEST_ASSERT_EQUAL(fault != MEASUREMENT_FINE, bench.s.measurement[T10].alarm);
}

static void in_auto(void)
{
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
    bench_forget_events();
}

/* ---- detection ---- */

static void each_kind_of_fault_is_told_apart(void)
{
    set_and_apply("meas2.rate_limit", "1");
    set_and_apply("meas2.frozen", "20");
    bad_reading(T10, QUALITY_MISSING, 0);
    fault_is(MEASUREMENT_MISSING);
    bad_reading(T10, QUALITY_BAD, 115);
    fault_is(MEASUREMENT_FLAGGED);
    bad_reading(T10, QUALITY_GOOD, (double)NAN);
    fault_is(MEASUREMENT_NOT_A_NUMBER);
    bad_reading(T10, QUALITY_GOOD, (double)INFINITY);
    fault_is(MEASUREMENT_NOT_A_NUMBER);
    reading(T10, 171);
    fault_is(MEASUREMENT_OUT_OF_RANGE);
    reading(T10, 150);
    fault_is(MEASUREMENT_TOO_FAST);
    reading(T10, 115);
    fault_is(MEASUREMENT_FINE);
    ticks(19);
    fault_is(MEASUREMENT_FROZEN);
    TEST_ASSERT_EQUAL(2, happened(EVENT_MEASUREMENT_BAD, "T10"));
    TEST_ASSERT_EQUAL(1, happened(EVENT_MEASUREMENT_GOOD, "T10"));
}

static void a_spike_is_over_with_the_next_reading(void)
{
    set_and_apply("meas2.rate_limit", "0.5");
    reading(T10, 140);
    fault_is(MEASUREMENT_TOO_FAST);
    ASSERT_NO_BUMP(0.55, D(bench.s.measurement[T10].value));
    reading(T10, 115.9); /* two seconds since the last valid one */
    fault_is(MEASUREMENT_FINE);
}

static void a_true_jump_is_valid_once_there_was_time_for_it(void)
{
    set_and_apply("meas2.rate_limit", "1");
    reading(T10, 119.5);
    for (unsigned n = 0; n < 4; n++)
        fault_is(MEASUREMENT_TOO_FAST);
    fault_is(MEASUREMENT_FINE);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 119.5, value(T10));
}

static void a_steady_reading_is_frozen_only_after_its_time_and_thaws_with_the_least_change(void)
{
    set_and_apply("meas2.frozen", "30");
    ticks(20);
    reading(T10, 115.001);
    ticks(30);
    TEST_ASSERT_FALSE(bench.s.measurement[T10].alarm);
    fault_is(MEASUREMENT_FROZEN);
    reading(T10, 115.0);
    fault_is(MEASUREMENT_FINE);
}

static void without_limits_neither_speed_nor_rest_is_a_fault(void)
{
    ticks(1000);
    reading(T10, 159);
    fault_is(MEASUREMENT_FINE);
}

/* ---- fall-back ---- */

static void hold_keeps_the_value_for_its_time_then_goes_to_manual(void)
{
    in_auto();
    bad_reading(T10, QUALITY_BAD, 0);
    ticks(10);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, bench.s.measurement[T10].quality);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
    tick();
    TEST_ASSERT_EQUAL(QUALITY_BAD, bench.s.measurement[T10].quality);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_EQUAL(SUPERVISOR_RUN, bench.s.state);
}

static void manual_does_not_wait(void)
{
    set_and_apply("meas2.fallback", "manual");
    in_auto();
    double before = sent(HEAT);
    bad_reading(T10, QUALITY_BAD, 0);
    tick();
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
    ASSERT_NO_BUMP(before, sent(HEAT));
}

static void a_substitute_stands_in_after_the_hold_for_as_long_as_it_lasts(void)
{
    put("meas2.substitute", "110");
    set_and_apply("meas2.fallback", "substitute");
    in_auto();
    bad_reading(T10, QUALITY_BAD, 0);
    ticks(10);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 115, value(T10));
    ticks(500);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 110, value(T10));
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, bench.s.measurement[T10].quality);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_TRUE(bench.s.measurement[T10].alarm);
}

static void safe_takes_the_safe_state_once_and_lets_the_operator_go_on(void)
{
    set_and_apply("meas2.fallback", "safe");
    in_auto();
    mode(TOP, LOOP_AUTO);
    bad_reading(T10, QUALITY_BAD, 0);
    ticks(10);
    TEST_ASSERT_EQUAL(SUPERVISOR_RUN, bench.s.state);
    tick();
    TEST_ASSERT_EQUAL(SUPERVISOR_SAFE, bench.s.state);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[TOP].mode);
    TEST_ASSERT_EQUAL(1, happened(EVENT_SAFE_STATE, "T10"));
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
    TEST_ASSERT_TRUE(
        quality_usable(bench.s.measurement[T1].quality)); /* the others are as they were */
    mode(TOP, LOOP_AUTO);
    ticks(20);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
    TEST_ASSERT_EQUAL(1, happened(EVENT_SAFE_STATE, NULL));
}

static void a_dead_flowmeter_is_replaced_by_its_valve(void)
{
    /* 0.1 + 0.9 x the valve's 5 l/h */
    set_and_apply("meas3.infer", "reflux");
    set_and_apply("meas3.infer_gain", "0.9");
    set_and_apply("meas3.infer_offset", "0.1");
    bad_reading(FEED, QUALITY_MISSING, 0);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.46, D(bench.s.measurement[FEED].value));
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, bench.s.measurement[FEED].quality);
    out(TOP, 8);
    ticks(500); /* longer than any hold */
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.73, D(bench.s.measurement[FEED].value));
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, bench.s.measurement[FEED].quality);
    reading(FEED, 7);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.7, D(bench.s.measurement[FEED].value));
    TEST_ASSERT_EQUAL(QUALITY_GOOD, bench.s.measurement[FEED].quality);
}

/* 120 by the heater, where the sensor says 115. */
static void neither_inference_nor_the_return_from_it_moves_an_output(void)
{
    put_all((const char *const[]){"meas2.infer", "heat", "meas2.infer_gain", "20",
                                  "meas2.infer_offset", "100", "meas2.filter", "30", NULL});
    apply();
    in_auto();
    ticks(5);
    double before = sent(HEAT);
    bad_reading(T10, QUALITY_MISSING, 0);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.6, D(bench.s.measurement[T10].value));
    ASSERT_NO_BUMP(before, sent(HEAT));
    ticks(3);
    before = sent(HEAT);
    reading(T10, 115);
    tick();
    TEST_ASSERT_EQUAL(QUALITY_GOOD, bench.s.measurement[T10].quality);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.55, D(bench.s.measurement[T10].value));
    ASSERT_NO_BUMP(before, sent(HEAT));
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
}

static void what_cannot_be_inferred_falls_back_as_declared(void)
{
    set_and_apply("meas2.infer", "heat");
    set_and_apply("meas2.infer_gain", "1000"); /* far outside the span */
    in_auto();
    bad_reading(T10, QUALITY_BAD, 0);
    ticks(11);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
}

static void a_value_that_stands_in_satisfies_no_interlock(void)
{
    static const char *const kinds[] = {"substitute", "infer"};
    for (unsigned k = 0; k < 2; k++) {
        bench_start();
        put_all((const char *const[]){"lock1.meas", "T10", "lock1.mv", "heat", "lock1.limit", "140",
                                      "lock1.value", "0", NULL});
        if (k == 0)
            put_all((const char *const[]){"meas2.fallback", "substitute", "meas2.substitute", "110",
                                          NULL});
        else
            put_all(
                (const char *const[]){"meas2.infer", "heat", "meas2.infer_offset", "100", NULL});
        apply();
        in_auto();
        bad_reading(T10, QUALITY_BAD, 0);
        ticks(12);
        TEST_ASSERT_EQUAL_MESSAGE(1, happened(EVENT_INTERLOCK_ON, "heat"), kinds[k]);
        TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
    }
}

/* ---- read-back ---- */

static void not_following_is_an_alarm_only_after_its_delay_but_works_at_once(void)
{
    set_and_apply("mv2.follow", "5");
    bench.input.readback[HEAT] = (struct reading){0.5f, QUALITY_GOOD};
    tick();
    TEST_ASSERT_TRUE(bench.s.mv[HEAT].not_following);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, D(bench.s.mv[HEAT].applied));
    ticks(4);
    TEST_ASSERT_EQUAL(0, happened(EVENT_NOT_FOLLOWING, NULL));
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_NOT_FOLLOWING, "heat"));
    bench.input.readback[HEAT].value = 1.0f;
    ticks(2);
    TEST_ASSERT_EQUAL(1, happened(EVENT_FOLLOWING, "heat"));
}

static void a_valve_that_is_late_within_the_delay_is_no_alarm(void)
{
    set_and_apply("mv2.follow", "5");
    for (unsigned n = 0; n < 30; n++) {
        bench.input.readback[HEAT] = (struct reading){n % 5 == 4 ? 1.0f : 0.5f, QUALITY_GOOD};
        tick();
    }
    TEST_ASSERT_EQUAL(0, happened(EVENT_NOT_FOLLOWING, NULL));
}

/* ---- interlocks ---- */

static void in_cascade(void)
{
    bench_start_with(bench_cascade);
    mode(BOTTOM, LOOP_CASCADE);
    mode(OUTER, LOOP_AUTO);
}
static void manual_moved_by_hand(void)
{
    out(BOTTOM, 1.9);
}
static void automatic(void)
{
    mode(BOTTOM, LOOP_AUTO);
}
static void saturated(void)
{
    mode(BOTTOM, LOOP_AUTO);
    setpoint(BOTTOM, 160);
    ticks(2000);
}
static void safe_state(void)
{
    set_and_apply("mv2.safe", "1.5");
    supervisor_go_safe(&bench.s, "test");
}
static void under_new_plans(void)
{
    automatic();
    set_and_apply("mv2.rate", "0.0001");
    set_and_apply("mv2.min", "0.7");
}

static void no_mode_overrides_an_interlock(void)
{
    void (*const modes[])(void) = {manual_moved_by_hand, automatic,      in_cascade, saturated,
                                   safe_state,           under_new_plans};
    for (unsigned k = 0; k < sizeof modes / sizeof modes[0]; k++) {
        bench_start();
        modes[k]();
        put_all((const char *const[]){"lock1.meas", "T1", "lock1.mv", "heat", "lock1.limit", "95",
                                      "lock1.value", "0.2", NULL});
        apply();
        ticks(2);
        reading(T1, 96);
        for (unsigned n = 0; n < 50; n++) {
            tick();
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, sent(HEAT));
            if (n == 10)
                out(BOTTOM, 2);
            if (n == 20)
                mode(BOTTOM, LOOP_AUTO);
            if (n == 30)
                mode(BOTTOM, LOOP_MANUAL);
            if (n == 40)
                supervisor_outputs_safe(&bench.s, "test");
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(each_kind_of_fault_is_told_apart);
    RUN_TEST(a_spike_is_over_with_the_next_reading);
    RUN_TEST(a_true_jump_is_valid_once_there_was_time_for_it);
    RUN_TEST(a_steady_reading_is_frozen_only_after_its_time_and_thaws_with_the_least_change);
    RUN_TEST(without_limits_neither_speed_nor_rest_is_a_fault);
    RUN_TEST(hold_keeps_the_value_for_its_time_then_goes_to_manual);
    RUN_TEST(manual_does_not_wait);
    RUN_TEST(a_substitute_stands_in_after_the_hold_for_as_long_as_it_lasts);
    RUN_TEST(safe_takes_the_safe_state_once_and_lets_the_operator_go_on);
    RUN_TEST(a_dead_flowmeter_is_replaced_by_its_valve);
    RUN_TEST(neither_inference_nor_the_return_from_it_moves_an_output);
    RUN_TEST(what_cannot_be_inferred_falls_back_as_declared);
    RUN_TEST(a_value_that_stands_in_satisfies_no_interlock);
    RUN_TEST(not_following_is_an_alarm_only_after_its_delay_but_works_at_once);
    RUN_TEST(a_valve_that_is_late_within_the_delay_is_no_alarm);
    RUN_TEST(no_mode_overrides_an_interlock);
    return UNITY_END();
}
