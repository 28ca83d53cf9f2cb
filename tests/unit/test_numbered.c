/* Blocks with a number (blockN): an estimator whose points are measurements, and a controller of two loops in place of their
 * own. The kinds are of this test alone; what the tick does with them is what every family relies on. */
#include "block/block.h"
#include "exchange/block_settings.h"
#include "exchange/block_work.h"
#include "kinds/pid/pid.h"
#include "numbered_kinds.h"
#include "plan/plan_build.h"
#include "put_block.h"
#include "supervisor_bench.h"

const struct block_kind *const block_kinds[] = {&pid_kind, &mean_kind, &both_kind};
const uint8_t block_kind_count = 3;

static void put_float(unsigned n, unsigned offset, float x)
{
    struct block_config *b = &bench.config.block[n];
    memcpy(bench.config.pool + b->offset + offset, &x, sizeof x);
}

void setUp(void)
{
    both_gives_up = false;
    both_adds = 0.0f;
    both_limited = INTEGRAL_FREE;
    mean_more = 0;
    mean_follows = 0;
}
void tearDown(void) {}

/* ---- estimates ---- */

enum { MEAN = 4, APART = 5, THIRD = 2 };

/* The feed's loop is controlled by the mean of two temperatures. */
static void estimates(void)
{
    put_all((const char *const[]){
        "meas5.name", "mean",  "meas5.unit", "degC",  "meas5.lo", "60",   "meas5.hi",  "160",
        "meas6.name", "apart", "meas6.unit", "degC",  "meas6.lo", "-100", "meas6.hi",  "100",
        "meas5.hold", "10",    "loop3.name", "third", "loop3.pv", "mean", "loop3.out", "spare",
        "loop3.gain", "1",     "loop3.ti",   "60",    NULL});
    put_block(0, "mean", "", "T1 T10", "mean apart");
}

static double value_of(unsigned i)
{
    const struct measurement_config *m = &bench.config.measurement[i];
    return (double)span_to_eu(bench.s.measurement[i].value, m->lo, m->hi);
}

static void an_estimate_is_measured_in_the_same_tick_and_is_the_pv_of_a_loop(void)
{
    bench_start_with(estimates);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 100, value_of(MEAN));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -40,
                              value_of(APART)); /* fractions of spans of 100, on one of 200 */
    reading(T1, 95);
    validate();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 105, value_of(MEAN));
    mode(THIRD, LOOP_AUTO);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[THIRD].mode);
    double before = sent(SPARE);
    ticks(2);
    setpoint(THIRD, 120);
    ticks(5);
    TEST_ASSERT_TRUE(sent(SPARE) > before + 0.1);
}

static void a_setting_of_its_record_holds_without_a_new_start(void)
{
    bench_start_with(estimates);
    struct mean *m = supervisor_block(&bench.s, BLOCK_NUMBERED);
    uint32_t counted = m->counted = 3;
    put_float(0, 0, 1);
    apply();
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 85, value_of(MEAN));
    m = supervisor_block(&bench.s, BLOCK_NUMBERED);
    TEST_ASSERT_EQUAL_UINT32(counted, m->counted);
    strcpy(bench.config.block[0].inputs, "T10 T1");
    apply(); /* another block, as far as states go */
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 115, value_of(MEAN));
    m = supervisor_block(&bench.s, BLOCK_NUMBERED);
    TEST_ASSERT_EQUAL_UINT32(0, m->counted);
}

static void settings_that_need_another_size_begin_without_a_past(void)
{
    bench_start_with(estimates);
    put_float(0, 0, 0.75f);
    apply();
    tick();
    TEST_ASSERT_TRUE(mean_retuned);
    put_float(0, 0, 1);
    mean_more = 64;
    apply(); /* the arena keeps no state of another size */
    tick();
    TEST_ASSERT_FALSE(mean_retuned);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 85, value_of(MEAN));
}

