/* Compensators with a number (blockN), between the loops' controllers and their MVs: forwards, backwards, and what comes and
 * goes. */
#include "put_block.h"
#include "settings/block_parameters.h"
#include "supervisor_bench.h"

#include "plan/plan_build.h"
#include "stage_kinds.h"

enum { THIRD = 2 };

/* Move of a loop's own output in a tick, by integration: it goes on while members come and go. */
#define OWN_MOVE 1.5e-4

static struct cross *cross_at(unsigned n)
{
    return supervisor_block(&bench.s, (uint8_t)(BLOCK_NUMBERED + n));
}

static void set_setting(unsigned n, unsigned offset, float x)
{
    struct block_config *b = &bench.config.block[n];
    memcpy(bench.config.pool + b->offset + offset, &x, sizeof x);
}

#define SET_CROSS(n, member, x) set_setting(n, offsetof(struct cross_settings, member), x)

static void crossed(void)
{
    put("meas3.hold", "2");
    put_block(0, "cross", "top bottom", "", "");
}

static void both_auto(void)
{
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
}

static void crossed_auto(void (*more)(void))
{
    bench_start_with(more);
    both_auto();
}

void setUp(void)
{
    stage_fails.fault = STAGE_WELL;
    stage_excites = (struct block_excitation){0};
}
void tearDown(void) {}

/* ---- forwards ---- */

static void a_controller_moves_both_outputs_each_in_its_time(void)
{
    crossed_auto(crossed);
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    reading(T10, 114); /* a step of 0.015 of bottom's output */
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.5 + 0.015, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.5 + 0.8 * 0.1 * 0.015, sent(REFLUX));
    ticks(60);
    double v = D(bench.s.loop[BOTTOM].v) - 0.015;
    TEST_ASSERT_TRUE(v > 0);
    TEST_ASSERT_TRUE(sent(REFLUX) > 0.5 + 0.8 * 0.0145);
}

static void it_runs_in_every_tick_whatever_the_divisors_of_its_loops(void)
{
    bench_start_with(crossed);
    put_all((const char *const[]){"loop1.divisor", "5", "loop2.divisor", "3", NULL});
    apply();
    both_auto();
    unsigned steps = cross_at(0)->steps;
    ticks(7);
    TEST_ASSERT_EQUAL_UINT(steps + 7, cross_at(0)->steps);
    TEST_ASSERT_EQUAL_UINT(cross_at(0)->steps, cross_at(0)->backs);
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
}

static void a_ratio_to_another_mv(void)
{
    bench_start_with(crossed);
    put("mv3.hi", "10");
    put("mv3.max", "10");
    strcpy(bench.config.block[0].inputs, "spare");
    SET_CROSS(0, ratio, 0.5f);
    apply();
    request(REQUEST_OUTPUT, TOP, SPARE, 0, 2);
    tick();
    both_auto();
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    request(REQUEST_OUTPUT, TOP, SPARE, 0, 4);
    ticks(2); /* what has been applied is looked at in the next tick */
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.5 + 0.5 * 0.2, sent(REFLUX));
}

static void its_work_is_done_as_that_of_other_blocks(void)
{
    crossed_auto(crossed);
    cross_at(0)->ask_work = 3;
    tick();
    struct jobs jobs = {0};
    TEST_ASSERT_EQUAL(ERR_OK, jobs_add(&jobs, &bench.s.work[0]));
    while (jobs_work(&jobs))
        ;
    ticks(5);
    TEST_ASSERT_EQUAL_UINT(1, cross_at(0)->results);
}

static void switched(unsigned n, bool on)
{
    request(REQUEST_BLOCK, PLAN_NONE, (uint8_t)n, on, 0);
}

/* Its state is what the main loop is working on. */
static void switched_on_again_in_the_midst_of_its_work_it_begins_anew_only_after_that(void)
{
    crossed_auto(crossed);
    bench.s.work[0].working = true; /* the tick has interrupted a piece */
    struct cross before = *cross_at(0);
    TEST_ASSERT_TRUE(before.steps > 0);
    switched(0, false);
    switched(0, true);
    TEST_ASSERT_EQUAL_MEMORY(&before, cross_at(0), sizeof before);
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(before.steps, cross_at(0)->steps);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_BLOCK_ON, "cross"));
    bench.s.work[0].working = false;
    ticks(2);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_ON, "cross"));
    TEST_ASSERT_EQUAL_UINT(2, cross_at(0)->steps);
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
}

