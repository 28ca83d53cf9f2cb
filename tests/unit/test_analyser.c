/* Measurements that come every n-th tick, some time after they were sampled. T1 is the analyser: a sample every 5 ticks of
 * 1 s, in ticks 2, 7, 12 ... of plant time, each sampled 3 ticks before. */
#include "exchange/sampling.h"
#include "plan/plan_build.h"
#include "supervisor_bench.h"

static void analyser(void)
{
    put_all(
        (const char *const[]){"meas1.every", "5", "meas1.phase", "2", "meas1.delay", "3", NULL});
}

/* The bench has made 4 ticks: plant time is 4 s, the sample that stands is that of 2 s. */
void setUp(void)
{
    bench_start_with(analyser);
}
void tearDown(void) {}

static double value(unsigned i)
{
    return 60.0 + 100.0 * D(bench.s.measurement[i].value);
}

static void stands_at(double x)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, x, value(T1));
    TEST_ASSERT_EQUAL(QUALITY_GOOD, bench.s.measurement[T1].quality);
}

/* Up to the tick in which the next sample comes. */
static void next_sample(void)
{
    do
        tick();
    while (bench.input.time_ms % 5000 != 2000);
}

/* ---- when a sample is taken, and when it was one ---- */

static void between_two_samples_the_value_stands_and_is_good(void)
{
    reading(T1, 90);
    ticks(2); /* 6 s */
    stands_at(85);
    tick();
    stands_at(90);
    reading(T1, 95);
    ticks(4);
    stands_at(90);
    tick();
    stands_at(95);
}

static void what_comes_in_every_tick_is_not_touched_by_it(void)
{
    reading(T10, 110);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 110, value(T10));
    TEST_ASSERT_EQUAL_UINT64(bench.s.time_ms, sampling_at_ms(&bench.s, T10));
}

static void the_time_of_sampling_is_kept_whenever_it_is_asked_for(void)
{
    next_sample(); /* 7 s */
    for (int k = 0; k < 5; k++) {
        TEST_ASSERT_EQUAL_UINT64(4000, sampling_at_ms(&bench.s, T1));
        tick();
    }
    TEST_ASSERT_EQUAL_UINT64(9000, sampling_at_ms(&bench.s, T1));
}

static void after_a_start_the_number_that_stands_is_taken_with_its_true_age(void)
{
    bench.tick_ms = 1000;
    bench.input.time_ms = 1003000; /* 1004 s with the next tick: the sample of 1002 s stands */
    supervisor_go_safe(&bench.s, "plant");
    reading(T1, 92);
    tick();
    stands_at(92);
    TEST_ASSERT_EQUAL_UINT64(999000, sampling_at_ms(&bench.s, T1));
}

static void after_silence_within_a_turn_the_number_is_taken_at_once(void)
{
    supervisor_go_safe(&bench.s, "plant");
    TEST_ASSERT_FALSE(bench.s.measurement[T1].seen);
    tick(); /* 5 s: still that of 2 s */
    stands_at(85);
    TEST_ASSERT_EQUAL_UINT64(0, sampling_at_ms(&bench.s, T1));
}

static void a_clock_that_misses_the_base_tick_by_a_little_changes_nothing(void)
{
    static const int off[] = {0, 3, -3, 1, -2, 0, 3, -3, 2, -1, 0, 3, -3, 3, -3};
    for (unsigned k = 0; k < sizeof off / sizeof off[0]; k++) {
        bench.input.time_ms = (uint64_t)(4000 + 1000 * (int)k + off[k]); /* the bench adds a tick */
        reading(T1, 90 + k);
        tick();
        stands_at(k < 2 ? 85 : 90 + (k - (k - 2) % 5)); /* 7, 12, 17 s */
    }
}

static void a_sample_whose_tick_was_lost_is_taken_in_the_next_and_dated_rightly(void)
{
    ticks(2); /* 6 s; 7 s and 8 s are lost */
    bench.input.time_ms += 2000;
    reading(T1, 90);
    tick();
    stands_at(90);
    TEST_ASSERT_EQUAL_UINT64(4000, sampling_at_ms(&bench.s, T1));
    reading(T1, 91);
    ticks(2);
    stands_at(90);
    tick(); /* 12 s: the turn of the next is as it was */
    stands_at(91);
}

