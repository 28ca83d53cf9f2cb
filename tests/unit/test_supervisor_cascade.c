/* Cascades: outest (feed) drives outer (T5) drives bottom (T10) drives heat. */
#include "supervisor_bench.h"

void setUp(void)
{
    bench_start_with(bench_cascade);
}
void tearDown(void) {}

static void cascade(void)
{
    mode(BOTTOM, LOOP_CASCADE);
    mode(OUTER, LOOP_AUTO);
    ticks(3);
}

static double v_of(unsigned loop)
{
    return D(bench.s.loop[loop].v);
}

static void a_cascade_asked_for_in_the_tick_of_its_plan_begins_where_the_inner_loop_is(void)
{
    for (int from = LOOP_MANUAL; from <= LOOP_AUTO; from++) {
        bench_start();
        mode(BOTTOM, (enum loop_mode)from);
        if (from == LOOP_AUTO)
            setpoint(BOTTOM, 110);
        ticks(3);
        double before = setpoint_of(BOTTOM);
        bench_cascade();
        apply();
        mode(BOTTOM, LOOP_CASCADE);
        ticks(2);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, before, setpoint_of(BOTTOM));
    }
}

static void the_outer_output_is_the_inner_setpoint(void)
{
    cascade();
    reading(T5, 95);
    ticks(5);
    TEST_ASSERT_TRUE(v_of(OUTER) > 0.55 + 0.03);
    TEST_ASSERT_DOUBLE_WITHIN(0, v_of(OUTER), setpoint_of(BOTTOM));
}

static void an_outer_loop_follows_the_measurement_of_an_inner_one_in_manual(void)
{
    mode(OUTER, LOOP_AUTO);
    reading(T5, 80); /* it would like to do something */
    reading(T10, 121);
    ticks(50);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.61, v_of(OUTER));
}

static void an_outer_loop_follows_the_setpoint_of_an_inner_one_in_automatic(void)
{
    mode(OUTER, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    reading(T5, 80);
    tick();
    setpoint(BOTTOM, 130);
    ticks(50);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.7, v_of(OUTER));
}

static void entering_cascade_from_automatic_does_not_move_setpoint_or_output(void)
{
    mode(OUTER, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    reading(T5, 80);
    ticks(10);
    double before = sent(HEAT), sp = setpoint_of(BOTTOM);
    mode(BOTTOM, LOOP_CASCADE);
    tick();
    ASSERT_NO_BUMP(sp, setpoint_of(BOTTOM));
    ASSERT_NO_BUMP(before, sent(HEAT));
}

static void entering_cascade_from_manual_with_a_setpoint_of_ones_own_does_not_kick(void)
{
    put("loop2.sp_track", "off");
    apply();
    setpoint(BOTTOM, 150); /* far from the measurement */
    mode(OUTER, LOOP_AUTO);
    ticks(5);
    mode(BOTTOM, LOOP_CASCADE);
    tick();
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, setpoint_of(BOTTOM));
}

static void leaving_cascade_keeps_the_setpoint_where_the_outer_loop_left_it(void)
{
    cascade();
    reading(T5, 95);
    ticks(20);
    double sp = setpoint_of(BOTTOM);
    mode(BOTTOM, LOOP_AUTO);
    reading(T5, 90);
    ticks(20);
    TEST_ASSERT_DOUBLE_WITHIN(0, sp, setpoint_of(BOTTOM));
    setpoint(BOTTOM, 125);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.65, setpoint_of(BOTTOM));
}

static void a_setpoint_for_a_loop_in_cascade_is_refused(void)
{
    cascade();
    setpoint(BOTTOM, 125);
    TEST_ASSERT_EQUAL(1, happened(EVENT_REQUEST_REFUSED, "bottom"));
}

static void an_outer_loop_in_manual_gives_the_setpoint_the_operator_gives_it(void)
{
    cascade();
    mode(OUTER, LOOP_MANUAL);
    out(OUTER, 118);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.58, setpoint_of(BOTTOM));
}

static void a_manual_output_of_an_outer_loop_nobody_listens_to_is_refused(void)
{
    out(OUTER, 118);
    TEST_ASSERT_EQUAL(1, happened(EVENT_REQUEST_REFUSED, "outer"));
}

static void an_outer_loop_keeps_the_setpoint_limits_of_the_inner_one_without_winding_up(void)
{
    put("loop2.sp_lo", "60");
    put("loop2.sp_hi", "120");
    apply();
    cascade();
    reading(T5, 85); /* for a long time it wants more than it can have */
    ticks(3000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, setpoint_of(BOTTOM));
    reading(T5, 108);
    ticks(30);
    TEST_ASSERT_TRUE(setpoint_of(BOTTOM) < 0.59);
}

