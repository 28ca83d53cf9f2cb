/* Modes, setpoints, requests, divisors, the safe state. */
#include "supervisor_bench.h"

void setUp(void)
{
    bench_start();
}
void tearDown(void) {}

static void after_start_everything_is_safe_and_in_manual(void)
{
    memset(&bench, 0, sizeof bench);
    bench.tick_ms = 1000;
    bench_config();
    put("mv1.safe", "3");
    event_queue_init(&bench.events);
    supervisor_init(&bench.s, &bench.events);
    apply();
    reading(T1, 85);
    reading(T10, 115);
    ticks(5);
    TEST_ASSERT_EQUAL(SUPERVISOR_SAFE, bench.s.state);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[TOP].mode);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.3, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
}

static void an_operators_first_act_ends_the_safe_state(void)
{
    supervisor_go_safe(&bench.s, "test");
    tick();
    TEST_ASSERT_EQUAL(SUPERVISOR_SAFE, bench.s.state);
    out(TOP, 4);
    tick();
    TEST_ASSERT_EQUAL(SUPERVISOR_RUN, bench.s.state);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT)); /* the others stay where they are safe */
}

static void going_safe_takes_every_loop_to_manual_and_says_why(void)
{
    put("mv2.safe", "0.2");
    apply();
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
    bench_forget_events();
    supervisor_go_safe(&bench.s, "link");
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_SAFE_STATE, "link"));
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[TOP].mode);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, sent(HEAT));
    supervisor_go_safe(&bench.s, "link");
    TEST_ASSERT_EQUAL(1, happened(EVENT_SAFE_STATE, NULL)); /* once */
}

static void automatic_moves_the_output_against_the_error(void)
{
    mode(BOTTOM, LOOP_AUTO);
    mode(TOP, LOOP_AUTO);
    tick();
    reading(T10, 110); /* too cold: heat */
    reading(T1, 88);   /* too warm: reflux, direct acting */
    tick();
    TEST_ASSERT_TRUE(sent(HEAT) > 0.5 + 0.07);
    TEST_ASSERT_TRUE(sent(REFLUX) > 0.5 + 0.05);
}

static void manual_keeps_the_output_automatic_left(void)
{
    mode(BOTTOM, LOOP_AUTO);
    tick();
    reading(T10, 111);
    ticks(20);
    double left = sent(HEAT);
    mode(BOTTOM, LOOP_MANUAL);
    ticks(20);
    TEST_ASSERT_DOUBLE_WITHIN(0, left, sent(HEAT));
    TEST_ASSERT_EQUAL(1, happened(EVENT_MODE, "bottom") - 1); /* one into auto, one out of it */
}

static void a_setpoint_in_manual_follows_the_measurement(void)
{
    reading(T10, 120);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, setpoint_of(BOTTOM));
    setpoint(BOTTOM, 130);
    TEST_ASSERT_EQUAL(1, happened(EVENT_REQUEST_REFUSED, "bottom"));
}

static void a_setpoint_of_ones_own_is_kept_in_manual_where_that_is_chosen(void)
{
    set_and_apply("loop2.sp_track", "off");
    setpoint(BOTTOM, 130);
    reading(T10, 120);
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.7, setpoint_of(BOTTOM));
    mode(BOTTOM, LOOP_AUTO);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.7, setpoint_of(BOTTOM));
}

static void a_setpoint_never_given_is_the_measurement_also_without_tracking(void)
{
    set_and_apply("loop2.name", "fresh"); /* another loop now, at rest since this plan */
    set_and_apply("loop2.sp_track", "off");
    reading(T10, 123);
    tick();
    mode(BOTTOM, LOOP_AUTO);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.63, setpoint_of(BOTTOM));
}

static void the_setpoint_automatic_had_is_kept_in_manual_without_tracking(void)
{
    set_and_apply("loop2.name", "fresh");
    set_and_apply("loop2.sp_track", "off");
    reading(T10, 123);
    tick();
    mode(BOTTOM, LOOP_AUTO);
    tick();
    mode(BOTTOM, LOOP_MANUAL);
    reading(T10, 130);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.63, setpoint_of(BOTTOM));
}