static void switched_off_while_it_waits_to_come_on_it_stays_off(void)
{
    crossed_auto(crossed);
    bench.s.work[0].working = true;
    switched(0, false);
    switched(0, true);
    switched(0, false);
    bench.s.work[0].working = false;
    ticks(2);
    TEST_ASSERT_TRUE(bench.s.block[BLOCK_NUMBERED].off);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_BLOCK_ON, "cross"));
}

static void it_may_ask_for_a_test_signal_of_which_the_way_back_takes_no_notice(void)
{
    bench_start_with(crossed);
    put_all((const char *const[]){"loop1.ti", "100000", "loop2.ti", "100000", NULL});
    apply();
    both_auto();
    num_t v = bench.s.loop[TOP].v;
    stage_excites = (struct block_excitation){EXCITE_MV, 0, N(0.02), N(0.02), N(0), N(1)};
    ticks(5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.52, sent(REFLUX));
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(BUMP, D(v), D(bench.s.loop[TOP].v));
    mode(TOP, LOOP_MANUAL);
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_EXCITATION_ENDED, NULL));
}

/* ---- members come and go ---- */

static void a_member_that_leaves_and_comes_back_moves_nobodys_output(void)
{
    crossed_auto(crossed);
    reading(T10, 114.3);
    reading(T1, 85.2);
    ticks(20);
    double heat = sent(HEAT), reflux = sent(REFLUX);
    mode(TOP, LOOP_MANUAL);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    ASSERT_NO_BUMP(reflux, sent(REFLUX));
    reading(T10, 113.5);
    ticks(10); /* alone: what is in manual neither moves nor is moved */
    ASSERT_NO_BUMP(reflux, sent(REFLUX));
    /* It is told where that is, all the same. */
    TEST_ASSERT_TRUE(num_eq(bench.s.loop[TOP].v, cross_at(0)->in[0]));
    TEST_ASSERT_TRUE(num_eq(num_zero(), cross_at(0)->back_in[0]));
    heat = sent(HEAT);
    out(TOP, 3);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    heat = sent(HEAT);
    mode(TOP, LOOP_AUTO);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, 0.3, sent(REFLUX));
    TEST_ASSERT_EQUAL(3, cross_at(0)->mask);
}

static void a_member_that_was_away_between_two_ticks_begins_anew(void)
{
    crossed_auto(crossed);
    reading(T1, 90);
    tick();
    TEST_ASSERT_FALSE(num_eq(cross_at(0)->in[0], cross_at(0)->x[0])); /* its lag is under way */
    double heat = sent(HEAT);
    mode(TOP, LOOP_MANUAL);
    out(TOP, 3);
    mode(TOP, LOOP_AUTO);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, 0.3, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, D(cross_at(0)->in[0]), D(cross_at(0)->x[0]));
}

static void an_interlock_on_one_mv_leaves_the_other_alone(void)
{
    bench_start_with(crossed);
    put_all((const char *const[]){"lock1.meas", "feed", "lock1.mv", "heat", "lock1.limit", "8",
                                  "lock1.value", "0.2", NULL});
    apply();
    both_auto();
    double reflux = sent(REFLUX);
    reading(FEED, 9);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, sent(HEAT));
    tick();
    unsigned follows = cross_at(0)->follows;
    ticks(5);
    ASSERT_NO_BUMP(reflux, sent(REFLUX));
    TEST_ASSERT_EQUAL(1, cross_at(0)->mask);
    TEST_ASSERT_EQUAL_UINT(follows, cross_at(0)->follows); /* its lags go on */
    reading(FEED, 5);
    ticks(2);
    TEST_ASSERT_EQUAL(3, cross_at(0)->mask);
    ASSERT_NO_BUMP(0.1, sent(HEAT));
    ASSERT_NO_BUMP(reflux, sent(REFLUX));
}

