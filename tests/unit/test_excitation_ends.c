/* Reasons that end a test signal of a block. Each in the same tick, for all that is excited. */
#include "exciting_bench.h"

void setUp(void) {}
void tearDown(void) {}

/* ---- what ends it ---- */

static void its_own_absolute_limit_ends_it(void)
{
    begin();
    for (int k = 0; k < 2; k++) {
        wish[CONTROLLER].ask[k] = on(EXCITE_MV, (uint8_t)k, 0.05);
        wish[CONTROLLER].ask[k].amplitude = num_from_float(0.05f);
        wish[CONTROLLER].ask[k].hi = num_from_float(0.56f);
    }
    ticks(2);
    TEST_ASSERT_EQUAL(EXCITE_RUNS, wish[CONTROLLER].state);
    struct held *h = supervisor_block(&bench.s, BLOCK_NUMBERED + CONTROLLER);
    h->u[1] = num_from_float(0.52f); /* what the block gives comes on top */
    tick();
    ended("limit");
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    ASSERT_NO_BUMP(0.52, sent(HEAT));
    tick();
    TEST_ASSERT_EQUAL(EXCITE_ENDED, wish[CONTROLLER].state);
    TEST_ASSERT_EQUAL(EXCITE_LIMIT, wish[CONTROLLER].reason);
}

static void its_lower_limit_too(void)
{
    begin();
    wish[CONTROLLER].ask[0] = on(EXCITE_MV, 0, -0.05);
    wish[CONTROLLER].ask[0].lo = num_from_float(0.4f);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.45, sent(REFLUX));
    struct held *h = supervisor_block(&bench.s, BLOCK_NUMBERED + CONTROLLER);
    h->u[0] = num_from_float(0.44f);
    tick();
    ended("limit");
    ASSERT_NO_BUMP(0.44, sent(REFLUX));
}

static void the_limits_of_the_loop_end_it(void)
{
    begin_with(blocks);
    set_and_apply("loop2.out_hi", "0.62");
    ticks(2);
    excite_all();
    struct held *h = supervisor_block(&bench.s, BLOCK_NUMBERED + CONTROLLER);
    h->u[1] = num_from_float(0.61f);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.51, sent(HEAT));
    wish[CONTROLLER].ask[1].value = num_from_float(0.1f);
    tick();
    ended("limit");
    ASSERT_NO_BUMP(0.61, sent(HEAT));
}

static void the_operating_limits_end_it(void)
{
    begin_with(blocks);
    set_and_apply("mv2.max", "1.24"); /* 0.62 */
    ticks(2);
    excite_all();
    struct held *h = supervisor_block(&bench.s, BLOCK_NUMBERED + CONTROLLER);
    h->u[1] = num_from_float(0.61f);
    wish[CONTROLLER].ask[1].value = num_from_float(0.1f);
    tick();
    ended("limit");
    ASSERT_NO_BUMP(0.61, sent(HEAT));
}

static void a_setpoint_that_would_pass_its_limits_ends_it(void)
{
    begin_with(blocks);
    put("loop2.sp_lo", "60");
    set_and_apply("loop2.sp_hi", "130"); /* 0.7 of the span */
    wish[CONTROLLER].ask[0] = on(EXCITE_SETPOINT, 1, 0.1);
    wish[CONTROLLER].ask[1] = on(EXCITE_MV, 0, 0.1);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.65, setpoint_of(BOTTOM));
    setpoint(BOTTOM, 125);
    tick();
    gone("limit");
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.65, setpoint_of(BOTTOM));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.65, wish[CONTROLLER].setpoint[1]);
}

static void an_interlock_ends_it_and_leaves_nothing_on_the_other_mvs(void)
{
    begin_with(blocks);
    put("lock1.meas", "feed");
    put("lock1.mv", "heat");
    put("lock1.limit", "8");
    put("lock1.delay", "2");
    set_and_apply("lock1.value", "0.3");
    excite_all();
    reading(FEED, 9);
    ticks(2);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_EXCITATION_ENDED, NULL)); /* the delay runs */
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_INTERLOCK_ON, "heat"));
    ended("interlock");
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.15, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, wish[CONTROLLER].setpoint[0]);
}