/* The arena has places of 8 bytes: a state of 20 bytes and one of 24 have the same place. */
static void so_do_those_that_need_a_little_more_in_the_same_place(void)
{
    TEST_ASSERT_EQUAL(ARENA_GRAINS(sizeof(struct mean)), ARENA_GRAINS(sizeof(struct mean) + 4));
    bench_start_with(estimates);
    put_float(0, 0, 0.75f);
    apply();
    tick();
    TEST_ASSERT_TRUE(mean_retuned);
    put_float(0, 0, 1);
    mean_more = 4;
    apply();
    tick();
    TEST_ASSERT_FALSE(mean_retuned);
}

static void is_of(struct block_signal signal, double lo, double hi, bool is_mv)
{
    TEST_ASSERT_EQUAL_DOUBLE(lo, (double)signal.lo);
    TEST_ASSERT_EQUAL_DOUBLE(hi, (double)signal.hi);
    TEST_ASSERT_EQUAL(is_mv, signal.is_mv);
}

static void it_is_told_what_fractions_are_of(void)
{
    bench_start_with(estimates);
    is_of(mean_setup.input[1], 60, 160, false);
    is_of(mean_setup.point[1], -100, 100, false);
    strcpy(bench.config.block[0].inputs, "T1 heat");
    apply();
    is_of(mean_setup.input[0], 60, 160, false);
    is_of(mean_setup.input[1], 0, 2, true);
    put_float(0, 0, 0.75f);
    apply();
    TEST_ASSERT_TRUE(mean_retuned);
    put("meas6.hi", "200"); /* what it remembers in fractions means something else now */
    apply();
    tick();
    TEST_ASSERT_FALSE(mean_retuned);
    is_of(mean_setup.point[1], -100, 200, false);
}

static void an_estimator_begins_anew_when_the_plant_was_away(void)
{
    bench_start_with(estimates);
    TEST_ASSERT_EQUAL_UINT(1, mean_follows);
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(1, mean_follows);
    supervisor_go_safe(&bench.s, "link");
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(2, mean_follows);
}

static void estimates_by_a_late_one(void)
{
    estimates();
    put_all((const char *const[]){"meas7.name", "late", "meas7.unit", "degC", "meas7.lo", "60",
                                  "meas7.hi", "160", "meas7.hold", "100", NULL});
    put_block(0, "mean", "", "T1 late", "mean apart");
}

static void until_its_inputs_have_come_there_is_no_estimate(void)
{
    bench_start_with(estimates_by_a_late_one);
    /* The bench binds all that have a name; the plant does not have this one yet. */
    bench.s.measurement[MEAN].bound = bench.s.measurement[6].bound = false;
    tick();
    TEST_ASSERT_FALSE(bench.s.measurement[MEAN].bound);
    supervisor_bind_measurement(&bench.s, 6);
    reading(6, 115);
    tick();
    TEST_ASSERT_TRUE(bench.s.measurement[MEAN].bound);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 100, value_of(MEAN));
}

static void an_estimate_without_its_input_is_held_and_then_its_loop_goes_to_manual(void)
{
    bench_start_with(estimates);
    mode(THIRD, LOOP_AUTO);
    tick();
    bad_reading(T1, QUALITY_BAD, 0);
    ticks(8); /* T1 itself is held: but that tells an estimator nothing */
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[THIRD].mode);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, bench.s.measurement[MEAN].quality);
    ticks(4);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[THIRD].mode);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_MEASUREMENT_BAD, "mean"));
    reading(T1, 85);
    tick();
    TEST_ASSERT_EQUAL(QUALITY_GOOD, bench.s.measurement[MEAN].quality);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_MEASUREMENT_GOOD, "mean"));
}

static void an_estimate_is_interlocked_and_alarmed_like_any_measurement(void)
{
    bench_start_with(estimates);
    put_all((const char *const[]){"lock1.meas", "mean", "lock1.mv", "heat", "lock1.limit", "110",
                                  "alarm1.on", "mean", "alarm1.limit", "108", NULL});
    apply();
    reading(T1, 112);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, sent(HEAT));
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_INTERLOCK_ON, "heat"));
    TEST_ASSERT_TRUE(bench.s.alarm[0].listed);
}