static void after_the_safe_state_it_begins_again_without_a_bump(void)
{
    crossed_auto(crossed);
    reading(T10, 112);
    ticks(20);
    supervisor_go_safe(&bench.s, "test");
    ticks(3);
    unsigned steps = cross_at(0)->steps;
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(steps, cross_at(0)->steps);
    out(TOP, 4);
    out(BOTTOM, 0.6);
    tick();
    reading(T10, 115);
    tick();
    both_auto();
    ASSERT_NO_BUMP(0.4, sent(REFLUX));
    ASSERT_NO_BUMP(0.3, sent(HEAT));
}

/* ---- backwards ---- */

static void nothing_limited_is_nothing_told(void)
{
    bench_start_with(crossed);
    put_all((const char *const[]){"loop1.ti", "100000", "loop2.ti", "100000", "loop1.tt", "5",
                                  "loop2.tt", "5", NULL});
    apply();
    both_auto();
    num_t top = bench.s.loop[TOP].v, bottom = bench.s.loop[BOTTOM].v;
    ticks(200);
    TEST_ASSERT_TRUE(num_eq(top, bench.s.loop[TOP].v));
    TEST_ASSERT_TRUE(num_eq(bottom, bench.s.loop[BOTTOM].v));
}

static void a_limit_on_one_mv_winds_nobody_up(void)
{
    bench_start_with(crossed);
    put("mv1.max", "5.5");
    apply();
    both_auto();
    reading(T1, 100); /* direct: reflux to its limit */
    ticks(600);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 0.55, D(bench.s.loop[TOP].v));
    reading(T1, 83);
    ticks(3);
    TEST_ASSERT_TRUE(sent(REFLUX) < 0.54);
}

static void what_took_effect_is_in_the_compensators_state(void)
{
    bench_start_with(crossed);
    put("mv1.max", "5.1");
    apply();
    both_auto();
    double before = D(cross_at(0)->x[0]), v = D(bench.s.loop[TOP].v);
    reading(T1, 95); /* 0.2 more is asked for, 0.01 of reflux is there */
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, v + 0.2, D(cross_at(0)->in[0]));
    TEST_ASSERT_TRUE(D(cross_at(0)->x[0]) > before);
    TEST_ASSERT_TRUE(D(cross_at(0)->x[0]) < before + 0.1 * 0.02);
}

/* Controller output that member k of the first compensator gets: behind the state, in the arena. */
static num_t passed_told(unsigned k)
{
    const struct block_state *b = &bench.s.block[BLOCK_NUMBERED];
    const num_t(*end)[2] = (const num_t(*)[2])bench.s.arena + b->grain + b->grains;
    return end[(int)k - 2][0];
}

static void what_is_beyond_all_numbers_is_told_as_a_whole(void)
{
    bench_start_with(crossed);
    SET_CROSS(0, k12, 100);
    SET_CROSS(0, k21, 0);
    SET_CROSS(0, lag, 0);
    put("loop2.gain", "20");
    apply();
    both_auto();
    unsigned follows = cross_at(0)->follows;
    reading(T10, 70);
    tick();
    TEST_ASSERT_EQUAL_UINT(follows + 1, cross_at(0)->follows);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, sent(REFLUX));
    TEST_ASSERT_TRUE(D(bench.s.mv[REFLUX].commanded) > 100);
    TEST_ASSERT_TRUE(D(bench.s.mv[REFLUX].commanded) <= 128); /* in both number formats */
    /* Nine spans of bottom's output, of which one took effect: so many of top's, then. */
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -99, D(passed_told(TOP)));
    ticks(9);
    reading(T10, 115);
    ticks(400);
    /* Top's output was told to be far below to make up for bottom's share; in float and fixed point alike it comes back. */
    TEST_ASSERT_TRUE(fabs(D(bench.s.loop[BOTTOM].v)) < 3);
    TEST_ASSERT_TRUE(D(bench.s.mv[REFLUX].commanded) < 100);
}

