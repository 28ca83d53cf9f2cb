/* Test signals that blocks ask for: while they run, and who may have the plant. What ends them: test_excitation_ends.c. */
#include "exciting_bench.h"
#include "supervise/restart.h"

void setUp(void) {}
void tearDown(void) {}

/* ---- while it runs ---- */

static void what_is_asked_for_is_in_the_commands_of_the_same_tick(void)
{
    begin();
    wish[CONTROLLER].ask[0] = on(EXCITE_MV, 0, 0.05);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(REFLUX));
    wish[CONTROLLER].ask[0].value = num_from_float(-0.1f);
    tick();
    TEST_ASSERT_EQUAL(EXCITE_RUNS, wish[CONTROLLER].state);
    TEST_ASSERT_EQUAL_STRING("held", wish[CONTROLLER].holder);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, sent(HEAT));
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_EXCITATION_BEGUN, NULL));
}

static void a_setpoint_is_excited_from_its_next_turn_on_and_the_block_sees_it(void)
{
    begin();
    wish[CONTROLLER].ask[0] = on(EXCITE_SETPOINT, 1, 0.1);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, setpoint_of(BOTTOM));
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.65, setpoint_of(BOTTOM));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.65, wish[CONTROLLER].setpoint[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, setpoint_of(TOP));
}

static void it_is_added_behind_ramp_and_filter_which_know_nothing_of_it(void)
{
    begin_with(blocks);
    put("loop2.sp_filter", "10");
    set_and_apply("loop2.sp_ramp", "60");
    setpoint(BOTTOM, 118);
    ticks(3);
    double before = setpoint_of(BOTTOM);
    wish[CONTROLLER].ask[0] = on(EXCITE_SETPOINT, 1, 0.1);
    ticks(2);
    double with = setpoint_of(BOTTOM);
    wish[CONTROLLER].ask[0].what = EXCITE_NOTHING;
    tick();
    double without = setpoint_of(BOTTOM);
    TEST_ASSERT_TRUE(with > before + 0.1 && with < before + 0.12);
    TEST_ASSERT_TRUE(without > before && without < before + 0.03);
}

static void what_it_needs_no_more_ends_with_its_asking(void)
{
    begin();
    excite_all();
    memset(wish[CONTROLLER].ask, 0, sizeof wish[CONTROLLER].ask);
    tick();
    gone("asked");
    tick();
    TEST_ASSERT_EQUAL(EXCITE_OFF, wish[CONTROLLER].state);
}

static void loops_that_act_take_no_notice_of_it(void)
{
    begin();
    put_block(CONTROLLER, "held", "top", "spare feed");
    apply(); /* bottom has its PID again, which integrates */
    mode(BOTTOM, LOOP_AUTO);
    wish[ESTIMATOR].ask[0] = on(EXCITE_INPUT, 0, 0.1);
    strcpy(bench.config.block[ESTIMATOR].inputs, "heat feed");
    apply();
    reading(T10, 115);
    ticks(100);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.6, sent(HEAT));
    TEST_ASSERT_EQUAL(EXCITE_RUNS, wish[ESTIMATOR].state);
}

/* ---- behind a rate limit, which lets only part of the signal through ---- */

/* 0.01 of the span a tick, where the signals are 0.05 and 0.1. */
static void begin_behind_a_rate_limit(void)
{
    begin();
    put("mv1.rate", "0.1");
    set_and_apply("mv2.rate", "0.02");
}

/* Up for three ticks, then down: what is sent never holds the whole signal. */
static void swing_behind_the_rate(void)
{
    wish[CONTROLLER].ask[0] = on(EXCITE_MV, 0, 0.05);
    ticks(3);
    wish[CONTROLLER].ask[0].value = num_from_float(-0.05f);
    tick();
    TEST_ASSERT_EQUAL(EXCITE_RUNS, wish[CONTROLLER].state);
    TEST_ASSERT_TRUE(sent(REFLUX) > 0.5 && sent(REFLUX) < 0.55);
}

static void
a_loop_that_goes_to_manual_behind_a_rate_limit_returns_to_the_value_without_the_signal(void)
{
    begin_behind_a_rate_limit();
    swing_behind_the_rate();
    mode(TOP, LOOP_MANUAL);
    ticks(3);
    for (unsigned k = 0; k < 30; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, sent(REFLUX));
        tick();
    }
}