static void an_outer_loop_stops_integrating_towards_a_saturated_inner_one(void)
{
    cascade();
    mode(OUTER, LOOP_AUTO);
    reading(T10, 75); /* the heater is at its end */
    reading(T5, 85);
    ticks(20);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, sent(HEAT));
    double sp = setpoint_of(BOTTOM);
    ticks(200);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, sp, setpoint_of(BOTTOM)); /* no further up */
    reading(T5, 112);
    ticks(20);
    TEST_ASSERT_TRUE(setpoint_of(BOTTOM) < sp - 0.05); /* but down at once */
}

static void saturation_of_a_direct_acting_inner_loop_holds_the_other_direction(void)
{
    put("loop2.action", "direct");
    apply();
    cascade();
    reading(
        T10,
        155); /* direct: the output is at its upper end, a lower setpoint would push it further */
    ticks(20);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, sent(HEAT));
    reading(T5, 112); /* outer wants its setpoint lower */
    tick();
    double sp = setpoint_of(BOTTOM);
    ticks(100);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, sp, setpoint_of(BOTTOM));
}

static void the_loop_two_levels_up_does_not_wind_up_while_the_middle_speaks_to_nobody(void)
{
    mode(OUTEST, LOOP_AUTO);
    mode(OUTER, LOOP_CASCADE);
    mode(BOTTOM, LOOP_AUTO); /* does not listen to outer */
    tick();
    reading(FEED, 2);
    ticks(2000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, v_of(OUTEST)); /* measurement of outer */
    double before = sent(HEAT);
    mode(BOTTOM, LOOP_CASCADE);
    tick();
    ASSERT_NO_BUMP(before, sent(HEAT));
}

static void three_levels_pass_a_disturbance_down_in_one_tick(void)
{
    mode(BOTTOM, LOOP_CASCADE);
    mode(OUTER, LOOP_CASCADE);
    mode(OUTEST, LOOP_AUTO);
    ticks(3);
    double before = sent(HEAT);
    reading(FEED, 4); /* the top measurement falls by a tenth of its span */
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, before + 0.1 * 0.5 * 0.8 * 1.5, sent(HEAT));
}

static void an_outer_loop_waits_while_an_interlock_holds_the_inner_ones_output(void)
{
    put_all(
        (const char *const[]){"lock1.meas", "feed", "lock1.mv", "heat", "lock1.limit", "8", NULL});
    apply();
    cascade();
    reading(FEED, 9);
    ticks(2);
    double sp = setpoint_of(BOTTOM);
    reading(T5, 95);
    tick();
    double proportional = setpoint_of(BOTTOM);
    ticks(500);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, proportional, setpoint_of(BOTTOM));
    TEST_ASSERT_TRUE(proportional >= sp);
}

static void changing_the_outer_loop_leaves_the_inner_one_at_its_setpoint(void)
{
    cascade();
    reading(T5, 95);
    ticks(10);
    double sp = setpoint_of(BOTTOM), before = sent(HEAT);
    set_and_apply("loop3.pv", "T1"); /* another loop by that name */
    tick();
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_EQUAL(1, happened(EVENT_MODE, "bottom") - 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, sp, setpoint_of(BOTTOM));
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, before, sent(HEAT));
}

static void an_outer_loop_may_run_more_slowly_than_the_inner_one(void)
{
    put("loop3.divisor", "5");
    apply();
    cascade();
    reading(T5, 95);
    unsigned moved = 0;
    double last = setpoint_of(BOTTOM);
    for (unsigned n = 0; n < 50; n++) {
        tick();
        moved += setpoint_of(BOTTOM) != last;
        last = setpoint_of(BOTTOM);
    }
    TEST_ASSERT_EQUAL(10, moved);
}

/* Seconds until the setpoint leaves its upper limit once the error has turned. */
static unsigned leaving_the_setpoint_limit(unsigned inner, unsigned inner_phase, unsigned outer,
                                           unsigned outer_phase)
{
    char text[4][12];
    snprintf(text[0], sizeof text[0], "%u", inner);
    snprintf(text[1], sizeof text[1], "%u", inner_phase);
    snprintf(text[2], sizeof text[2], "%u", outer);
    snprintf(text[3], sizeof text[3], "%u", outer_phase);
    bench_start_with(bench_cascade);
    put_all((const char *const[]){"loop2.sp_lo", "60", "loop2.sp_hi", "120", "loop2.divisor",
                                  text[0], "loop2.phase", text[1], "loop3.divisor", text[2],
                                  "loop3.phase", text[3], NULL});
    apply();
    cascade();
    reading(T5, 85);
    ticks(3000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, setpoint_of(BOTTOM));
    reading(T5, 105);
    unsigned n = 0;
    while (setpoint_of(BOTTOM) > 0.5999 && n < 5000) {
        tick();
        n++;
    }
    return n;
}