static void the_outer_loop_of_a_cascade_hears_of_a_limit_behind_it(void)
{
    bench_start_with(crossed);
    bench_cascade();
    put("mv2.max", "1.2");
    apply();
    both_auto();
    mode(OUTER, LOOP_AUTO);
    mode(BOTTOM, LOOP_CASCADE);
    ticks(3);
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    reading(T5, 60); /* it asks for more and more */
    ticks(100);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, sent(HEAT));
    double asked = setpoint_of(BOTTOM);
    ticks(200);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, asked, setpoint_of(BOTTOM));
    TEST_ASSERT_EQUAL(INTEGRAL_CLAMP_UP, bench.s.loop[OUTER].clamp);
}

/* ---- a controller of both loops ahead of it ---- */

static void served_and_crossed(void)
{
    put_block(1, "duet", "top bottom", "", "");
    crossed();
}

static void a_block_that_serves_its_loops_drives_through_it(void)
{
    crossed_auto(served_and_crossed);
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    setpoint(BOTTOM, 116);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.5 + 0.1 * 0.01, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.5 + 0.08 * 0.001, sent(REFLUX));
    put("mv2.max", "1.1");
    apply();
    setpoint(BOTTOM, 150);
    ticks(50);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(HEAT));
    struct duet *d = supervisor_block(&bench.s, BLOCK_NUMBERED + 1);
    TEST_ASSERT_TRUE(D(d->applied[1]) < 0.6); /* of its own output, not of the MV */
    setpoint(BOTTOM, 110);
    tick();
    TEST_ASSERT_TRUE(sent(HEAT) < 0.55);
    reading(T10, 110);
    ticks(80);
    double heat = sent(HEAT), reflux = sent(REFLUX);
    request(REQUEST_BLOCK, PLAN_NONE, 1, 0,
            0); /* the loops' own take over, compensated as before */
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
}

/* ---- plans ---- */

static void a_plan_that_changes_nothing_of_it_does_not_touch_it(void)
{
    double with[2][2];
    for (int k = 0; k < 2; k++) {
        crossed_auto(crossed);
        reading(T10, 113);
        ticks(5);
        unsigned follows = cross_at(0)->follows;
        if (k)
            set_and_apply("alarm1.limit", "150");
        ticks(5);
        TEST_ASSERT_EQUAL_UINT(follows, cross_at(0)->follows);
        with[k][0] = sent(REFLUX);
        with[k][1] = sent(HEAT);
    }
    TEST_ASSERT_TRUE(with[0][0] == with[1][0] && with[0][1] == with[1][1]);
}

static void a_third_loop(void)
{
    put_all((const char *const[]){"mv3.unit", "kW", "loop3.name", "third", "loop3.pv", "T5",
                                  "loop3.out", "spare", "loop3.gain", "1", NULL});
}

static void two_of_them(void)
{
    a_third_loop();
    put_block(0, "cross", "top", "", "");
    put_block(1, "cross", "bottom third", "", "");
}

static void other_settings_move_no_output_and_touch_no_other_compensator(void)
{
    bench_start_with(two_of_them);
    mode(THIRD, LOOP_AUTO);
    both_auto();
    reading(T10, 114.3);
    reading(T5, 99);
    ticks(20);
    unsigned follows[2] = {cross_at(0)->follows, cross_at(1)->follows};
    double heat = sent(HEAT), reflux = sent(REFLUX), spare = sent(SPARE);
    SET_CROSS(1, k12, 0.3f);
    SET_CROSS(1, k21, -0.4f);
    apply();
    tick();
    TEST_ASSERT_EQUAL_UINT(follows[0], cross_at(0)->follows);
    TEST_ASSERT_EQUAL_UINT(follows[1] + 1, cross_at(1)->follows);
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, spare, sent(SPARE));
    TEST_ASSERT_TRUE(cross_at(1)->steps > 20); /* it is the same one */
}