static void a_loop_may_enter_automatic_in_the_tick_that_brought_its_plan(void)
{
    set_and_apply("loop2.name", "fresh");
    reading(T10, 123);
    validate();
    mode(BOTTOM, LOOP_AUTO);
    supervisor_control(&bench.s);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.63, setpoint_of(BOTTOM)); /* not the foot of the span */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, sent(HEAT));
}

static void a_setpoint_outside_its_limits_is_refused(void)
{
    put("loop2.sp_lo", "100");
    put("loop2.sp_hi", "130");
    apply();
    mode(BOTTOM, LOOP_AUTO);
    tick();
    setpoint(BOTTOM, 131);
    setpoint(BOTTOM, 99);
    TEST_ASSERT_EQUAL(2, happened(EVENT_REQUEST_REFUSED, "bottom"));
    setpoint(BOTTOM, 130);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.7, setpoint_of(BOTTOM));
}

static void automatic_begins_inside_the_setpoint_limits_without_a_bump(void)
{
    put("loop2.sp_lo", "60");
    put("loop2.sp_hi", "110"); /* the measurement is above */
    apply();
    tick();
    mode(BOTTOM, LOOP_AUTO);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, setpoint_of(BOTTOM));
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    ticks(30);
    TEST_ASSERT_TRUE(sent(HEAT) < 0.5);
}

static void a_setpoint_ramp_moves_at_its_rate_and_arrives(void)
{
    set_and_apply("loop2.sp_ramp", "60"); /* one degree a second */
    mode(BOTTOM, LOOP_AUTO);
    tick();
    setpoint(BOTTOM, 120);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.56, setpoint_of(BOTTOM));
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.59, setpoint_of(BOTTOM));
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, D(N(0.6)), setpoint_of(BOTTOM));
}

static void a_setpoint_filter_goes_the_first_order_way(void)
{
    set_and_apply("loop2.sp_filter", "9");
    mode(BOTTOM, LOOP_AUTO);
    tick();
    setpoint(BOTTOM, 125);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.56, setpoint_of(BOTTOM)); /* a tenth of the way each tick */
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.569, setpoint_of(BOTTOM));
    ticks(300);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.65, setpoint_of(BOTTOM));
}

static void cascade_without_an_outer_loop_is_refused(void)
{
    mode(BOTTOM, LOOP_CASCADE);
    TEST_ASSERT_EQUAL(1, happened(EVENT_MODE_REFUSED, "bottom"));
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
}

static void a_loop_acts_only_while_its_channels_are_there(void)
{
    supervisor_unbind(&bench.s);
    supervisor_bind_measurement(&bench.s, T10);
    mode(BOTTOM, LOOP_AUTO);
    TEST_ASSERT_EQUAL(1, happened(EVENT_MODE_REFUSED, "bottom"));
    supervisor_unbind(&bench.s);
    supervisor_bind_mv(&bench.s, HEAT);
    mode(BOTTOM, LOOP_AUTO);
    TEST_ASSERT_EQUAL(2, happened(EVENT_MODE_REFUSED, "bottom"));
    supervisor_bind_measurement(&bench.s, T10);
    tick();
    mode(BOTTOM, LOOP_AUTO);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
}

static void a_loop_whose_channel_is_no_longer_bound_goes_to_manual(void)
{
    mode(BOTTOM, LOOP_AUTO);
    mode(TOP, LOOP_AUTO);
    tick();
    bench_forget_events();
    supervisor_unbind(&bench.s);
    supervisor_bind_measurement(&bench.s, T1);
    supervisor_bind_measurement(&bench.s, T10);
    supervisor_bind_mv(&bench.s, REFLUX); /* heat is gone */
    tick();
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
    TEST_ASSERT_EQUAL(1, happened(EVENT_MODE, "bottom")); /* and says so */
    TEST_ASSERT_EQUAL(0, happened(EVENT_MODE, "top"));
    supervisor_unbind(&bench.s);
    supervisor_bind_mv(&bench.s, REFLUX); /* and now T1 */
    tick();
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[TOP].mode);
    TEST_ASSERT_EQUAL(1, happened(EVENT_MODE, "bottom"));
    TEST_ASSERT_EQUAL(1, happened(EVENT_MODE, "top"));
}

static void a_manual_output_is_refused_while_the_loop_acts(void)
{
    mode(BOTTOM, LOOP_AUTO);
    out(BOTTOM, 1.8);
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_REQUEST_REFUSED, "bottom"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, sent(HEAT));
}