static void a_restart_behind_a_rate_limit_comes_back_at_the_value_without_the_signal(void)
{
    begin_behind_a_rate_limit();
    swing_behind_the_rate();
    struct restart_record kept = {0};
    struct restart r;
    restart_init(&r, &kept, false);
    restart_keep(&r, &bench.s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, D(kept.mv[REFLUX]));
}

/* The PID must not take the missing part of the signal for a limit and wind its integral back. */
static void loops_that_act_behind_a_rate_limit_take_no_notice_of_it(void)
{
    begin_behind_a_rate_limit();
    put_block(CONTROLLER, "held", "top", "spare feed");
    apply();
    mode(BOTTOM, LOOP_AUTO);
    reading(T10, 115);
    ticks(2);
    double before = sent(HEAT);
    wish[ESTIMATOR].ask[0] = on(EXCITE_INPUT, 0, 0.1);
    strcpy(bench.config.block[ESTIMATOR].inputs, "heat feed");
    apply();
    for (unsigned k = 0; k < 200; k++) {
        wish[ESTIMATOR].ask[0].value = num_from_float(k / 3 % 2 ? -0.1f : 0.1f);
        tick();
    }
    TEST_ASSERT_EQUAL(EXCITE_RUNS, wish[ESTIMATOR].state);
    wish[ESTIMATOR].ask[0].what = EXCITE_NOTHING;
    ticks(60);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, before, sent(HEAT));
}

static void compensated(void)
{
    put_block(ESTIMATOR, "pass", "top", "");
}

/* One that takes over from nobody: the controller goes on as it would with any other setpoint. */
static void a_compensator_excites_a_setpoint_to_which_the_controller_answers(void)
{
    begin_with(compensated);
    double before = sent(REFLUX);
    wish[ESTIMATOR].ask[0] = on(EXCITE_SETPOINT, 0, 0.02);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, before - 0.04, sent(REFLUX)); /* direct, gain 2 */
    wish[ESTIMATOR].ask[0].what = EXCITE_NOTHING;
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, before, sent(REFLUX));
}

static void between_its_steps_it_stays(void)
{
    begin_with(blocks);
    put("loop1.divisor", "3");
    set_and_apply("loop2.divisor", "3");
    wish[CONTROLLER].ask[0] = on(EXCITE_MV, 0, 0.05);
    wish[CONTROLLER].ask[1] = on(EXCITE_SETPOINT, 0, 0.02);
    ticks(6);
    unsigned steps = wish[CONTROLLER].steps;
    for (int k = 0; k < 7; k++) {
        tick();
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(REFLUX));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.27, setpoint_of(TOP));
    }
    TEST_ASSERT_TRUE(wish[CONTROLLER].steps < steps + 4);
}

static void an_estimator_excites_an_mv_among_its_inputs_in_manual(void)
{
    begin();
    request(REQUEST_OUTPUT, 0, SPARE, 0, 50);
    wish[ESTIMATOR].ask[0] = on(EXCITE_INPUT, 0, 0.1);
    ticks(2); /* the first asking meets the output before it was moved */
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, sent(SPARE));
    TEST_ASSERT_EQUAL(EXCITE_RUNS, wish[ESTIMATOR].state);
}

static void a_restart_comes_back_without_it(void)
{
    begin();
    excite_all();
    struct restart_record kept = {0};
    struct restart r;
    restart_init(&r, &kept, false);
    restart_keep(&r, &bench.s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, D(kept.setpoint[TOP]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, D(kept.mv[REFLUX]));
}

/* ---- one owner at a time ---- */

static void after_an_end_it_is_told_why_and_has_to_pause_before_it_asks_again(void)
{
    begin();
    excite_all();
    supervisor_request(&bench.s, &(struct request){.kind = REQUEST_BLOCK,
                                                   .output = CONTROLLER,
                                                   .plan = bench.s.plan->serial});
    request(REQUEST_BLOCK, PLAN_NONE, CONTROLLER, 1, 0);
    ticks(3);
    TEST_ASSERT_EQUAL(EXCITE_ENDED, wish[CONTROLLER].state);
    TEST_ASSERT_EQUAL(EXCITE_GAVE_UP, wish[CONTROLLER].reason);
    nothing_is_excited();
    struct wish before = wish[CONTROLLER];
    memset(wish[CONTROLLER].ask, 0, sizeof before.ask);
    tick();
    memcpy(wish[CONTROLLER].ask, before.ask, sizeof before.ask);
    tick();
    TEST_ASSERT_EQUAL(EXCITE_OFF, wish[CONTROLLER].state);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(REFLUX));
    TEST_ASSERT_EQUAL_UINT(2, happened(EVENT_EXCITATION_BEGUN, NULL));
}