static void work_is_done_between_ticks_and_its_result_comes_when_it_was_declared(void)
{
    bench_start_with(estimates);
    struct mean *m = supervisor_block(&bench.s, BLOCK_NUMBERED);
    struct jobs jobs = {0};
    TEST_ASSERT_EQUAL(ERR_OK, jobs_add(&jobs, &bench.s.work[0]));
    TEST_ASSERT_TRUE(block_work_is_asked(&bench.s));
    for (unsigned n = 0; n < 20 && m->counted < 10; n++)
        (void)jobs_work(&jobs);
    TEST_ASSERT_EQUAL_UINT32(10, m->counted);
    /* It was asked for in the first of four ticks. */
    TEST_ASSERT_EQUAL_UINT32(0, m->results);
    tick();
    TEST_ASSERT_EQUAL_UINT32(0, m->results);
    tick();
    TEST_ASSERT_EQUAL_UINT32(1, m->results);
    ticks(5);
    TEST_ASSERT_EQUAL_UINT32(1, m->results);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_JOB_LATE, NULL));
}

static void work_that_is_late_says_so_and_its_result_is_taken_when_it_is_there(void)
{
    bench_start_with(estimates);
    struct mean *m = supervisor_block(&bench.s, BLOCK_NUMBERED);
    ticks(5);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_JOB_LATE, "block"));
    struct jobs jobs = {0};
    TEST_ASSERT_EQUAL(ERR_OK, jobs_add(&jobs, &bench.s.work[0]));
    while (jobs_work(&jobs))
        ;
    TEST_ASSERT_EQUAL_UINT32(0, m->results);
    tick();
    TEST_ASSERT_EQUAL_UINT32(1, m->results);
}

/* A plan may take the block away, or give it another tick, while its work is wanted. */
static void work_of_a_block_that_is_gone_is_not_done(void)
{
    struct jobs jobs = {0};
    bench_start_with(estimates);
    TEST_ASSERT_EQUAL(ERR_OK, jobs_add(&jobs, &bench.s.work[0]));
    TEST_ASSERT_TRUE(jobs_work(&jobs));
    put("loop3.pv", "feed");
    put_block(0, "", "", "", "");
    apply();
    TEST_ASSERT_FALSE(block_work_is_asked(&bench.s));
    TEST_ASSERT_FALSE(jobs_work(&jobs));
    ticks(10);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_JOB_LATE, NULL));
    /* Nor where this build does not know the kind any more: a set that another firmware stored. */
    bench_start_with(estimates);
    strcpy(bench.config.block[0].kind, "gmv");
    apply();
    TEST_ASSERT_FALSE(block_work_is_asked(&bench.s));
    TEST_ASSERT_FALSE(jobs_work(&jobs));
}

static void another_tick_is_another_interval(void)
{
    struct config_fault fault;
    bench_start_with(estimates);
    struct mean *m = supervisor_block(&bench.s, BLOCK_NUMBERED);
    TEST_ASSERT_EQUAL_FLOAT(1, m->interval_s);
    struct plan *plan = &bench.plan[bench.current];
    TEST_ASSERT_EQUAL(ERR_OK, plan_set_tick(plan, 2.0f, &fault));
    supervisor_take_plan(&bench.s, plan);
    m = supervisor_block(&bench.s, BLOCK_NUMBERED);
    TEST_ASSERT_EQUAL_FLOAT(2, m->interval_s);
    TEST_ASSERT_FALSE(m->begun); /* and a new beginning */
    TEST_ASSERT_FALSE(block_work_is_asked(&bench.s));
}