static void every_n_th_tick_is_counted_far_from_the_beginning_too(void)
{
    bench.input.time_ms =
        UINT64_C(5000000000001000); /* ticks beyond 32 bits; of 2 mod 5 with the next */
    reading(T1, 90);
    tick();
    stands_at(90);
    reading(T1, 91);
    ticks(4);
    stands_at(90);
    tick();
    stands_at(91);
}

/* ---- what does not come, or is not valid ---- */

static void a_sample_that_does_not_come_is_missing_and_found_when_it_comes_late(void)
{
    bad_reading(T1, QUALITY_MISSING, 0);
    ticks(2);
    stands_at(85); /* nobody has looked */
    tick();
    TEST_ASSERT_EQUAL(MEASUREMENT_MISSING, bench.s.measurement[T1].fault);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, bench.s.measurement[T1].quality);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_MEASUREMENT_BAD, "T1"));
    reading(T1, 90);
    tick(); /* 8 s */
    stands_at(90);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_MEASUREMENT_GOOD, "T1"));
    TEST_ASSERT_EQUAL_UINT64(4000, sampling_at_ms(&bench.s, T1));
    reading(T1, 91);
    ticks(3);
    stands_at(90);
}

static void a_reading_that_is_flagged_between_samples_is_none(void)
{
    bad_reading(T1, QUALITY_BAD, 85);
    ticks(2);
    stands_at(85);
    reading(T1, 86);
    tick();
    stands_at(86);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_MEASUREMENT_BAD, "T1"));
}

/* As for any other: with a hold of 10 s the loop goes to manual in the 11th tick without a reading. */
static void the_hold_begins_when_a_sample_fails_to_come(void)
{
    unsigned survived[2];
    for (int k = 0; k < 2; k++) {
        setUp();
        unsigned at = k ? T10 : T1;
        uint8_t loop = k ? BOTTOM : TOP;
        mode(loop, LOOP_AUTO);
        ticks(2); /* 6 s */
        bad_reading(at, QUALITY_BAD, 0);
        for (survived[k] = 0; bench.s.loop[loop].mode == LOOP_AUTO && survived[k] < 50;
             survived[k]++)
            tick();
        TEST_ASSERT_TRUE(bench.s.measurement[at].lost);
    }
    TEST_ASSERT_EQUAL_UINT(11, survived[1]);
    TEST_ASSERT_EQUAL_UINT(survived[1], survived[0]);
}

static void a_hold_shorter_than_its_interval_does_not_lose_it(void)
{
    set_and_apply("meas1.hold", "2");
    mode(TOP, LOOP_AUTO);
    ticks(50);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_MEASUREMENT_BAD, "T1"));
}

static void frozen_is_judged_by_its_samples_alone(void)
{
    set_and_apply("meas1.frozen", "12"); /* above two of its intervals, below three */
    for (int k = 0; k < 6; k++) {
        reading(T1, 85 + k);
        next_sample();
        stands_at(85 + k);
    }
    next_sample();
    next_sample(); /* 10 s after the last change */
    ticks(4);      /* 14 s: nobody has looked */
    TEST_ASSERT_EQUAL(MEASUREMENT_FINE, bench.s.measurement[T1].fault);
    tick();
    TEST_ASSERT_EQUAL(MEASUREMENT_FROZEN, bench.s.measurement[T1].fault);
    reading(T1, 95);
    next_sample();
    stands_at(95);
}

static void what_is_taken_late_is_still_from_when_it_should_have_come(void)
{
    set_and_apply("meas1.frozen", "5");
    bad_reading(T1, QUALITY_MISSING, 0);
    next_sample();
    tick();
    reading(T1, 90);
    tick(); /* 9 s, in place of 7 s */
    stands_at(90);
    next_sample();
    TEST_ASSERT_EQUAL(MEASUREMENT_FROZEN, bench.s.measurement[T1].fault);
}

