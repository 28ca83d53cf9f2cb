/* No transition moves an output: below a millionth of span in float, a few steps of Q7.24 in fixed. Where the
 * loop moves anyway (an error is there), it must move exactly as it would have without the transition. */
#include "supervisor_bench.h"

static struct bench kept;

void setUp(void)
{
    bench_start();
}
void tearDown(void) {}

/* The output of the next tick, which is then undone. */
static double next(unsigned output)
{
    kept = bench;
    tick();
    double result = sent(output);
    bench = kept;
    return result;
}

static void in_automatic_with_an_error(void)
{
    mode(BOTTOM, LOOP_AUTO);
    mode(TOP, LOOP_AUTO);
    ticks(2);
    reading(T10, 113.5);
    reading(T1, 85.7);
    ticks(25);
}

static void entering_automatic_does_not_move_the_output(void)
{
    mode(BOTTOM, LOOP_AUTO);
    tick();
    ASSERT_NO_BUMP(0.5, sent(HEAT));
}

static void entering_automatic_far_from_the_setpoint_does_not_move_the_output(void)
{
    set_and_apply("loop2.sp_track", "off");
    setpoint(BOTTOM, 150);
    tick();
    mode(BOTTOM, LOOP_AUTO);
    tick();
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    double before = sent(HEAT);
    tick();
    TEST_ASSERT_TRUE(sent(HEAT) > before); /* and then it works on the error */
}

static void entering_automatic_while_the_measurement_moves_does_not_move_the_output(void)
{
    put("loop2.td", "20");
    apply();
    reading(T10, 117);
    mode(BOTTOM, LOOP_AUTO);
    tick();
    ASSERT_NO_BUMP(0.5, sent(HEAT));
}

static void going_to_manual_does_not_move_the_output(void)
{
    in_automatic_with_an_error();
    double before = sent(HEAT);
    mode(BOTTOM, LOOP_MANUAL);
    tick();
    ASSERT_NO_BUMP(before, sent(HEAT));
}

static void no_change_of_settings_moves_the_output(void)
{
    static const char *const changes[][2] = {
        {"loop2.gain", "6"},       {"loop2.gain", "0.2"},  {"loop2.ti", "30"},
        {"loop2.ti", "0"},         {"loop2.td", "40"},     {"loop2.b", "0"},
        {"loop2.tt", "50"},        {"loop2.c", "1"},       {"loop2.algorithm", "velocity"},
        {"loop2.inhibit", "100"},  {"loop2.divisor", "3"}, {"loop2.sp_ramp", "5"},
        {"loop2.sp_filter", "30"}, {"meas2.hold", "300"},  {"loop1.gain", "9"},
        {"mv2.band", "0.1"},       {"mv2.max", "1.9"},     {"meas4.filter", "20"},
        {"tick.miss_limit", "9"}};
    for (unsigned k = 0; k < sizeof changes / sizeof changes[0]; k++) {
        bench_start();
        if (strcmp(changes[k][0], "loop2.divisor") == 0) /* due in the tick of the change */
            ticks((6 - (bench.s.ticks + 27) % 3) % 3);
        in_automatic_with_an_error();
        double without = next(HEAT);
        set_and_apply(changes[k][0], changes[k][1]);
        tick();
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(BY_FORMAT(1e-6, 16.0 / 16777216), without, sent(HEAT),
                                          changes[k][0]);
    }
}

static void reversing_the_action_does_not_move_the_output_either(void)
{
    in_automatic_with_an_error();
    double before = sent(HEAT);
    set_and_apply("loop2.action", "direct");
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, before,
                              sent(HEAT)); /* integral of one tick, in either direction */
}

static void a_new_measurement_filter_does_not_move_the_output(void)
{
    in_automatic_with_an_error();
    double without = next(HEAT);
    set_and_apply("meas2.filter", "60");
    tick();
    ASSERT_NO_BUMP(without, sent(HEAT));
}

static void leaving_the_safe_state_does_not_move_the_output(void)
{
    put("mv2.safe", "0.3");
    put("loop2.sp_track", "off");
    apply();
    in_automatic_with_an_error();
    supervisor_go_safe(&bench.s, "test");
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.15, sent(HEAT));
    mode(BOTTOM, LOOP_AUTO);
    tick();
    ASSERT_NO_BUMP(0.15, sent(HEAT));
}