static void work_given_up_in_the_midst_of_a_piece_is_wanted_until_that_is_over(void)
{
    bench_start_with(estimates);
    bench.s.work[0].working = true; /* the tick has interrupted it */
    job_give_up(&bench.s.work[0]);
    tick();
    TEST_ASSERT_TRUE(mean_waits);
    bench.s.work[0].working = false;
    tick();
    TEST_ASSERT_FALSE(mean_waits);
}

/* ---- a block that serves ---- */

static void served(void)
{
    put("meas3.hold", "2");
    put_block(1, "both", "top bottom", "feed", "");
}

static void both_auto(void)
{
    bench_start_with(served);
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
}

static void it_takes_over_without_a_bump_and_moves_both_outputs(void)
{
    both_auto();
    double top = sent(REFLUX), bottom = sent(HEAT);
    ticks(2);
    ASSERT_NO_BUMP(top, sent(REFLUX));
    ASSERT_NO_BUMP(bottom, sent(HEAT));
    TEST_ASSERT_EQUAL_UINT(2, both_state->steps);
    setpoint(TOP, 95);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, top + 0.1 * 0.1, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, bottom + 0.1 * 0.25 * 0.1, sent(HEAT));
}

static void what_took_effect_is_told_to_it(void)
{
    both_auto();
    set_and_apply("mv1.max", "5.2");
    setpoint(TOP, 130);
    ticks(20);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.52, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.52, D(both_state->applied[0]));
    setpoint(TOP, 80); /* it has not wound up */
    tick();
    TEST_ASSERT_TRUE(sent(REFLUX) < 0.52);
}

static void giving_up(void (*how)(void), const char *reason)
{
    both_auto();
    setpoint(TOP, 95);
    setpoint(BOTTOM, 110);
    ticks(10);
    double top = sent(REFLUX), bottom = sent(HEAT);
    reading(T1, 95); /* no error left: what comes now is the bump alone */
    reading(T10, 110);
    tick();
    top = sent(REFLUX);
    bottom = sent(HEAT);
    how();
    tick();
    unsigned steps = both_state->steps;
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_GAVE_UP, reason));
    ASSERT_NO_BUMP(top, sent(REFLUX));
    ASSERT_NO_BUMP(bottom, sent(HEAT));
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
    setpoint(TOP, 90);
    ticks(5);
    TEST_ASSERT_EQUAL_UINT(steps, both_state->steps);
    TEST_ASSERT_TRUE(sent(REFLUX) > top); /* direct acting: its own controller is at work */
    top = sent(REFLUX);
    setpoint(TOP, 95);
    /* And back. */
    both_gives_up = false;
    reading(FEED, 5);
    ticks(2);
    top = sent(REFLUX);
    request(REQUEST_BLOCK, PLAN_NONE, 1, 1, 0);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_ON, "both"));
    tick();
    ASSERT_NO_BUMP(top, sent(REFLUX));
    TEST_ASSERT_EQUAL_UINT(steps + 1, both_state->steps);
}

/* The gains of the loops answer what the readings move in that tick. */
static void in_the_tick_in_which_it_gives_up_the_own_controllers_act(void)
{
    both_auto();
    ticks(5);
    double top = sent(REFLUX), bottom = sent(HEAT);
    reading(T1, 90);
    reading(T10, 110);
    both_gives_up = true;
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, top + 2 * 0.05, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, bottom + 1.5 * 0.05, sent(HEAT));
}

static void by_itself(void)
{
    both_gives_up = true;
}
static void by_a_bad_input(void)
{
    bad_reading(FEED, QUALITY_BAD, 0);
    ticks(3); /* held for 2 s */
}
static void by_hand(void)
{
    request(REQUEST_BLOCK, PLAN_NONE, 1, 0, 0);
}

static void when_it_gives_up_the_own_controllers_take_over_without_a_bump(void)
{
    giving_up(by_itself, "test");
}
static void when_a_further_input_is_bad_too(void)
{
    giving_up(by_a_bad_input, "feed");
}
static void when_it_is_switched_off_too(void)
{
    giving_up(by_hand, "asked");
}