static void an_output_without_a_loop_can_be_moved_by_its_own_name(void)
{
    request(REQUEST_OUTPUT, PLAN_NONE, SPARE, 0, 70);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.7, sent(SPARE));
}

static void requests_to_what_is_not_there_are_refused(void)
{
    request(REQUEST_SETPOINT, CONFIG_LOOPS - 1, PLAN_NONE, 0, 0);
    request(REQUEST_OUTPUT, PLAN_NONE, CHANNEL_MAX - 1, 0, 0);
    request(REQUEST_MODE, 200, PLAN_NONE, 0, 0);
    request(REQUEST_OUTPUT, 0, 100, 0, 0);
    TEST_ASSERT_EQUAL(4, happened(EVENT_REQUEST_REFUSED, NULL));
    TEST_ASSERT_EQUAL(0, happened(EVENT_REQUEST_REFUSED, "plan"));
}

/* Restart and sequences go on only with what was done. */
static void whoever_asks_is_told_whether_it_was_done(void)
{
    put("loop1.sp_track", "off");
    apply();
    tick();
    const struct {
        struct request asked;
        bool done;
    } in_turn[] = {
        {{.kind = REQUEST_MODE, .loop = TOP, .output = PLAN_NONE, .mode = LOOP_CASCADE}, false},
        {{.kind = REQUEST_MODE, .loop = TOP, .output = PLAN_NONE, .mode = LOOP_MANUAL}, true},
        {{.kind = REQUEST_SETPOINT, .loop = TOP, .output = PLAN_NONE, .value = 59}, false},
        {{.kind = REQUEST_SETPOINT, .loop = TOP, .output = PLAN_NONE, .value = 161}, false},
        {{.kind = REQUEST_SETPOINT, .loop = TOP, .output = PLAN_NONE, .value = 60}, true},
        {{.kind = REQUEST_SETPOINT, .loop = TOP, .output = PLAN_NONE, .value = 160}, true},
        {{.kind = REQUEST_SETPOINT, .loop = BOTTOM, .output = PLAN_NONE, .value = 100}, false},
        {{.kind = REQUEST_OUTPUT, .loop = TOP, .output = PLAN_NONE, .value = 5}, true},
        {{.kind = REQUEST_OUTPUT, .loop = PLAN_NONE, .output = SPARE, .value = 50}, true},
        {{.kind = REQUEST_OUTPUT, .loop = PLAN_NONE, .output = REFLUX, .value = 5}, false},
        {{.kind = REQUEST_MODE, .loop = TOP, .output = PLAN_NONE, .mode = LOOP_AUTO}, true},
        {{.kind = REQUEST_MODE, .loop = TOP, .output = PLAN_NONE, .mode = LOOP_AUTO}, true},
        {{.kind = REQUEST_OUTPUT, .loop = TOP, .output = PLAN_NONE, .value = 5}, false},
        {{.kind = REQUEST_SETPOINT, .loop = TOP, .output = PLAN_NONE, .value = 90}, true},
        {{.kind = REQUEST_MODE, .loop = 200, .output = PLAN_NONE, .mode = LOOP_AUTO}, false},
    };
    for (unsigned k = 0; k < sizeof in_turn / sizeof in_turn[0]; k++) {
        struct request r = in_turn[k].asked;
        char message[20];
        snprintf(message, sizeof message, "request %u", k);
        r.plan = bench.s.plan->serial;
        TEST_ASSERT_EQUAL_MESSAGE(in_turn[k].done, supervisor_request(&bench.s, &r), message);
    }
}