static void a_mode_change_ends_it(void)
{
    begin();
    excite_all();
    mode(BOTTOM, LOOP_MANUAL);
    tick();
    gone("mode");
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, setpoint_of(TOP));
}

static void cascaded(void)
{
    bench_cascade();
    put_block(CONTROLLER, "held", "outer", "spare feed");
}

static void a_mode_change_of_a_loop_below_ends_it(void)
{
    begin_with(cascaded);
    mode(BOTTOM, LOOP_CASCADE);
    mode(OUTER, LOOP_AUTO);
    ticks(2);
    wish[CONTROLLER].ask[0] = on(EXCITE_SETPOINT, 0, 0.1);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, setpoint_of(OUTER)); /* 100 of 60..160, and 0.1 */
    mode(BOTTOM, LOOP_AUTO);
    tick();
    ended("mode");
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, setpoint_of(OUTER));
}

static void an_inner_setpoint_stays_without_it_when_its_cascade_ends(void)
{
    begin_with(cascaded);
    put_block(CONTROLLER, "held", "bottom", "spare feed");
    apply();
    mode(BOTTOM, LOOP_CASCADE);
    mode(OUTER, LOOP_AUTO);
    ticks(3);
    double before = setpoint_of(BOTTOM);
    wish[CONTROLLER].ask[0] = on(EXCITE_SETPOINT, 0, 0.1);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, before + 0.1, setpoint_of(BOTTOM));
    mode(BOTTOM, LOOP_AUTO);
    tick();
    ended("mode");
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, before, setpoint_of(BOTTOM));
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, before, setpoint_of(BOTTOM));
}

static void a_hand_ends_it(void)
{
    begin();
    wish[ESTIMATOR].ask[0] = on(EXCITE_INPUT, 0, 0.1);
    request(REQUEST_OUTPUT, 0, SPARE, 0, 50);
    ticks(3);
    TEST_ASSERT_EQUAL(EXCITE_RUNS, wish[ESTIMATOR].state);
    request(REQUEST_OUTPUT, 0, SPARE, 0, 60);
    tick();
    ended("hand");
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, sent(SPARE));
}

static void a_hand_on_another_mv_does_not(void)
{
    begin();
    excite_all();
    request(REQUEST_OUTPUT, 0, SPARE, 0, 60);
    tick();
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_EXCITATION_ENDED, NULL));
}

static void a_measurement_that_is_lost_ends_it(void)
{
    begin();
    excite_all();
    bad_reading(T10, QUALITY_BAD, 0);
    ticks(9); /* held for 10 s */
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_EXCITATION_ENDED, NULL));
    ticks(3);
    gone("channel");
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
}

static void a_substitute_is_no_measurement(void)
{
    begin_with(blocks);
    put("meas2.fallback", "substitute");
    set_and_apply("meas2.substitute", "115");
    excite_all();
    bad_reading(T10, QUALITY_BAD, 0);
    ticks(12);
    gone("channel");
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
}

static void an_mv_that_is_lost_ends_it(void)
{
    begin();
    excite_all();
    bench.s.mv[HEAT].bound = false;
    tick();
    ended("channel");
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
}

static void feeding_forward(void)
{
    blocks();
    put_block(ESTIMATOR, "ahead", "", "T5 spare");
    strcpy(bench.config.block[ESTIMATOR].points, "heat");
}

