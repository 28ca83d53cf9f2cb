/* Interlocks: nothing overrides them, and they let go without a bump. */
#include "supervisor_bench.h"

/* Bottom too hot cuts the heater: above 140, back below 135. */
static void with_interlock(void)
{
    put_all((const char *const[]){"lock1.meas", "T10", "lock1.mv", "heat", "lock1.limit", "140",
                                  "lock1.hysteresis", "5", "lock1.value", "0", NULL});
}

void setUp(void)
{
    bench_start_with(with_interlock);
}
void tearDown(void) {}

static void trip(void)
{
    reading(T10, 141);
    tick();
    TEST_ASSERT_TRUE(bench.s.interlock[0].active);
}

static void it_forces_an_output_in_manual(void)
{
    trip();
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
    TEST_ASSERT_EQUAL(1, happened(EVENT_INTERLOCK_ON, "heat"));
    out(BOTTOM, 1.5);
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
}

static void it_forces_an_output_in_automatic_in_the_same_tick(void)
{
    mode(BOTTOM, LOOP_AUTO);
    ticks(5);
    trip();
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
}

static void it_is_stronger_than_limits_rates_and_the_safe_value(void)
{
    put_all((const char *const[]){"mv2.min", "0.5", "mv2.rate", "0.001", "mv2.safe", "0.5", NULL});
    apply();
    trip();
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
    supervisor_go_safe(&bench.s, "test");
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
}

static void it_lets_go_only_when_back_inside_by_the_hysteresis(void)
{
    trip();
    reading(T10, 136);
    ticks(5);
    TEST_ASSERT_EQUAL(0, happened(EVENT_INTERLOCK_OFF, NULL));
    reading(T10, 134.9);
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_INTERLOCK_OFF, "heat"));
}

static void manual_stays_at_the_forced_value_when_it_lets_go(void)
{
    trip();
    reading(T10, 115);
    ticks(5);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
}

static void automatic_goes_on_from_the_forced_value_without_a_bump(void)
{
    put("lock1.value", "0.3");
    apply();
    mode(BOTTOM, LOOP_AUTO);
    tick();
    setpoint(BOTTOM, 138);
    ticks(50);
    trip();
    ticks(100);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.15, sent(HEAT));
    reading(T10, 120); /* far below the setpoint: a proportional kick would show */
    ticks(2);
    ASSERT_NO_BUMP(D(N(0.15)), sent(HEAT));
    ticks(100);
    TEST_ASSERT_TRUE(sent(HEAT) > 0.2); /* and it works again */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.78, setpoint_of(BOTTOM));
}

static void a_loop_put_into_automatic_under_an_interlock_waits_for_it(void)
{
    trip();
    mode(BOTTOM, LOOP_AUTO);
    ticks(5);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
    reading(T10, 120);
    ticks(2);
    ASSERT_NO_BUMP(0, sent(HEAT));
}

static void it_waits_for_its_delay(void)
{
    set_and_apply("lock1.delay", "3");
    reading(T10, 141);
    ticks(3);
    TEST_ASSERT_TRUE(sent(HEAT) > 0.4);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
}

static void the_delay_begins_anew_after_an_interruption(void)
{
    set_and_apply("lock1.delay", "3");
    for (unsigned n = 0; n < 20; n++) {
        reading(T10, n % 3 == 2 ? 139 : 141);
        tick();
    }
    TEST_ASSERT_EQUAL(0, happened(EVENT_INTERLOCK_ON, NULL));
}

static void it_can_watch_for_too_low(void)
{
    put("lock1.side", "below");
    put("lock1.limit", "100");
    apply();
    reading(T10, 99);
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_INTERLOCK_ON, "heat"));
    reading(T10, 104);
    tick();
    TEST_ASSERT_EQUAL(0, happened(EVENT_INTERLOCK_OFF, NULL));
    reading(T10, 106);
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_INTERLOCK_OFF, "heat"));
}