static void automatic_begins_at_the_value_sent_even_while_the_valve_still_moves(void)
{
    bench.input.readback[HEAT] = (struct reading){1.0f, QUALITY_GOOD};
    tick();
    out(BOTTOM, 0.4); /* the read-back goes on saying 1.0 for an interval */
    tick();
    ASSERT_NO_BUMP(0.2, sent(HEAT));
    mode(BOTTOM, LOOP_AUTO);
    tick();
    ASSERT_NO_BUMP(0.2, sent(HEAT));
    TEST_ASSERT_EQUAL(1, happened(EVENT_NOT_FOLLOWING, "heat"));
}

static void an_output_and_automatic_asked_for_in_one_tick_begin_at_that_output(void)
{
    validate();
    request(REQUEST_OUTPUT, BOTTOM, PLAN_NONE, 0, 1.2);
    mode(BOTTOM, LOOP_AUTO);
    supervisor_control(&bench.s);
    ASSERT_NO_BUMP(0.6, sent(HEAT));
}

static void an_output_that_sticks_does_not_wind_the_loop_up(void)
{
    mode(BOTTOM, LOOP_AUTO);
    tick();
    setpoint(BOTTOM, 130);
    for (unsigned n = 0; n < 2000; n++) {
        bench.input.readback[HEAT] = (struct reading){1.0f, QUALITY_GOOD};
        tick();
    }
    /* The command stands off by what proportional action asks for, not by hours of integral. */
    TEST_ASSERT_TRUE(sent(HEAT) <= 0.5 + 1.5 * 0.15 + 0.02);
    reading(T10, 131);
    tick();
    TEST_ASSERT_TRUE(sent(HEAT) < 0.51);
}

static void a_read_back_outside_all_belief_is_ignored(void)
{
    in_automatic_with_an_error();
    double without = next(HEAT);
    bench.input.readback[HEAT] = (struct reading){1e30f, QUALITY_GOOD};
    tick();
    ASSERT_NO_BUMP(without, sent(HEAT));
    bench.input.readback[HEAT] = (struct reading){1.0f, QUALITY_BAD};
    without = next(HEAT);
    bench.input.readback[HEAT].quality = QUALITY_MISSING;
    tick();
    ASSERT_NO_BUMP(without, sent(HEAT));
    TEST_ASSERT_EQUAL(0, happened(EVENT_NOT_FOLLOWING, NULL));
}

static void a_read_back_at_the_edge_of_its_band_is_reported_once(void)
{
    for (unsigned n = 0; n < 20; n++) {
        bench.input.readback[HEAT] = (struct reading){n % 2 ? 0.975f : 0.985f, QUALITY_GOOD};
        tick();
    }
    TEST_ASSERT_EQUAL(1, happened(EVENT_NOT_FOLLOWING, "heat"));
    TEST_ASSERT_EQUAL(0, happened(EVENT_FOLLOWING, "heat"));
    bench.input.readback[HEAT].value = 0.999f;
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_FOLLOWING, "heat"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(entering_automatic_does_not_move_the_output);
    RUN_TEST(entering_automatic_far_from_the_setpoint_does_not_move_the_output);
    RUN_TEST(entering_automatic_while_the_measurement_moves_does_not_move_the_output);
    RUN_TEST(going_to_manual_does_not_move_the_output);
    RUN_TEST(no_change_of_settings_moves_the_output);
    RUN_TEST(reversing_the_action_does_not_move_the_output_either);
    RUN_TEST(a_new_measurement_filter_does_not_move_the_output);
    RUN_TEST(leaving_the_safe_state_does_not_move_the_output);
    RUN_TEST(automatic_begins_at_the_value_sent_even_while_the_valve_still_moves);
    RUN_TEST(an_output_and_automatic_asked_for_in_one_tick_begin_at_that_output);
    RUN_TEST(an_output_that_sticks_does_not_wind_the_loop_up);
    RUN_TEST(a_read_back_outside_all_belief_is_ignored);
    RUN_TEST(a_read_back_at_the_edge_of_its_band_is_reported_once);
    return UNITY_END();
}