static void a_frozen_limit_below_its_interval_does_not_trip_while_samples_differ(void)
{
    set_and_apply("meas1.frozen", "3");
    for (int k = 0; k < 5; k++) {
        reading(T1, 86 + k);
        next_sample();
        ticks(4);
        stands_at(86 + k);
    }
    next_sample(); /* the same number as a sample of its own */
    TEST_ASSERT_EQUAL(MEASUREMENT_FROZEN, bench.s.measurement[T1].fault);
}

static void speed_is_judged_from_sample_to_sample(void)
{
    set_and_apply("meas1.rate_limit", "1");
    reading(T1, 89.5); /* 4.5 in 5 s */
    next_sample();
    stands_at(89.5);
    reading(T1, 95); /* 5.5 in 5 s */
    next_sample();
    TEST_ASSERT_EQUAL(MEASUREMENT_TOO_FAST, bench.s.measurement[T1].fault);
    ticks(4); /* the same number, looked at again, is not judged by the time that goes on */
    TEST_ASSERT_EQUAL(MEASUREMENT_TOO_FAST, bench.s.measurement[T1].fault);
    tick(); /* 5.5 in 10 s */
    stands_at(95);
}

static void the_filter_steps_once_a_sample_with_its_interval(void)
{
    set_and_apply("meas1.filter", "20");
    reading(T1, 95);
    next_sample();
    double once = 85 + 10 * 5.0 / 25.0; /* h / (T + h) */
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, once, value(T1));
    ticks(4);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, once, value(T1));
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, once + (95 - once) * 0.2, value(T1));
}

static void what_stands_in_is_there_in_every_tick_and_not_filtered(void)
{
    put_all((const char *const[]){"meas1.filter", "20", "meas1.infer", "heat", "meas1.infer_gain",
                                  "20", "meas1.infer_offset", "70", NULL});
    apply();
    bad_reading(T1, QUALITY_BAD, 0);
    next_sample();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 90, value(T1)); /* heat at 1 kW */
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, bench.s.measurement[T1].quality);
    out(BOTTOM, 1.5);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 100, value(T1));
    TEST_ASSERT_EQUAL_UINT64(
        0, sampling_at_ms(&bench.s, T1)); /* what is known is as old as it was: 2 s less 3 */
}

/* ---- alarms and interlocks ---- */

static bool listed(void)
{
    return bench.s.alarm[0].listed;
}

static void an_alarm_counts_its_delay_from_sample_to_sample(void)
{
    put_all(
        (const char *const[]){"alarm1.on", "T1", "alarm1.limit", "90", "alarm1.delay", "4", NULL});
    apply();
    reading(T1, 95);
    next_sample();
    ticks(4); /* one sample has stood for 4 s: that is not a second one */
    TEST_ASSERT_FALSE(listed());
    tick();
    TEST_ASSERT_TRUE(listed());
    reading(T1, 85);
    next_sample();
    TEST_ASSERT_FALSE(listed());
    reading(T1, 95); /* a single one, between others */
    next_sample();
    reading(T1, 85);
    next_sample();
    ticks(10);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_ALARM_ON, NULL));
}

static void a_deviation_is_looked_at_with_each_sample_and_ends_with_the_loop(void)
{
    put_all((const char *const[]){"alarm1.on", "top", "alarm1.side", "deviation", "alarm1.limit",
                                  "5", NULL});
    apply();
    mode(TOP, LOOP_AUTO);
    ticks(3); /* 7 s */
    setpoint(TOP, 95);
    tick();
    TEST_ASSERT_FALSE(listed());
    next_sample();
    TEST_ASSERT_TRUE(listed());
    tick();
    mode(TOP, LOOP_MANUAL);
    tick();
    TEST_ASSERT_FALSE(listed());
}

static void an_interlock_takes_a_sample_that_stands_for_what_is(void)
{
    put_all((const char *const[]){"lock1.meas", "T1", "lock1.mv", "heat", "lock1.limit", "90",
                                  "lock1.delay", "3", NULL});
    apply();
    reading(T1, 95);
    next_sample();
    reading(T1, 85); /* not looked at before its turn */
    ticks(2);
    TEST_ASSERT_FALSE(bench.s.interlock[0].active);
    tick();
    TEST_ASSERT_TRUE(bench.s.interlock[0].active);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, sent(HEAT));
    ticks(2);
    TEST_ASSERT_FALSE(bench.s.interlock[0].active);
}