static void a_measurement_bad_for_longer_than_its_hold_counts_as_the_condition(void)
{
    bad_reading(T10, QUALITY_BAD, 0);
    ticks(10);
    TEST_ASSERT_TRUE(sent(HEAT) > 0.4);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
}

static void a_bad_measurement_does_not_count_where_that_is_chosen(void)
{
    set_and_apply("lock1.on_bad", "off");
    bad_reading(T10, QUALITY_BAD, 0);
    ticks(20);
    TEST_ASSERT_EQUAL(0, happened(EVENT_INTERLOCK_ON, NULL));
}

static void a_measurement_never_seen_or_not_there_counts_as_bad(void)
{
    put("meas2.name", "T11");
    put("loop2.pv", "T11");
    put("lock1.meas", "T11");
    bad_reading(T10, QUALITY_MISSING, 0);
    apply();
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_INTERLOCK_ON, "heat"));
}

static void a_sensor_that_breaks_while_it_is_active_does_not_release_it(void)
{
    for (unsigned on_bad = 0; on_bad < 2; on_bad++) {
        bench_start_with(with_interlock);
        set_and_apply("lock1.on_bad", on_bad ? "on" : "off");
        trip();
        bad_reading(T10, QUALITY_BAD, 0); /* what a broken sensor delivers */
        ticks(30);
        bad_reading(T10, QUALITY_GOOD, -1000);
        ticks(30);
        bad_reading(T10, QUALITY_GOOD, (double)NAN);
        ticks(3);
        bad_reading(T10, QUALITY_MISSING, 0);
        ticks(30);
        TEST_ASSERT_EQUAL(0, happened(EVENT_INTERLOCK_OFF, NULL));
        reading(T10, 120);
        tick();
        TEST_ASSERT_EQUAL(1, happened(EVENT_INTERLOCK_OFF, NULL));
    }
}

static void a_reading_beyond_belief_on_the_wrong_side_acts_at_once(void)
{
    reading(T10, 400);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
}

static void a_reading_beyond_belief_on_the_right_side_does_not_release_it(void)
{
    trip();
    reading(T10, 0); /* held meanwhile, and usable */
    ticks(3);
    TEST_ASSERT_TRUE(bench.s.interlock[0].active);
    reading(T10, 115);
    tick();
    TEST_ASSERT_FALSE(bench.s.interlock[0].active);
}

static void it_looks_at_the_measurement_before_its_filter(void)
{
    set_and_apply("meas2.filter", "1000");
    trip();
}

static void the_first_of_two_on_one_output_wins(void)
{
    put_all((const char *const[]){"lock2.meas", "T10", "lock2.mv", "heat", "lock2.limit", "130",
                                  "lock2.value", "0.5", NULL});
    apply();
    reading(T10, 135);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, sent(HEAT));
    trip();
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
}

static void new_numbers_do_not_release_an_active_one(void)
{
    trip();
    put("lock1.delay", "100");
    put("lock1.value", "0.1");
    apply();
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.05, sent(HEAT));
    TEST_ASSERT_EQUAL(0, happened(EVENT_INTERLOCK_OFF, NULL));
}

/* The bench's value of 136 would keep an active one active, on either side, and does not make one act. */
static void one_that_watches_or_moves_something_else_begins_anew(void)
{
    static const char *const changes[][2] = {
        {"lock1.meas", "T5"}, {"lock1.mv", "reflux"}, {"lock1.side", "below"}};
    for (unsigned k = 0; k < 3; k++) {
        bench_start_with(with_interlock);
        trip();
        reading(T10, 136);
        reading(T5, 136);
        ticks(2);
        TEST_ASSERT_TRUE(bench.s.interlock[0].active);
        if (k == 2)
            put("lock1.limit", "133");
        set_and_apply(changes[k][0], changes[k][1]);
        ticks(2);
        TEST_ASSERT_FALSE_MESSAGE(bench.s.interlock[0].active, changes[k][0]);
    }
}

static void release(uint8_t interlock)
{
    request(REQUEST_RELEASE, PLAN_NONE, interlock, 0, 0);
}