static void other_members_or_none_move_no_output(void)
{
    bench_start_with(two_of_them);
    mode(THIRD, LOOP_AUTO);
    both_auto();
    reading(T10, 114.3);
    ticks(20);
    static const char *const loops[][2] = {
        {"top", "third"}, {"top,third", "bottom"}, {"bottom", "third,top"}, {"top,bottom", NULL}};
    for (unsigned k = 0; k < 4; k++) {
        double heat = sent(HEAT), reflux = sent(REFLUX), spare = sent(SPARE);
        TEST_ASSERT_EQUAL(
            ERR_OK, block_list_set(bench.config.block[0].loops, BLOCK_LOOPS_SIZE, loops[k][0]));
        if (loops[k][1])
            TEST_ASSERT_EQUAL(
                ERR_OK, block_list_set(bench.config.block[1].loops, BLOCK_LOOPS_SIZE, loops[k][1]));
        else
            put_block(1, "", "", "", "");
        apply();
        tick();
        TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
        TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
        TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, spare, sent(SPARE));
        TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
        ticks(5);
    }
}

static void beside_the_static_decoupler_each_has_loops_of_its_own(void)
{
    bench_start_with(a_third_loop);
    put_all((const char *const[]){"loop1.decouple", "on", "loop3.decouple", "on", "decouple1.d3",
                                  "0.9", NULL});
    put_block(0, "cross", "bottom", "", "");
    apply();
    mode(THIRD, LOOP_AUTO);
    both_auto();
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    unsigned follows = cross_at(0)->follows;
    mode(THIRD, LOOP_MANUAL);
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(follows, cross_at(0)->follows);
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    mode(BOTTOM, LOOP_MANUAL);
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(follows + 1, cross_at(0)->follows);
    ASSERT_NO_BUMP(0.5, sent(HEAT));
}

/* ---- giving up ---- */

static void giving_up(void (*how)(void), const char *reason)
{
    double reflux = sent(REFLUX), heat = sent(HEAT);
    bench_forget_events();
    how();
    tick();
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_GAVE_UP, reason));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(2 * OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(2 * OWN_MOVE, reflux, sent(REFLUX));
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
    stage_fails.fault = STAGE_WELL;
    reading(FEED, 5);
    ticks(2);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_GAVE_UP, NULL));
    /* From now on each loop moves its own MV alone. */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, D(bench.s.loop[TOP].v), sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, D(bench.s.loop[BOTTOM].v), sent(HEAT));
    reflux = sent(REFLUX);
    reading(T10, 113);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
    TEST_ASSERT_TRUE(sent(HEAT) > heat + 0.01);
    /* And back. */
    reflux = sent(REFLUX);
    heat = sent(HEAT);
    request(REQUEST_BLOCK, PLAN_NONE, 0, 1, 0);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_ON, "cross"));
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
    TEST_ASSERT_EQUAL_UINT(1, cross_at(0)->steps);
}

static void well_under_way(void (*more)(void))
{
    crossed_auto(more);
    reading(T10, 114.3);
    ticks(50);
    reading(T10, 115);
    ticks(60);
}

static enum stage_fault fails_with;

static void in_the_step(void)
{
    stage_fails.fault = fails_with;
    stage_fails.call = CALL_STEP;
}
static void in_back_calculation(void)
{
    stage_fails.fault = fails_with;
    stage_fails.call = CALL_BACK;
}
static void in_transfer(void)
{
    stage_fails.fault = fails_with;
    stage_fails.call = CALL_FOLLOW;
    SET_CROSS(0, k12, 0.7f);
    apply();
}
static void by_a_bad_input(void)
{
    bad_reading(FEED, QUALITY_BAD, 0);
    ticks(2); /* held for 2 s, and then in the tick that follows */
}
static void by_hand(void)
{
    request(REQUEST_BLOCK, PLAN_NONE, 0, 0, 0);
}

static void when_it_gives_up_its_members_pass_without_a_bump(void)
{
    void (*const how[])(void) = {in_the_step, in_back_calculation, in_transfer, by_hand};
    const char *const reason[] = {"test", "test", "test", "asked"};
    fails_with = STAGE_GIVES_UP;
    for (unsigned k = 0; k < 4; k++) {
        well_under_way(crossed);
        giving_up(how[k], reason[k]);
    }
}

static void with_input(void)
{
    crossed();
    strcpy(bench.config.block[0].inputs, "feed");
}

static void when_an_input_is_bad_too(void)
{
    well_under_way(with_input);
    giving_up(by_a_bad_input, "feed");
}

