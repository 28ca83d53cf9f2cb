/* A new plan keeps what is the same and starts again what is not. */
#include "plan/plan_build.h"
#include "supervisor_bench.h"

void setUp(void)
{
    bench_start();
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    ticks(2);
    reading(T10, 113);
    ticks(10);
    bench_forget_events();
}
void tearDown(void) {}

static void mode_setpoint_and_state_of_an_unchanged_loop_stay(void)
{
    double sp = setpoint_of(BOTTOM), heat = sent(HEAT);
    set_and_apply("loop1.gain", "3");
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(0, sp, setpoint_of(BOTTOM));
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, heat, sent(HEAT));
    TEST_ASSERT_EQUAL(1, happened(EVENT_CONFIG_APPLIED, NULL));
    TEST_ASSERT_EQUAL(0, happened(EVENT_MODE, NULL));
}

static void a_loop_with_another_name_measurement_or_output_starts_in_manual(void)
{
    static const char *const changes[][2] = {
        {"loop2.name", "new"}, {"loop2.pv", "T5"}, {"loop2.out", "spare"}};
    for (unsigned k = 0; k < 3; k++) {
        setUp();
        double heat = sent(HEAT);
        set_and_apply(changes[k][0], changes[k][1]);
        tick();
        TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
        TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
        TEST_ASSERT_EQUAL(1, happened(EVENT_MODE, "bottom")); /* as it was called */
        ASSERT_NO_BUMP(heat, sent(HEAT));                     /* manual begins where it was */
    }
}

static void a_new_span_takes_its_loops_to_manual_and_keeps_the_output_in_units(void)
{
    double heat = sent(HEAT) * 2;
    put("mv2.hi", "4");
    apply();
    tick();
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, heat / 4, sent(HEAT));
    setUp();
    put("meas2.hi", "260");
    apply();
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 53.0 / 200, D(bench.s.measurement[T10].value));
}

/* Blocks read it before the next command is worked out. */
static void what_was_sent_last_keeps_its_units_in_a_new_span(void)
{
    double heat = sent(HEAT) * 2;
    set_and_apply("mv2.hi", "4");
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, heat / 4, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, heat / 4, D(bench.s.mv[HEAT].applied));
}

static void a_loop_taken_out_leaves_its_output_where_it_is(void)
{
    double heat = sent(HEAT);
    set_and_apply("loop2.name", "-");
    ticks(5);
    ASSERT_NO_BUMP(heat, sent(HEAT));
}

static void an_output_with_another_name_starts_at_its_safe_value(void)
{
    put("mv3.name", "other");
    put("mv3.safe", "40");
    apply();
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, sent(SPARE));
}

static void channels_that_change_places_do_not_inherit_each_others_values(void)
{
    put("meas1.name", "T10");
    put("meas2.name", "T1");
    apply();
    TEST_ASSERT_FALSE(bench.s.measurement[0].seen);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[TOP].mode);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
}

static void a_narrower_setpoint_range_moves_the_target_inside(void)
{
    put("loop2.sp_lo", "60");
    put("loop2.sp_hi", "114");
    apply();
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.54, setpoint_of(BOTTOM));
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
}

static void cascade_becomes_automatic_when_the_outer_loop_is_taken_out(void)
{
    bench_start_with(bench_cascade);
    mode(BOTTOM, LOOP_CASCADE);
    mode(OUTER, LOOP_AUTO);
    ticks(3);
    double sp = setpoint_of(BOTTOM);
    put("loop4.name", "-");
    put("loop3.name", "-");
    apply();
    ticks(3);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_DOUBLE_WITHIN(0, sp, setpoint_of(BOTTOM));
}

static void dead_time_lines_survive_a_plan_that_does_not_concern_them(void)
{
    bench_start();
    put_all((const char *const[]){"ff1.from", "feed", "ff1.to", "heat", "ff1.gain", "0.4",
                                  "ff1.dead", "10", "ff1.reference", "5", NULL});
    apply();
    mode(BOTTOM, LOOP_AUTO);
    ticks(2);
    reading(FEED, 6);
    ticks(5);
    set_and_apply("loop1.gain", "3");
    ticks(4);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, sent(HEAT));
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.54, sent(HEAT));
}

static void another_base_tick_changes_no_mode_and_moves_no_output(void)
{
    double heat = sent(HEAT);
    struct config_fault fault;
    struct plan *plan = &bench.plan[bench.current];
    TEST_ASSERT_EQUAL(ERR_OK, plan_set_tick(plan, 5.0f, &fault)); /* in place, as for a new plant */
    supervisor_take_plan(&bench.s, plan);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(3e-4, heat, sent(HEAT));
}

static void an_empty_plan_puts_everything_away(void)
{
    parameters_defaults(&bench.config);
    apply();
    ticks(3);
    TEST_ASSERT_FALSE(bench.s.plan->loop[TOP].used);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[TOP].mode);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(mode_setpoint_and_state_of_an_unchanged_loop_stay);
    RUN_TEST(a_loop_with_another_name_measurement_or_output_starts_in_manual);
    RUN_TEST(a_new_span_takes_its_loops_to_manual_and_keeps_the_output_in_units);
    RUN_TEST(what_was_sent_last_keeps_its_units_in_a_new_span);
    RUN_TEST(a_loop_taken_out_leaves_its_output_where_it_is);
    RUN_TEST(an_output_with_another_name_starts_at_its_safe_value);
    RUN_TEST(channels_that_change_places_do_not_inherit_each_others_values);
    RUN_TEST(a_narrower_setpoint_range_moves_the_target_inside);
    RUN_TEST(cascade_becomes_automatic_when_the_outer_loop_is_taken_out);
    RUN_TEST(dead_time_lines_survive_a_plan_that_does_not_concern_them);
    RUN_TEST(another_base_tick_changes_no_mode_and_moves_no_output);
    RUN_TEST(an_empty_plan_puts_everything_away);
    return UNITY_END();
}