static void a_latched_one_holds_until_it_is_released(void)
{
    set_and_apply("lock1.latch", "on");
    mode(BOTTOM, LOOP_AUTO);
    trip();
    release(0); /* its condition holds */
    TEST_ASSERT_EQUAL(1, happened(EVENT_REQUEST_REFUSED, "release"));
    reading(T10, 136); /* inside, but not by the hysteresis */
    tick();
    release(0);
    TEST_ASSERT_EQUAL(2, happened(EVENT_REQUEST_REFUSED, "release"));
    reading(T10, 115);
    ticks(500);
    TEST_ASSERT_TRUE(bench.s.interlock[0].active);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
    TEST_ASSERT_EQUAL(0, happened(EVENT_INTERLOCK_OFF, NULL));
    release(1); /* another one */
    TEST_ASSERT_EQUAL(3, happened(EVENT_REQUEST_REFUSED, "release"));
    release(0);
    ticks(5);
    TEST_ASSERT_EQUAL(1, happened(EVENT_INTERLOCK_OFF, "heat"));
    TEST_ASSERT_FALSE(bench.s.interlock[0].active);
    TEST_ASSERT_FALSE(bench.s.mv[HEAT].interlocked);
    trip(); /* and again */
    reading(T10, 115);
    ticks(5);
    TEST_ASSERT_TRUE(bench.s.interlock[0].active);
}

static void a_latch_that_is_switched_off_lets_go(void)
{
    set_and_apply("lock1.latch", "on");
    trip();
    reading(T10, 115);
    ticks(5);
    set_and_apply("lock1.latch", "off");
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_INTERLOCK_OFF, "heat"));
    TEST_ASSERT_FALSE(bench.s.interlock[0].active);
}

static void the_safe_state_does_not_release_a_latched_one(void)
{
    set_and_apply("lock1.latch", "on");
    trip();
    supervisor_go_safe(&bench.s, "link");
    reading(T10, 115);
    ticks(5);
    out(BOTTOM, 1.5);
    ticks(3);
    TEST_ASSERT_TRUE(bench.s.interlock[0].active);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_latched_one_holds_until_it_is_released);
    RUN_TEST(a_latch_that_is_switched_off_lets_go);
    RUN_TEST(the_safe_state_does_not_release_a_latched_one);
    RUN_TEST(it_forces_an_output_in_manual);
    RUN_TEST(it_forces_an_output_in_automatic_in_the_same_tick);
    RUN_TEST(it_is_stronger_than_limits_rates_and_the_safe_value);
    RUN_TEST(it_lets_go_only_when_back_inside_by_the_hysteresis);
    RUN_TEST(manual_stays_at_the_forced_value_when_it_lets_go);
    RUN_TEST(automatic_goes_on_from_the_forced_value_without_a_bump);
    RUN_TEST(a_loop_put_into_automatic_under_an_interlock_waits_for_it);
    RUN_TEST(it_waits_for_its_delay);
    RUN_TEST(the_delay_begins_anew_after_an_interruption);
    RUN_TEST(it_can_watch_for_too_low);
    RUN_TEST(a_measurement_bad_for_longer_than_its_hold_counts_as_the_condition);
    RUN_TEST(a_bad_measurement_does_not_count_where_that_is_chosen);
    RUN_TEST(a_measurement_never_seen_or_not_there_counts_as_bad);
    RUN_TEST(a_sensor_that_breaks_while_it_is_active_does_not_release_it);
    RUN_TEST(a_reading_beyond_belief_on_the_wrong_side_acts_at_once);
    RUN_TEST(a_reading_beyond_belief_on_the_right_side_does_not_release_it);
    RUN_TEST(it_looks_at_the_measurement_before_its_filter);
    RUN_TEST(the_first_of_two_on_one_output_wins);
    RUN_TEST(new_numbers_do_not_release_an_active_one);
    RUN_TEST(one_that_watches_or_moves_something_else_begins_anew);
    return UNITY_END();
}