static void what_is_no_number_is_given_up(void)
{
#ifndef REFLUX_FIXED_POINT
    void (*const how[])(void) = {in_the_step, in_back_calculation, in_transfer};
    fails_with = STAGE_NO_NUMBER;
    for (unsigned k = 0; k < 3; k++) {
        well_under_way(crossed);
        giving_up(how[k], "not_a_number");
    }
#endif
}

static void twice_of_feed(void)
{
    put("meas3.hold", "2");
    put_block(0, "twice", "top", "feed", "");
}

static void or_its_loops_go_to_manual_where_its_kind_says_so(void)
{
    bench_start_with(twice_of_feed);
    both_auto();
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.25, D(bench.s.loop[TOP].v));
    reading(T1, 86); /* direct: 0.02 more, twice */
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, 0.5 + 2 * 0.02, sent(REFLUX));
    bad_reading(FEED, QUALITY_BAD, 0);
    ticks(4);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[TOP].mode);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_BLOCK_GAVE_UP, NULL));
}

/* ---- one behind the other ---- */

static void chained(void)
{
    crossed();
    put_block(2, "twice", "bottom", "", "");
}

static void two_in_a_row_work_in_their_order_and_back(void)
{
    crossed_auto(chained);
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    /* heat = 2 (v2 + ...): at rest v2 + 0.6 v1 = 0.25, v1 + 0.8 v2 = 0.5. */
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, (0.25 - 0.6 * 0.5) / (1 - 0.48), D(bench.s.loop[BOTTOM].v));
    reading(T10, 114);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, 0.5 + 2 * 0.015, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, 0.5 + 0.08 * 0.015, sent(REFLUX));
    put("mv2.max", "1.1");
    apply();
    reading(T10, 100);
    ticks(400);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(HEAT));
    reading(T10, 117);
    ticks(3);
    TEST_ASSERT_TRUE(sent(HEAT) < 0.54);
}