/* It runs away, and in floating point would go on to infinity. */
static void a_controller_that_gives_a_hundred_spans_is_given_up(void)
{
    static const float far[] = {101, -101};
    for (unsigned i = 0; i < 2; i++) {
        both_auto();
        ticks(3);
        double top = sent(REFLUX);
        both_adds = far[i];
        tick();
        both_adds = 0.0f;
        TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_GAVE_UP, "not_a_number"));
        ASSERT_NO_BUMP(top, sent(REFLUX));
    }
}

/* In fixed point there is no such thing. */
static void what_is_no_number_reaches_nobody(void)
{
#ifndef REFLUX_FIXED_POINT
    static const float nothing[] = {NAN, INFINITY, -INFINITY};
    for (unsigned i = 0; i < 3; i++) {
        both_auto();
        ticks(3);
        double top = sent(REFLUX), bottom = sent(HEAT);
        both_adds = nothing[i];
        tick();
        TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_GAVE_UP, "not_a_number"));
        ASSERT_NO_BUMP(top, sent(REFLUX));
        ASSERT_NO_BUMP(bottom, sent(HEAT));
        ticks(5);
        ASSERT_NO_BUMP(top, sent(REFLUX));
        TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
        both_adds = 0.0f;
    }
    /* Its output for a loop in manual is no reason. */
    both_auto();
    mode(TOP, LOOP_MANUAL);
    both_adds = NAN;
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_BLOCK_GAVE_UP, NULL));
#endif
}

static void a_member_in_manual_is_not_moved_and_comes_back_without_a_bump(void)
{
    both_auto();
    ticks(3);
    mode(BOTTOM, LOOP_MANUAL);
    out(BOTTOM, 0.4);
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.2, sent(HEAT));
    setpoint(TOP, 95);
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.2, sent(HEAT));
    reading(T1, 95);
    mode(BOTTOM, LOOP_AUTO);
    tick();
    ASSERT_NO_BUMP(0.2, sent(HEAT));
}

static void what_an_interlock_makes_of_an_output_is_told_in_the_same_tick(void)
{
    both_auto();
    put_all(
        (const char *const[]){"lock1.meas", "T1", "lock1.mv", "heat", "lock1.limit", "110", NULL});
    apply();
    ticks(3);
    TEST_ASSERT_TRUE(D(both_state->applied[1]) > 0.1);
    unsigned backs = both_state->backs;
    reading(T1, 112);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, sent(HEAT));
    TEST_ASSERT_EQUAL_UINT(backs + 1, both_state->backs);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, D(both_state->applied[1]));
}

static void another_divisor_of_its_loops_is_another_interval(void)
{
    both_auto();
    TEST_ASSERT_EQUAL_FLOAT(1, both_interval_s);
    double top = sent(REFLUX);
    put("loop1.divisor", "3");
    put("loop2.divisor", "3");
    apply();
    tick();
    TEST_ASSERT_EQUAL_FLOAT(3, both_interval_s);
    ASSERT_NO_BUMP(top, sent(REFLUX));
}

/* With a turn every third tick it is told in the third, and of what is in effect then. */
static void what_took_effect_is_told_to_it_before_its_next_turn(void)
{
    bench_start_with(served);
    put_all((const char *const[]){"loop1.divisor", "3", "loop2.divisor", "3", "lock1.meas", "T5",
                                  "lock1.mv", "heat", "lock1.limit", "120", "lock1.value", "0.2",
                                  NULL});
    apply();
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    ticks(6);
    unsigned steps = both_state->steps;
    for (unsigned n = 0; n < 3 && both_state->steps == steps; n++)
        tick();
    TEST_ASSERT_EQUAL_UINT(steps + 1, both_state->steps);
    unsigned backs = both_state->backs;
    tick();
    TEST_ASSERT_EQUAL_UINT(backs, both_state->backs);
    reading(T5, 130);
    tick();
    TEST_ASSERT_EQUAL_UINT(steps + 1, both_state->steps);
    TEST_ASSERT_EQUAL_UINT(backs + 1, both_state->backs);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, D(both_state->applied[1]));
}