/* Checked with one plan, its turn comes under another, in which something else stands in the same place. */
static void a_request_that_meets_another_plan_is_refused_whatever_stands_in_its_place(void)
{
    struct request asked[] = {
        {.kind = REQUEST_MODE, .loop = BOTTOM, .output = PLAN_NONE, .mode = LOOP_AUTO},
        {.kind = REQUEST_SETPOINT, .loop = BOTTOM, .output = PLAN_NONE, .value = 120},
        {.kind = REQUEST_OUTPUT, .loop = BOTTOM, .output = PLAN_NONE, .value = 1.8f},
        {.kind = REQUEST_OUTPUT, .loop = PLAN_NONE, .output = SPARE, .value = 70},
        {.kind = REQUEST_ACK, .loop = PLAN_NONE, .output = 0},
        {.kind = REQUEST_SHELVE, .loop = PLAN_NONE, .output = 0, .value = 60}};
    const unsigned n = sizeof asked / sizeof asked[0];
    for (unsigned k = 0; k < n; k++)
        asked[k].plan = bench.s.plan->serial;
    put_all((const char *const[]){"alarm1.on", "T10", "alarm1.limit", "110", "loop2.name", "other",
                                  "loop2.sp_track", "off", "mv3.name", "another", NULL});
    apply();
    tick();
    bench_forget_events();
    double heat = sent(HEAT), spare = sent(SPARE), sp = setpoint_of(BOTTOM);
    for (unsigned k = 0; k < n; k++)
        TEST_ASSERT_FALSE(supervisor_request(&bench.s, &asked[k]));
    TEST_ASSERT_EQUAL(n, happened(EVENT_REQUEST_REFUSED, "plan"));
    tick();
    TEST_ASSERT_EQUAL(n, bench.n_seen);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_DOUBLE_WITHIN(0, sp, setpoint_of(BOTTOM));
    TEST_ASSERT_DOUBLE_WITHIN(0, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(0, spare, sent(SPARE));
    TEST_ASSERT_FALSE(bench.s.alarm[0].acknowledged);
    TEST_ASSERT_EQUAL(0, bench.s.alarm[0].shelved_until_ms);
    mode(BOTTOM, LOOP_AUTO); /* asked anew */
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
}

static void a_loop_runs_only_in_the_ticks_of_its_divisor_and_phase(void)
{
    put("loop2.divisor", "4");
    put("loop2.phase", "1");
    apply();
    mode(BOTTOM, LOOP_AUTO);
    ticks(8);
    for (unsigned n = 0; n < 40; n++) {
        double before = sent(HEAT);
        bool due = bench.s.ticks % 4 == 1;
        reading(T10, 115 - 0.1 * (n + 1));
        tick();
        if (due)
            TEST_ASSERT_TRUE(sent(HEAT) > before);
        else
            TEST_ASSERT_DOUBLE_WITHIN(0, before, sent(HEAT));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(after_start_everything_is_safe_and_in_manual);
    RUN_TEST(an_operators_first_act_ends_the_safe_state);
    RUN_TEST(going_safe_takes_every_loop_to_manual_and_says_why);
    RUN_TEST(automatic_moves_the_output_against_the_error);
    RUN_TEST(manual_keeps_the_output_automatic_left);
    RUN_TEST(a_setpoint_in_manual_follows_the_measurement);
    RUN_TEST(a_setpoint_of_ones_own_is_kept_in_manual_where_that_is_chosen);
    RUN_TEST(a_setpoint_never_given_is_the_measurement_also_without_tracking);
    RUN_TEST(the_setpoint_automatic_had_is_kept_in_manual_without_tracking);
    RUN_TEST(a_loop_may_enter_automatic_in_the_tick_that_brought_its_plan);
    RUN_TEST(a_setpoint_outside_its_limits_is_refused);
    RUN_TEST(automatic_begins_inside_the_setpoint_limits_without_a_bump);
    RUN_TEST(a_setpoint_ramp_moves_at_its_rate_and_arrives);
    RUN_TEST(a_setpoint_filter_goes_the_first_order_way);
    RUN_TEST(cascade_without_an_outer_loop_is_refused);
    RUN_TEST(a_loop_acts_only_while_its_channels_are_there);
    RUN_TEST(a_loop_whose_channel_is_no_longer_bound_goes_to_manual);
    RUN_TEST(a_manual_output_is_refused_while_the_loop_acts);
    RUN_TEST(an_output_without_a_loop_can_be_moved_by_its_own_name);
    RUN_TEST(requests_to_what_is_not_there_are_refused);
    RUN_TEST(whoever_asks_is_told_whether_it_was_done);
    RUN_TEST(a_request_that_meets_another_plan_is_refused_whatever_stands_in_its_place);
    RUN_TEST(a_loop_runs_only_in_the_ticks_of_its_divisor_and_phase);
    return UNITY_END();
}