static void the_first_of_a_row_changes_and_the_second_is_not_touched(void)
{
    crossed_auto(chained);
    reading(T10, 114.3);
    ticks(20);
    double heat = sent(HEAT), reflux = sent(REFLUX);
    SET_CROSS(0, k21, 0.2f);
    apply();
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(2 * OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
    heat = sent(HEAT);
    reflux = sent(REFLUX);
    by_hand(); /* it passes, the second goes on */
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(2 * OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2 * D(bench.s.loop[BOTTOM].v), sent(HEAT));
}

static void two_crossed(void)
{
    crossed();
    put_block(1, "cross", "bottom top", "", "");
}

static void a_change_of_the_first_alone_leaves_the_second_as_it_is(void)
{
    crossed_auto(two_crossed);
    reading(T10, 114.3);
    ticks(20);
    unsigned follows[2] = {cross_at(0)->follows, cross_at(1)->follows};
    double heat = sent(HEAT), reflux = sent(REFLUX);
    SET_CROSS(0, k21, 0.3f);
    apply();
    tick();
    TEST_ASSERT_EQUAL_UINT(follows[0] + 1, cross_at(0)->follows);
    TEST_ASSERT_EQUAL_UINT(follows[1], cross_at(1)->follows);
    /* The lags of the second go on. */
    TEST_ASSERT_DOUBLE_WITHIN(3 * OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(3 * OWN_MOVE, reflux, sent(REFLUX));
    heat = sent(HEAT);
    reflux = sent(REFLUX);
    SET_CROSS(1, k12, 0.3f); /* what it is given has another meaning now, for the first too */
    apply();
    tick();
    TEST_ASSERT_EQUAL_UINT(follows[0] + 2, cross_at(0)->follows);
    TEST_ASSERT_EQUAL_UINT(follows[1] + 1, cross_at(1)->follows);
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
}

/* ---- what a plan refuses ---- */

static void refused(const char *field, const char *subject, const char *wanted)
{
    struct config_fault fault;
    struct plan *next = &bench.plan[1 - bench.current];
    TEST_ASSERT_NOT_EQUAL(ERR_OK, plan_build(next, &bench.config, 1.0f, &fault));
    TEST_ASSERT_EQUAL_STRING("block", fault.group);
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_EQUAL_STRING(subject, fault.subject);
    TEST_ASSERT_EQUAL_STRING(wanted, fault.wanted);
}

static void plans_that_cannot_be_are_refused_in_words(void)
{
    bench_start_with(crossed);
    bench_cascade();
    strcpy(bench.config.block[0].loops, "top top");
    refused("loops", "top", "is named twice");
    strcpy(bench.config.block[0].loops, "top outer");
    refused("loops", "outer", "must drive a manipulated variable itself");
    strcpy(bench.config.block[0].loops, "top bottom outer");
    refused("loops", "outer", "is one more than this kind serves");
    strcpy(bench.config.block[0].loops, "");
    refused("loops", "cross", "must name the loops it serves");
    strcpy(bench.config.block[0].loops, "top bottom");
    put("loop2.decouple", "on");
    refused("loops", "bottom", "takes part in the static decoupler; set decouple off");
    put("loop2.decouple", "off");
    put("loop2.algorithm", "two_position");
    put("loop2.band", "1");
    refused("loops", "bottom", "is not for two_position");
    put("loop2.algorithm", "positional");
    SET_CROSS(0, k12, 2);
    SET_CROSS(0, k21, 0.5f);
    refused("k12", "cross", "needs shares whose product is not 1");
}

static void what_looks_at_its_own_mv_is_refused(void)
{
    bench_start_with(crossed);
    strcpy(bench.config.block[0].inputs, "heat");
    refused("inputs", "heat", "is moved by what looks at it");
    a_third_loop();
    strcpy(bench.config.block[0].inputs, "spare");
    apply();
    put_all((const char *const[]){"ff1.from", "heat", "ff1.to", "spare", "ff1.gain", "1", NULL});
    refused("inputs", "spare", "is moved by what looks at it");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_controller_moves_both_outputs_each_in_its_time);
    RUN_TEST(it_runs_in_every_tick_whatever_the_divisors_of_its_loops);
    RUN_TEST(a_ratio_to_another_mv);
    RUN_TEST(its_work_is_done_as_that_of_other_blocks);
    RUN_TEST(switched_on_again_in_the_midst_of_its_work_it_begins_anew_only_after_that);
    RUN_TEST(switched_off_while_it_waits_to_come_on_it_stays_off);
    RUN_TEST(it_may_ask_for_a_test_signal_of_which_the_way_back_takes_no_notice);
    RUN_TEST(a_member_that_leaves_and_comes_back_moves_nobodys_output);
    RUN_TEST(a_member_that_was_away_between_two_ticks_begins_anew);
    RUN_TEST(an_interlock_on_one_mv_leaves_the_other_alone);
    RUN_TEST(after_the_safe_state_it_begins_again_without_a_bump);
    RUN_TEST(nothing_limited_is_nothing_told);
    RUN_TEST(a_limit_on_one_mv_winds_nobody_up);
    RUN_TEST(what_took_effect_is_in_the_compensators_state);
    RUN_TEST(what_is_beyond_all_numbers_is_told_as_a_whole);
    RUN_TEST(the_outer_loop_of_a_cascade_hears_of_a_limit_behind_it);
    RUN_TEST(a_block_that_serves_its_loops_drives_through_it);
    RUN_TEST(a_plan_that_changes_nothing_of_it_does_not_touch_it);
    RUN_TEST(other_settings_move_no_output_and_touch_no_other_compensator);
    RUN_TEST(other_members_or_none_move_no_output);
    RUN_TEST(beside_the_static_decoupler_each_has_loops_of_its_own);
    RUN_TEST(when_it_gives_up_its_members_pass_without_a_bump);
    RUN_TEST(when_an_input_is_bad_too);
    RUN_TEST(what_is_no_number_is_given_up);
    RUN_TEST(or_its_loops_go_to_manual_where_its_kind_says_so);
    RUN_TEST(two_in_a_row_work_in_their_order_and_back);
    RUN_TEST(the_first_of_a_row_changes_and_the_second_is_not_touched);
    RUN_TEST(a_change_of_the_first_alone_leaves_the_second_as_it_is);
    RUN_TEST(plans_that_cannot_be_are_refused_in_words);
    RUN_TEST(what_looks_at_its_own_mv_is_refused);
    return UNITY_END();
}