static void who_asks_for_what_is_taken_is_told_who_has_it_and_gets_it_when_it_is_free(void)
{
    begin();
    excite_all();
    request(REQUEST_OUTPUT, 0, SPARE, 0, 50);
    tick();
    wish[ESTIMATOR].ask[0] = on(EXCITE_INPUT, 0, 0.1);
    ticks(2);
    TEST_ASSERT_EQUAL(EXCITE_REFUSED, wish[ESTIMATOR].state);
    TEST_ASSERT_EQUAL(EXCITE_TAKEN, wish[ESTIMATOR].reason);
    TEST_ASSERT_EQUAL_STRING("held", wish[ESTIMATOR].holder);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, sent(SPARE));
    memset(wish[CONTROLLER].ask, 0, sizeof wish[CONTROLLER].ask);
    ticks(3);
    TEST_ASSERT_EQUAL(EXCITE_RUNS, wish[ESTIMATOR].state);
    TEST_ASSERT_EQUAL_STRING("shake", wish[ESTIMATOR].holder);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, sent(SPARE));
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
}

static void while_start_up_tests_no_block_excites(void)
{
    begin();
    bench.s.testing = true;
    wish[CONTROLLER].ask[0] = on(EXCITE_MV, 0, 0.05);
    ticks(2);
    TEST_ASSERT_EQUAL(EXCITE_REFUSED, wish[CONTROLLER].state);
    TEST_ASSERT_EQUAL(EXCITE_TAKEN, wish[CONTROLLER].reason);
    TEST_ASSERT_EQUAL_STRING("commission", wish[CONTROLLER].holder);
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    bench.s.testing = false;
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(REFLUX));
}

static void what_cannot_be_excited_is_refused(void)
{
    static const struct {
        unsigned what;
        uint8_t which;
        enum excite_reason reason;
    } wrong[] = {
        {EXCITE_SETPOINT + 1, 0, EXCITE_WRONG}, {EXCITE_MV, 2, EXCITE_WRONG},
        {EXCITE_SETPOINT, 2, EXCITE_WRONG},     {EXCITE_INPUT, 2, EXCITE_WRONG},
        {EXCITE_INPUT, 1, EXCITE_WRONG}, /* a measurement */
        {EXCITE_INPUT, 0, EXCITE_LIMIT}, /* spare stands at its lower end */
    };
    for (unsigned k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        begin();
        wish[CONTROLLER].ask[0] = on((enum excite_what)wrong[k].what, wrong[k].which, 0.05);
        ticks(2);
        TEST_ASSERT_EQUAL(EXCITE_REFUSED, wish[CONTROLLER].state);
        TEST_ASSERT_EQUAL(wrong[k].reason, wish[CONTROLLER].reason);
        TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_EXCITATION_BEGUN, NULL));
        nothing_is_excited();
    }
}

static void refused_with(struct block_excitation a, struct block_excitation b,
                         enum excite_reason reason)
{
    begin();
    wish[CONTROLLER].ask[0] = a;
    wish[CONTROLLER].ask[3] = b;
    ticks(2);
    TEST_ASSERT_EQUAL(EXCITE_REFUSED, wish[CONTROLLER].state);
    TEST_ASSERT_EQUAL(reason, wish[CONTROLLER].reason);
    nothing_is_excited();
}

static void the_same_twice_and_numbers_that_make_no_sense_are_refused(void)
{
    const struct block_excitation nothing = {0};
    struct block_excitation a = on(EXCITE_MV, 0, 0.05);
    refused_with(a, a, EXCITE_WRONG);
    a.amplitude = num_zero();
    refused_with(a, nothing, EXCITE_WRONG);
    a = on(EXCITE_MV, 0, 0.05);
    a.lo = num_from_float(0.8f);
    a.hi = num_from_float(0.2f);
    refused_with(a, nothing, EXCITE_WRONG);
}

static void without_room_for_its_amplitude_it_does_not_begin(void)
{
    const struct block_excitation nothing = {0};
    struct block_excitation a = on(EXCITE_MV, 0, 0.0);
    a.lo = num_from_float(0.45f);
    refused_with(a, nothing, EXCITE_LIMIT);
    a = on(EXCITE_SETPOINT, 0, 0.0);
    a.hi = num_from_float(0.3f);
    refused_with(a, nothing, EXCITE_LIMIT);
}