static void a_block_that_has_no_turn_any_more_ends_it_in_that_tick(void)
{
    begin_with(feeding_forward);
    request(REQUEST_OUTPUT, 0, SPARE, 0, 50);
    tick();
    wish[ESTIMATOR].ask[0] = on(EXCITE_INPUT, 1, 0.1);
    ticks(3);
    TEST_ASSERT_EQUAL(EXCITE_RUNS, wish[ESTIMATOR].state);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, sent(SPARE));
    bench.s.measurement[T5].bound = false;
    tick();
    ended("channel");
    ASSERT_NO_BUMP(0.5, sent(SPARE));
}

static void the_safe_state_ends_it(void)
{
    begin();
    excite_all();
    supervisor_outputs_safe(&bench.s, "test");
    bench_events();
    ended("safe_state");
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, sent(REFLUX));
    tick();
    nothing_is_excited();
}

static void silence_of_the_link_ends_it(void)
{
    begin();
    excite_all();
    supervisor_go_safe(&bench.s, "link");
    supervisor_go_safe(&bench.s, "link");
    bench_events();
    ended("safe_state");
}

static void the_blocks_giving_up_ends_it(void)
{
    begin();
    excite_all();
    wish[CONTROLLER].gives_up = true;
    reading(T1, 85);
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_GAVE_UP, "test"));
    gone("gave_up");
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, setpoint_of(TOP));
}

static void an_input_that_makes_it_give_up_ends_it(void)
{
    begin();
    excite_all();
    bad_reading(FEED, QUALITY_BAD, 0);
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_GAVE_UP, "feed"));
    gone("gave_up");
}

static void switching_it_off_ends_it(void)
{
    begin();
    excite_all();
    request(REQUEST_BLOCK, PLAN_NONE, CONTROLLER, 0, 0);
    tick();
    gone("gave_up");
}

#if CONFIG_STEPS
static void a_sequence_ends_it_and_none_begins_while_one_runs(void)
{
    begin();
    excite_all();
    put("step1.seq", "stop");
    put("step1.until", "confirm");
    apply();
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_EXCITATION_ENDED, NULL));
    request(REQUEST_SEQUENCE, PLAN_NONE, PLAN_NONE, SEQUENCE_DO_STOP, 0);
    tick();
    gone("sequence");
    wish[ESTIMATOR].ask[0] = on(EXCITE_INPUT, 0, 0);
    wish[ESTIMATOR].ask[0].lo = num_from_float(-1);
    ticks(2);
    TEST_ASSERT_EQUAL(EXCITE_REFUSED, wish[ESTIMATOR].state);
    TEST_ASSERT_EQUAL(EXCITE_SEQUENCE, wish[ESTIMATOR].reason);
}
#endif

/* Changes of block, loop, MV, measurement and tick. */
static void a_plan_that_changes_what_it_is_about_ends_it(void)
{
    static const char *const changes[][2] = {
        {"loop1.gain", "3"}, {"mv2.max", "1.9"}, {"meas1.filter", "5"},
        {"meas2.hi", "170"}, {"tick.base", "2"},
    };
    for (unsigned k = 0; k < sizeof changes / sizeof changes[0]; k++) {
        begin();
        excite_all();
        set_and_apply(changes[k][0], changes[k][1]);
        bench_events();
        ended("settings");
        tick();
        gone("settings");
    }
}

static void a_plan_that_gives_it_other_settings_ends_it(void)
{
    begin();
    excite_all();
    put_size(CONTROLLER, 1);
    apply();
    tick();
    gone("settings");
}

static void a_plan_that_gives_it_other_loops_ends_it(void)
{
    begin();
    excite_all();
    put_block(CONTROLLER, "held", "top", "spare feed");
    apply();
    tick();
    gone("settings");
}

static void a_plan_without_the_mv_ends_it(void)
{
    begin();
    excite_all();
    put_all((const char *const[]){"loop2.name", "-", "loop2.pv", "-", "loop2.out", "-", "mv2.name",
                                  "-", "mv3.name", "-", NULL});
    put_block(CONTROLLER, "held", "top", "feed");
    put_block(ESTIMATOR, "shake", "", "feed");
    apply();
    bench_events();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_EXCITATION_ENDED, "settings"));
    tick();
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
}