static void an_outer_loop_does_not_wind_up_whatever_the_divisors_and_phases(void)
{
    static const unsigned cases[][4] = {{1, 0, 1, 0}, {2, 0, 2, 1}, {2, 1, 2, 0}, {3, 2, 3, 0},
                                        {5, 3, 1, 0}, {1, 0, 5, 3}, {4, 1, 6, 3}, {7, 5, 3, 1}};
    for (unsigned k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        const unsigned *c = cases[k];
        unsigned took = leaving_the_setpoint_limit(c[0], c[1], c[2], c[3]);
        char what[60];
        snprintf(what, sizeof what, "inner %u/%u, outer %u/%u: %u s", c[0], c[1], c[2], c[3], took);
        TEST_ASSERT_TRUE_MESSAGE(took <= c[0] + c[2], what); /* each has had its turn */
    }
}

/* Two levels up as well: outer's output is cut off by bottom's setpoint limit, so outest must not push outer's setpoint. */
static void the_loop_two_levels_up_does_not_push_against_a_setpoint_limit_below(void)
{
    static const char *const cases[][6] = {{"1", "0", "1", "0", "1", "0"},
                                           {"2", "0", "2", "1", "2", "0"},
                                           {"2", "1", "4", "3", "8", "5"},
                                           {"7", "6", "5", "1", "3", "0"},
                                           {"1", "0", "10", "9", "3", "1"}};
    for (unsigned k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        const char *const *c = cases[k];
        bench_start_with(bench_cascade);
        put_all((const char *const[]){"loop2.sp_lo", "60", "loop2.sp_hi", "120", "loop2.divisor",
                                      c[0], "loop2.phase", c[1], "loop3.divisor", c[2],
                                      "loop3.phase", c[3], "loop4.divisor", c[4], "loop4.phase",
                                      c[5], NULL});
        apply();
        mode(BOTTOM, LOOP_CASCADE);
        mode(OUTER, LOOP_CASCADE);
        mode(OUTEST, LOOP_AUTO);
        ticks(60);
        reading(FEED, 3);
        ticks(30); /* the proportional part has come to the limit */
        double at = setpoint_of(OUTER);
        ticks(1000);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, at, setpoint_of(OUTER));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_outer_output_is_the_inner_setpoint);
    RUN_TEST(a_cascade_asked_for_in_the_tick_of_its_plan_begins_where_the_inner_loop_is);
    RUN_TEST(an_outer_loop_follows_the_measurement_of_an_inner_one_in_manual);
    RUN_TEST(an_outer_loop_follows_the_setpoint_of_an_inner_one_in_automatic);
    RUN_TEST(entering_cascade_from_automatic_does_not_move_setpoint_or_output);
    RUN_TEST(entering_cascade_from_manual_with_a_setpoint_of_ones_own_does_not_kick);
    RUN_TEST(leaving_cascade_keeps_the_setpoint_where_the_outer_loop_left_it);
    RUN_TEST(a_setpoint_for_a_loop_in_cascade_is_refused);
    RUN_TEST(an_outer_loop_in_manual_gives_the_setpoint_the_operator_gives_it);
    RUN_TEST(a_manual_output_of_an_outer_loop_nobody_listens_to_is_refused);
    RUN_TEST(an_outer_loop_keeps_the_setpoint_limits_of_the_inner_one_without_winding_up);
    RUN_TEST(an_outer_loop_stops_integrating_towards_a_saturated_inner_one);
    RUN_TEST(saturation_of_a_direct_acting_inner_loop_holds_the_other_direction);
    RUN_TEST(the_loop_two_levels_up_does_not_wind_up_while_the_middle_speaks_to_nobody);
    RUN_TEST(three_levels_pass_a_disturbance_down_in_one_tick);
    RUN_TEST(an_outer_loop_waits_while_an_interlock_holds_the_inner_ones_output);
    RUN_TEST(changing_the_outer_loop_leaves_the_inner_one_at_its_setpoint);
    RUN_TEST(an_outer_loop_may_run_more_slowly_than_the_inner_one);
    RUN_TEST(an_outer_loop_does_not_wind_up_whatever_the_divisors_and_phases);
    RUN_TEST(the_loop_two_levels_up_does_not_push_against_a_setpoint_limit_below);
    return UNITY_END();
}