/* ---- settings ---- */

static void a_loop_whose_divisor_does_not_fit_is_told_of_once(void)
{
    bench_forget_events();
    apply(); /* told before, and nothing has changed */
    tick();
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_LOOP_DIVISOR, NULL));
    set_and_apply("loop1.divisor", "3");
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_LOOP_DIVISOR, "top"));
    set_and_apply("loop1.divisor", "10");
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_LOOP_DIVISOR, NULL));
    set_and_apply("meas1.every", "4");
    tick();
    TEST_ASSERT_EQUAL_UINT(2, happened(EVENT_LOOP_DIVISOR, "top"));
    TEST_ASSERT_EQUAL_UINT(2, happened(EVENT_LOOP_DIVISOR, NULL));
}

static void it_is_told_of_at_the_start_too(void)
{
    bench_start_with(analyser);
    memset(&bench.s, 0, sizeof bench.s);
    supervisor_init(&bench.s, &bench.events);
    apply();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_LOOP_DIVISOR, "top"));
}

static void a_phase_beyond_the_interval_is_refused(void)
{
    struct config_fault fault;
    put("meas1.phase", "4");
    apply();
    put("meas1.phase", "5");
    TEST_ASSERT_EQUAL(ERR_RANGE,
                      plan_build(&bench.plan[1 - bench.current], &bench.config, 1.0f, &fault));
    TEST_ASSERT_EQUAL_STRING("meas", fault.group);
    TEST_ASSERT_EQUAL(1, fault.index);
    TEST_ASSERT_EQUAL_STRING("phase", fault.field);
}

static void another_interval_or_phase_takes_effect_with_the_plan(void)
{
    set_and_apply("meas1.phase", "0");
    reading(T1, 90);
    tick(); /* 5 s */
    stands_at(90);
    reading(T1, 91);
    set_and_apply("meas1.phase", "0"); /* the same once more */
    tick();
    stands_at(90);
    put("meas1.every", "1");
    apply();
    tick();
    stands_at(91);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(between_two_samples_the_value_stands_and_is_good);
    RUN_TEST(what_comes_in_every_tick_is_not_touched_by_it);
    RUN_TEST(the_time_of_sampling_is_kept_whenever_it_is_asked_for);
    RUN_TEST(after_a_start_the_number_that_stands_is_taken_with_its_true_age);
    RUN_TEST(after_silence_within_a_turn_the_number_is_taken_at_once);
    RUN_TEST(a_clock_that_misses_the_base_tick_by_a_little_changes_nothing);
    RUN_TEST(a_sample_whose_tick_was_lost_is_taken_in_the_next_and_dated_rightly);
    RUN_TEST(every_n_th_tick_is_counted_far_from_the_beginning_too);
    RUN_TEST(a_sample_that_does_not_come_is_missing_and_found_when_it_comes_late);
    RUN_TEST(a_reading_that_is_flagged_between_samples_is_none);
    RUN_TEST(the_hold_begins_when_a_sample_fails_to_come);
    RUN_TEST(a_hold_shorter_than_its_interval_does_not_lose_it);
    RUN_TEST(frozen_is_judged_by_its_samples_alone);
    RUN_TEST(what_is_taken_late_is_still_from_when_it_should_have_come);
    RUN_TEST(a_frozen_limit_below_its_interval_does_not_trip_while_samples_differ);
    RUN_TEST(speed_is_judged_from_sample_to_sample);
    RUN_TEST(the_filter_steps_once_a_sample_with_its_interval);
    RUN_TEST(what_stands_in_is_there_in_every_tick_and_not_filtered);
    RUN_TEST(an_alarm_counts_its_delay_from_sample_to_sample);
    RUN_TEST(a_deviation_is_looked_at_with_each_sample_and_ends_with_the_loop);
    RUN_TEST(an_interlock_takes_a_sample_that_stands_for_what_is);
    RUN_TEST(a_loop_whose_divisor_does_not_fit_is_told_of_once);
    RUN_TEST(it_is_told_of_at_the_start_too);
    RUN_TEST(a_phase_beyond_the_interval_is_refused);
    RUN_TEST(another_interval_or_phase_takes_effect_with_the_plan);
    return UNITY_END();
}