static void a_plan_about_something_else_leaves_it_alone(void)
{
    begin();
    excite_all();
    put("meas9.name", "more");
    put_size(ESTIMATOR, 1);
    put("mv3.max", "0.9");
    set_and_apply("alarm1.on", "T1");
    tick();
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_EXCITATION_ENDED, NULL));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.27, setpoint_of(TOP));
}

static void a_block_of_another_kind_has_not_been_told_of_it(void)
{
    begin();
    excite_all();
    mode(TOP, LOOP_MANUAL);
    tick();
    put_block(ESTIMATOR, "", "", "");
    put_block(CONTROLLER, "shake", "", "spare feed");
    wish[ESTIMATOR] = (struct wish){0};
    apply();
    tick();
    TEST_ASSERT_EQUAL_UINT(1, wish[ESTIMATOR].steps);
    TEST_ASSERT_EQUAL(EXCITE_OFF, wish[ESTIMATOR].state);
}

static void more_than_it_said_ends_it(void)
{
    begin();
    excite_all();
    wish[CONTROLLER].ask[1].value = num_from_float(0.11f);
    tick();
    gone("wrong");
}

static void something_else_than_it_began_with_ends_it(void)
{
    begin();
    excite_all();
    wish[CONTROLLER].ask[1].what = EXCITE_NOTHING;
    tick();
    gone("wrong");
}

#ifndef REFLUX_FIXED_POINT
static void what_is_no_number_ends_it(void)
{
    begin();
    excite_all();
    wish[CONTROLLER].ask[0].value = NAN;
    tick();
    gone("wrong");
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(its_own_absolute_limit_ends_it);
    RUN_TEST(its_lower_limit_too);
    RUN_TEST(the_limits_of_the_loop_end_it);
    RUN_TEST(the_operating_limits_end_it);
    RUN_TEST(a_setpoint_that_would_pass_its_limits_ends_it);
    RUN_TEST(an_interlock_ends_it_and_leaves_nothing_on_the_other_mvs);
    RUN_TEST(a_mode_change_ends_it);
    RUN_TEST(a_mode_change_of_a_loop_below_ends_it);
    RUN_TEST(an_inner_setpoint_stays_without_it_when_its_cascade_ends);
    RUN_TEST(a_hand_ends_it);
    RUN_TEST(a_hand_on_another_mv_does_not);
    RUN_TEST(a_measurement_that_is_lost_ends_it);
    RUN_TEST(a_substitute_is_no_measurement);
    RUN_TEST(an_mv_that_is_lost_ends_it);
    RUN_TEST(a_block_that_has_no_turn_any_more_ends_it_in_that_tick);
    RUN_TEST(the_safe_state_ends_it);
    RUN_TEST(silence_of_the_link_ends_it);
    RUN_TEST(the_blocks_giving_up_ends_it);
    RUN_TEST(an_input_that_makes_it_give_up_ends_it);
    RUN_TEST(switching_it_off_ends_it);
#if CONFIG_STEPS
    RUN_TEST(a_sequence_ends_it_and_none_begins_while_one_runs);
#endif
    RUN_TEST(a_plan_that_changes_what_it_is_about_ends_it);
    RUN_TEST(a_plan_that_gives_it_other_settings_ends_it);
    RUN_TEST(a_plan_that_gives_it_other_loops_ends_it);
    RUN_TEST(a_plan_without_the_mv_ends_it);
    RUN_TEST(a_plan_about_something_else_leaves_it_alone);
    RUN_TEST(a_block_of_another_kind_has_not_been_told_of_it);
    RUN_TEST(more_than_it_said_ends_it);
    RUN_TEST(something_else_than_it_began_with_ends_it);
#ifndef REFLUX_FIXED_POINT
    RUN_TEST(what_is_no_number_ends_it);
#endif
    return UNITY_END();
}