/* Its turns come sooner from now on, before it was told of the last. */
static void an_output_of_which_it_was_not_told_counts_as_given(void)
{
    bench_start_with(served);
    put_all((const char *const[]){"loop1.divisor", "3", "loop2.divisor", "3", NULL});
    apply();
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    ticks(6);
    unsigned steps = both_state->steps;
    for (unsigned n = 0; n < 3 && both_state->steps == steps; n++)
        tick();
    unsigned backs = both_state->backs;
    put_all((const char *const[]){"loop1.divisor", "1", "loop2.divisor", "1", NULL});
    apply();
    tick();
    TEST_ASSERT_EQUAL_UINT(steps + 2, both_state->steps);
    TEST_ASSERT_EQUAL_UINT(backs + 2, both_state->backs); /* before that turn, and after it */
}

static void an_unrelated_plan_does_not_disturb_it(void)
{
    double with[2];
    for (int k = 0; k < 2; k++) {
        both_auto();
        setpoint(TOP, 95);
        ticks(5);
        if (k)
            set_and_apply("alarm1.limit", "150");
        ticks(5);
        with[k] = sent(REFLUX);
    }
    TEST_ASSERT_TRUE(with[0] == with[1]);
}

static void a_kind_this_build_lacks_keeps_its_loops_in_manual(void)
{
    bench_start_with(served);
    strcpy(bench.config.block[1].kind, "gmv");
    apply();
    mode(TOP, LOOP_AUTO);
    ticks(2);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[TOP].mode);
}

static void an_unknown_kind_that_serves_nobody_is_no_reason_to_refuse_the_rest(void)
{
    bench_start_with(served);
    strcpy(bench.config.block[2].kind, "ekf");
    strcpy(bench.config.block[2].inputs, "T1");
    apply();
    mode(TOP, LOOP_AUTO);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
}

static void an_interlock_on_one_output_leaves_the_other_to_it_and_ends_without_a_bump(void)
{
    both_auto();
    put_all((const char *const[]){"lock1.meas", "T5", "lock1.mv", "heat", "lock1.limit", "120",
                                  "lock1.value", "0.2", NULL});
    apply();
    setpoint(TOP, 95);
    ticks(3);
    double top = sent(REFLUX);
    reading(T5, 130);
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, sent(HEAT));
    TEST_ASSERT_TRUE(sent(REFLUX) > top);
    reading(T1, 95);
    reading(T5, 100);
    tick();
    ASSERT_NO_BUMP(0.1, sent(HEAT));
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
}

static void a_cascade_drives_the_setpoint_of_a_member(void)
{
    bench_start_with(served);
    bench_cascade();
    apply();
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_CASCADE);
    mode(OUTER, LOOP_AUTO);
    ticks(3);
    double before = setpoint_of(BOTTOM), heat = sent(HEAT);
    setpoint(OUTER, 105);
    tick();
    TEST_ASSERT_TRUE(setpoint_of(BOTTOM) > before + 0.01);
    tick();
    TEST_ASSERT_TRUE(sent(HEAT) > heat);
    by_hand(); /* its own controller is in cascade as well */
    tick();
    TEST_ASSERT_EQUAL(LOOP_CASCADE, bench.s.loop[BOTTOM].mode);
}

