/* Measurements: range, quality, holding, filters, alarms. */
#include "supervisor_bench.h"

void setUp(void)
{
    bench_start();
}
void tearDown(void) {}

static double value_of(unsigned i)
{
    return D(bench.s.measurement[i].value);
}

static void a_good_reading_is_a_fraction_of_its_span(void)
{
    reading(T1, 110);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, value_of(T1));
    TEST_ASSERT_EQUAL(QUALITY_GOOD, bench.s.measurement[T1].quality);
}

static void a_reading_just_outside_its_span_is_uncertain_but_used(void)
{
    reading(T1, 165);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.05, value_of(T1));
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, bench.s.measurement[T1].quality);
    TEST_ASSERT_EQUAL(0, happened(EVENT_MEASUREMENT_BAD, NULL));
}

static void what_no_instrument_can_mean_is_held_and_reported_once(void)
{
    static const struct {
        double value;
        enum quality quality;
    } bad[] = {{(double)NAN, QUALITY_GOOD}, {(double)INFINITY, QUALITY_GOOD},
               {-1e30, QUALITY_GOOD},       {400, QUALITY_GOOD},
               {90, QUALITY_BAD},           {0, QUALITY_MISSING}};
    for (unsigned k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        bench_start();
        mode(TOP, LOOP_AUTO);
        tick();
        bad_reading(T1, bad[k].quality, bad[k].value);
        ticks(10);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, value_of(T1));
        TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, bench.s.measurement[T1].quality);
        TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
        TEST_ASSERT_EQUAL(1, happened(EVENT_MEASUREMENT_BAD, "T1"));
        ASSERT_NO_BUMP(0.5, sent(REFLUX));
    }
}

static void after_its_hold_time_the_loops_on_a_bad_measurement_go_to_manual(void)
{
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    tick();
    bad_reading(T1, QUALITY_BAD, 0);
    ticks(12);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[TOP].mode);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_EQUAL(QUALITY_BAD, bench.s.measurement[T1].quality);
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    mode(TOP, LOOP_AUTO);
    TEST_ASSERT_EQUAL(1, happened(EVENT_MODE_REFUSED, "top"));
}

static void a_hold_time_of_zero_holds_nothing(void)
{
    set_and_apply("meas1.hold", "0");
    mode(TOP, LOOP_AUTO);
    tick();
    bad_reading(T1, QUALITY_BAD, 0);
    tick();
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[TOP].mode);
}

static void a_measurement_that_comes_back_is_reported_and_its_loop_stays_in_manual(void)
{
    mode(TOP, LOOP_AUTO);
    tick();
    bad_reading(T1, QUALITY_BAD, 0);
    ticks(20);
    reading(T1, 90);
    ticks(5);
    TEST_ASSERT_EQUAL(1, happened(EVENT_MEASUREMENT_GOOD, "T1"));
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[TOP].mode);
}

static void a_short_dropout_leaves_no_trace_in_the_output(void)
{
    mode(TOP, LOOP_AUTO);
    tick();
    bad_reading(T1, QUALITY_MISSING, 0);
    ticks(5);
    reading(T1, 85);
    tick();
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
}

static void a_filter_goes_the_first_order_way_and_begins_at_the_first_reading(void)
{
    set_and_apply("meas1.filter", "9");
    reading(T1, 95);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.26, value_of(T1));
    supervisor_go_safe(&bench.s, "plant"); /* another plant may follow */
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.35, value_of(T1));
}

static void a_filter_does_not_remember_what_was_before_a_long_absence(void)
{
    set_and_apply("meas1.filter", "100");
    bad_reading(T1, QUALITY_MISSING, 0);
    ticks(20);
    reading(T1, 130);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.7, value_of(T1));
}

static void a_measurement_the_plant_does_not_have_is_missing_without_an_alarm(void)
{
    supervisor_unbind(&bench.s);
    tick();
    TEST_ASSERT_EQUAL(QUALITY_MISSING, bench.s.measurement[T1].quality);
    TEST_ASSERT_EQUAL(0, happened(EVENT_MEASUREMENT_BAD, NULL));
}

static void plant_time_that_jumps_back_does_not_lengthen_the_hold(void)
{
    mode(TOP, LOOP_AUTO);
    tick();
    bench.input.time_ms = 0;
    bad_reading(T1, QUALITY_BAD, 0);
    tick();
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[TOP].mode);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_good_reading_is_a_fraction_of_its_span);
    RUN_TEST(a_reading_just_outside_its_span_is_uncertain_but_used);
    RUN_TEST(what_no_instrument_can_mean_is_held_and_reported_once);
    RUN_TEST(after_its_hold_time_the_loops_on_a_bad_measurement_go_to_manual);
    RUN_TEST(a_hold_time_of_zero_holds_nothing);
    RUN_TEST(a_measurement_that_comes_back_is_reported_and_its_loop_stays_in_manual);
    RUN_TEST(a_short_dropout_leaves_no_trace_in_the_output);
    RUN_TEST(a_filter_goes_the_first_order_way_and_begins_at_the_first_reading);
    RUN_TEST(a_filter_does_not_remember_what_was_before_a_long_absence);
    RUN_TEST(a_measurement_the_plant_does_not_have_is_missing_without_an_alarm);
    RUN_TEST(plant_time_that_jumps_back_does_not_lengthen_the_hold);
    return UNITY_END();
}