static void the_setpoint_of_a_loop_in_manual_is_not_excited(void)
{
    begin();
    mode(BOTTOM, LOOP_MANUAL);
    wish[CONTROLLER].ask[0] = on(EXCITE_SETPOINT, 1, 0.05);
    ticks(2);
    TEST_ASSERT_EQUAL(EXCITE_REFUSED, wish[CONTROLLER].state);
    TEST_ASSERT_EQUAL(EXCITE_MODE, wish[CONTROLLER].reason);
}

static void nothing_is_excited_in_the_safe_state(void)
{
    memset(wish, 0, sizeof wish);
    bench_start_with(blocks);
    supervisor_outputs_safe(&bench.s, "test");
    wish[ESTIMATOR].ask[0] = on(EXCITE_INPUT, 0, 0.05);
    wish[ESTIMATOR].ask[0].lo = num_from_float(-1);
    ticks(2);
    TEST_ASSERT_EQUAL(EXCITE_REFUSED, wish[ESTIMATOR].state);
    TEST_ASSERT_EQUAL(EXCITE_SAFE, wish[ESTIMATOR].reason);
}

static void a_held_mv_is_not_excited(void)
{
    begin_with(blocks);
    put("lock1.meas", "feed");
    put("lock1.mv", "spare");
    put("lock1.value", "50");
    set_and_apply("lock1.limit", "4");
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, sent(SPARE));
    request(REQUEST_OUTPUT, 0, SPARE, 0, 50);
    wish[CONTROLLER].ask[0] = on(EXCITE_INPUT, 0, 0.05);
    ticks(2);
    TEST_ASSERT_EQUAL(EXCITE_REFUSED, wish[CONTROLLER].state);
    TEST_ASSERT_EQUAL(EXCITE_INTERLOCK, wish[CONTROLLER].reason);
}

static void when_none_of_its_loops_acts_any_more_it_ends(void)
{
    begin();
    request(REQUEST_OUTPUT, 0, SPARE, 0, 50);
    tick();
    wish[CONTROLLER].ask[0] = on(EXCITE_INPUT, 0, 0.05);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(SPARE));
    mode(TOP, LOOP_MANUAL);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(SPARE));
    mode(BOTTOM, LOOP_MANUAL);
    tick();
    ended("mode");
    ASSERT_NO_BUMP(0.5, sent(SPARE));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_is_asked_for_is_in_the_commands_of_the_same_tick);
    RUN_TEST(a_setpoint_is_excited_from_its_next_turn_on_and_the_block_sees_it);
    RUN_TEST(it_is_added_behind_ramp_and_filter_which_know_nothing_of_it);
    RUN_TEST(what_it_needs_no_more_ends_with_its_asking);
    RUN_TEST(loops_that_act_take_no_notice_of_it);
    RUN_TEST(
        a_loop_that_goes_to_manual_behind_a_rate_limit_returns_to_the_value_without_the_signal);
    RUN_TEST(a_restart_behind_a_rate_limit_comes_back_at_the_value_without_the_signal);
    RUN_TEST(loops_that_act_behind_a_rate_limit_take_no_notice_of_it);
    RUN_TEST(a_compensator_excites_a_setpoint_to_which_the_controller_answers);
    RUN_TEST(between_its_steps_it_stays);
    RUN_TEST(an_estimator_excites_an_mv_among_its_inputs_in_manual);
    RUN_TEST(a_restart_comes_back_without_it);
    RUN_TEST(after_an_end_it_is_told_why_and_has_to_pause_before_it_asks_again);
    RUN_TEST(who_asks_for_what_is_taken_is_told_who_has_it_and_gets_it_when_it_is_free);
    RUN_TEST(while_start_up_tests_no_block_excites);
    RUN_TEST(what_cannot_be_excited_is_refused);
    RUN_TEST(the_same_twice_and_numbers_that_make_no_sense_are_refused);
    RUN_TEST(without_room_for_its_amplitude_it_does_not_begin);
    RUN_TEST(the_setpoint_of_a_loop_in_manual_is_not_excited);
    RUN_TEST(nothing_is_excited_in_the_safe_state);
    RUN_TEST(a_held_mv_is_not_excited);
    RUN_TEST(when_none_of_its_loops_acts_any_more_it_ends);
    return UNITY_END();
}