/* Loops `upper` and `lower` first or last: both under one block, each driving the setpoint of another loop. */
static void outer_loops_served(bool first)
{
    static const char *const inner[] = {"pv", "T1", "out", "reflux", "pv", "T10", "out", "heat"};
    static const char *const outer[] = {"pv", "T5", "out", "top", "pv", "feed", "out", "bottom"};
    static const char *const names[] = {"top", "bottom", "upper", "lower"};
    for (unsigned i = 0; i < 4; i++) {
        bool is_outer = first ? i < 2 : i >= 2;
        const char *const *pairs = (is_outer ? outer : inner) + (i % 2 ? 4 : 0);
        char name[20];
        snprintf(name, sizeof name, "loop%u.name", i + 1);
        put(name, names[i % 2 + (is_outer ? 2 : 0)]);
        for (unsigned k = 0; k < 4; k += 2) {
            snprintf(name, sizeof name, "loop%u.%s", i + 1, pairs[k]);
            put(name, pairs[k + 1]);
        }
        snprintf(name, sizeof name, "loop%u.gain", i + 1);
        put(name, "1");
        snprintf(name, sizeof name, "loop%u.ti", i + 1);
        put(name, "100");
    }
    put_block(1, "both", "upper lower", "", "");
}

static void outer_loops_first(void)
{
    outer_loops_served(true);
}

static void outer_loops_last(void)
{
    outer_loops_served(false);
}

static void outer_loops_under_a_block_move_setpoints_in_the_same_tick_in_whatever_order(void)
{
    for (unsigned first = 0; first < 2; first++) {
        uint8_t outer[2] = {first ? 0 : 2, first ? 1 : 3},
                inner[2] = {first ? 2 : 0, first ? 3 : 1};
        bench_start_with(first ? outer_loops_first : outer_loops_last);
        for (unsigned k = 0; k < 2; k++) {
            mode(inner[k], LOOP_CASCADE);
            mode(outer[k], LOOP_AUTO);
        }
        ticks(3);
        double before[2] = {setpoint_of(inner[0]), setpoint_of(inner[1])};
        setpoint(outer[0], 105);
        setpoint(outer[1], 6);
        tick();
        TEST_ASSERT_TRUE(setpoint_of(inner[0]) > before[0] + 1e-3);
        TEST_ASSERT_TRUE(setpoint_of(inner[1]) > before[1] + 1e-3);
    }
}

static void the_outer_loop_of_a_cascade_hears_of_a_limit_of_the_block_itself(void)
{
    bench_start_with(served);
    bench_cascade();
    apply();
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_CASCADE);
    mode(OUTER, LOOP_AUTO);
    ticks(3);
    setpoint(OUTER, 105);
    ticks(3);
    double before = setpoint_of(BOTTOM);
    ticks(5);
    TEST_ASSERT_TRUE(setpoint_of(BOTTOM) > before + 1e-4);
    both_limited = INTEGRAL_CLAMP_UP;
    ticks(2);
    before = setpoint_of(BOTTOM);
    ticks(5);
    ASSERT_NO_BUMP(before, setpoint_of(BOTTOM));
    both_limited = INTEGRAL_FREE;
    ticks(5);
    TEST_ASSERT_TRUE(setpoint_of(BOTTOM) > before + 1e-4);
}

/* ---- what a plan refuses ---- */

static void refused(const char *field, const char *subject)
{
    struct config_fault fault;
    struct plan *next = &bench.plan[1 - bench.current];
    TEST_ASSERT_NOT_EQUAL(ERR_OK, plan_build(next, &bench.config, 1.0f, &fault));
    TEST_ASSERT_EQUAL_STRING("block", fault.group);
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_EQUAL_STRING(subject, fault.subject);
}

static void lists_of_names_are_checked(void)
{
    static const char *const wrong[][4] = {
        {"top nobody", "feed", "loops", "nobody"},
        {"top bottom outer", "feed", "loops", "outer"},
        {"top top", "feed", "loops", "top"},
        {"top", "feed", "loops", "both"},
        {"", "feed", "loops", "both"},
        {"top bottom", "nothing", "inputs", "nothing"},
        {"top bottom", "feed T5", "inputs", "T5"},
    };
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        bench_start_with(served);
        bench_cascade();
        put_block(1, "both", wrong[i][0], wrong[i][1], "");
        refused(wrong[i][2], wrong[i][3]);
    }
}

static void members_have_their_turns_together_and_no_decoupler(void)
{
    bench_start_with(served);
    put("loop1.divisor", "2");
    refused("loops", "bottom");
    put("loop2.divisor", "2");
    apply();
    put("loop2.decouple", "on");
    refused("loops", "bottom");
}

static void points_are_checked(void)
{
    static const char *const wrong[][4] = {
        {"T1 T10", "mean nothing", "points", "nothing"},
        {"T1 T10", "mean mean", "points", "mean"},
        {"T1 T10", "mean", "inputs", "mean"},
        {"mean T1", "mean apart", "inputs", "mean"},
    };
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        bench_start_with(estimates);
        put_block(0, "mean", "", wrong[i][0], wrong[i][1]);
        refused(wrong[i][2], wrong[i][3]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_estimate_is_measured_in_the_same_tick_and_is_the_pv_of_a_loop);
    RUN_TEST(a_setting_of_its_record_holds_without_a_new_start);
    RUN_TEST(settings_that_need_another_size_begin_without_a_past);
    RUN_TEST(so_do_those_that_need_a_little_more_in_the_same_place);
    RUN_TEST(it_is_told_what_fractions_are_of);
    RUN_TEST(an_estimator_begins_anew_when_the_plant_was_away);
    RUN_TEST(until_its_inputs_have_come_there_is_no_estimate);
    RUN_TEST(an_estimate_without_its_input_is_held_and_then_its_loop_goes_to_manual);
    RUN_TEST(an_estimate_is_interlocked_and_alarmed_like_any_measurement);
    RUN_TEST(work_is_done_between_ticks_and_its_result_comes_when_it_was_declared);
    RUN_TEST(work_that_is_late_says_so_and_its_result_is_taken_when_it_is_there);
    RUN_TEST(work_of_a_block_that_is_gone_is_not_done);
    RUN_TEST(another_tick_is_another_interval);
    RUN_TEST(work_given_up_in_the_midst_of_a_piece_is_wanted_until_that_is_over);
    RUN_TEST(it_takes_over_without_a_bump_and_moves_both_outputs);
    RUN_TEST(what_took_effect_is_told_to_it);
    RUN_TEST(when_it_gives_up_the_own_controllers_take_over_without_a_bump);
    RUN_TEST(in_the_tick_in_which_it_gives_up_the_own_controllers_act);
    RUN_TEST(when_a_further_input_is_bad_too);
    RUN_TEST(when_it_is_switched_off_too);
    RUN_TEST(a_controller_that_gives_a_hundred_spans_is_given_up);
    RUN_TEST(what_is_no_number_reaches_nobody);
    RUN_TEST(a_member_in_manual_is_not_moved_and_comes_back_without_a_bump);
    RUN_TEST(what_an_interlock_makes_of_an_output_is_told_in_the_same_tick);
    RUN_TEST(another_divisor_of_its_loops_is_another_interval);
    RUN_TEST(what_took_effect_is_told_to_it_before_its_next_turn);
    RUN_TEST(an_output_of_which_it_was_not_told_counts_as_given);
    RUN_TEST(an_unrelated_plan_does_not_disturb_it);
    RUN_TEST(a_kind_this_build_lacks_keeps_its_loops_in_manual);
    RUN_TEST(an_unknown_kind_that_serves_nobody_is_no_reason_to_refuse_the_rest);
    RUN_TEST(an_interlock_on_one_output_leaves_the_other_to_it_and_ends_without_a_bump);
    RUN_TEST(a_cascade_drives_the_setpoint_of_a_member);
    RUN_TEST(outer_loops_under_a_block_move_setpoints_in_the_same_tick_in_whatever_order);
    RUN_TEST(the_outer_loop_of_a_cascade_hears_of_a_limit_of_the_block_itself);
    RUN_TEST(lists_of_names_are_checked);
    RUN_TEST(members_have_their_turns_together_and_no_decoupler);
    RUN_TEST(points_are_checked);
    return UNITY_END();
}
