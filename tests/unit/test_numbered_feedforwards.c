/* Feedforward elements with a number (blockN): what they add, when they begin and end, and what limits, compensators and
 * interlocks make of it. */
#include "put_block.h"
#include "settings/block_parameters.h"
#include "supervisor_bench.h"

#include "plan/plan_build.h"
#include "stage_kinds.h"

#define OWN_MOVE 1.5e-4

static struct ahead *ahead_at(unsigned n)
{
    return supervisor_block(&bench.s, (uint8_t)(BLOCK_NUMBERED + n));
}

static void set_ahead(unsigned n, unsigned offset, float x)
{
    struct block_config *b = &bench.config.block[n];
    memcpy(bench.config.pool + b->offset + offset, &x, sizeof x);
}

#define SET_AHEAD(n, member, x) set_ahead(n, offsetof(struct ahead_settings, member), x)

/* Feed to both MVs, T5 beside it. */
static void helped(void)
{
    put("meas3.hold", "2");
    put_block(0, "ahead", "", "feed T5", "heat reflux");
}

static void helped_auto(void (*more)(void))
{
    bench_start_with(more);
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
    bench_forget_events();
}

void setUp(void)
{
    stage_fails.fault = STAGE_WELL;
    stage_excites = (struct block_excitation){0};
}
void tearDown(void) {}

/* ---- what it adds ---- */

static void it_begins_at_rest_and_adds_to_each_of_its_mvs(void)
{
    helped_auto(helped);
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.5, D(bench.s.loop[BOTTOM].feedforward));
    reading(FEED, 6); /* 0.1 through a lag of 9 s */
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.5 + 0.01, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.5 - 0.005, sent(REFLUX));
    ticks(100);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.5 + 0.1, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.5 - 0.05, sent(REFLUX));
}

static void its_second_input_counts_too(void)
{
    bench_start_with(helped);
    SET_AHEAD(0, second, 0.5f);
    apply();
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
    reading(T5, 101);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.5 + 0.005, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(0, D(N(0.5)), sent(REFLUX)); /* in manual */
}

static void it_waits_until_all_its_inputs_have_a_value(void)
{
    helped_auto(helped);
    put_all(
        (const char *const[]){"meas5.name", "late", "meas5.unit", "degC", "meas5.hi", "100", NULL});
    strcpy(bench.config.block[0].inputs, "feed late");
    apply();
    reading(FEED, 6);
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(0, ahead_at(0)->steps);
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, 0.5, sent(HEAT)); /* what the other added stays */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, D(bench.s.loop[BOTTOM].feedforward));
    reading(4, 30);
    ticks(2);
    TEST_ASSERT_EQUAL_UINT(2, ahead_at(0)->steps);
    TEST_ASSERT_EQUAL_UINT(1, ahead_at(0)->follows);
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, 0.5, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.6, D(bench.s.loop[BOTTOM].feedforward));
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_BLOCK_GAVE_UP, NULL));
}

static void it_does_not_begin_on_an_input_that_is_bad(void)
{
    bench_start_with(NULL);
    put("meas3.hold", "2");
    apply();
    bad_reading(FEED, QUALITY_BAD, 0);
    ticks(4);
    helped();
    apply();
    ticks(3);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_BLOCK_GAVE_UP, NULL));
    TEST_ASSERT_EQUAL_UINT(0, ahead_at(0)->steps);
    reading(FEED, 5);
    tick();
    TEST_ASSERT_EQUAL_UINT(1, ahead_at(0)->steps);
}

static void without_the_channel_it_adds_nothing_and_begins_anew_when_that_is_back(void)
{
    helped_auto(helped);
    reading(FEED, 6);
    ticks(100);
    double heat = sent(HEAT);
    bench.s.measurement[FEED].bound = false;
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, D(bench.s.loop[BOTTOM].feedforward));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    bench.s.measurement[FEED].bound = true;
    reading(FEED, 9);
    ticks(2);
    TEST_ASSERT_EQUAL_UINT(2, ahead_at(0)->follows);
    TEST_ASSERT_DOUBLE_WITHIN(2 * OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_BLOCK_GAVE_UP, NULL));
}

static void keen(void)
{
    put("meas3.hold", "2");
    put_all(
        (const char *const[]){"meas5.name", "late", "meas5.unit", "degC", "meas5.hi", "100", NULL});
    put_block(0, "keen", "", "feed late", "heat");
}

static void one_that_is_told_of_bad_inputs_waits_for_all_and_goes_on_without(void)
{
    helped_auto(keen);
    TEST_ASSERT_EQUAL_UINT(0, ahead_at(0)->steps);
    reading(4, 30);
    ticks(2);
    TEST_ASSERT_EQUAL_UINT(2, ahead_at(0)->steps);
    bad_reading(FEED, QUALITY_BAD, 0);
    ticks(4);
    TEST_ASSERT_EQUAL_UINT(6, ahead_at(0)->steps);
    TEST_ASSERT_EQUAL(QUALITY_BAD, ahead_at(0)->quality);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_BLOCK_GAVE_UP, NULL));
}

static void beside_an_element_of_the_fixed_ones_both_add(void)
{
    bench_start_with(helped);
    put_all((const char *const[]){"ff1.from", "feed", "ff1.to", "heat", "ff1.gain", "0.5", NULL});
    apply();
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    reading(FEED, 6);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.5 + 0.01 + 0.05, sent(HEAT));
}

static void it_adds_a_span_at_most(void)
{
    bench_start_with(helped);
    SET_AHEAD(0, gain, 50);
    apply();
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, D(bench.s.loop[BOTTOM].feedforward));
    reading(FEED, 0);
    ticks(300);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, D(bench.s.loop[BOTTOM].feedforward));
}

static void limits_hold_for_what_it_makes_of_an_mv_and_wind_nobody_up(void)
{
    bench_start_with(helped);
    put("mv2.max", "1.1");
    put("loop2.tt", "20");
    apply();
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
    reading(FEED, 9);
    ticks(200);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(HEAT));
    reading(T10, 112); /* more heat is asked for, for long */
    ticks(300);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(HEAT));
    reading(T10, 117);
    ticks(3);
    TEST_ASSERT_TRUE(sent(HEAT) < 0.54);
}

static void an_interlock_holds_over_it_and_afterwards_there_is_no_bump(void)
{
    bench_start_with(helped);
    put_all((const char *const[]){"lock1.meas", "T1", "lock1.mv", "heat", "lock1.limit", "120",
                                  "lock1.value", "0.2", NULL});
    apply();
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
    reading(T1, 125);
    reading(FEED, 7);
    ticks(30);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, sent(HEAT));
    ticks(100);
    reading(T1, 85);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.1, sent(HEAT));
}

static void it_may_ask_for_a_test_signal_on_what_it_looks_at_while_it_runs(void)
{
    bench_start_with(helped);
    put("mv3.hi", "10");
    put("mv3.max", "10");
    strcpy(bench.config.block[0].inputs, "spare T5");
    apply();
    request(REQUEST_OUTPUT, TOP, SPARE, 0, 5);
    ticks(3);
    stage_excites = (struct block_excitation){EXCITE_INPUT, 0, N(0.1), N(0.1), N(0), N(1)};
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, sent(SPARE));
    request(REQUEST_BLOCK, PLAN_NONE, 0, 0, 0);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, sent(SPARE));
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_EXCITATION_ENDED, NULL));
}

/* ---- plans ---- */

static void a_plan_that_changes_nothing_of_it_does_not_touch_it(void)
{
    double with[2];
    for (int k = 0; k < 2; k++) {
        helped_auto(helped);
        reading(FEED, 6);
        ticks(5);
        if (k)
            set_and_apply("alarm1.limit", "150");
        ticks(5);
        with[k] = sent(HEAT);
        TEST_ASSERT_EQUAL_UINT(1, ahead_at(0)->follows);
    }
    TEST_ASSERT_TRUE(with[0] == with[1]);
}

static void other_settings_other_mvs_or_none_move_no_output(void)
{
    helped_auto(helped);
    reading(FEED, 6);
    ticks(200);
    static const char *const points[] = {"heat,reflux", "reflux,heat", "heat", "reflux", NULL};
    for (unsigned k = 0; k < 5; k++) {
        double heat = sent(HEAT), reflux = sent(REFLUX);
        if (points[k])
            TEST_ASSERT_EQUAL(
                ERR_OK, block_list_set(bench.config.block[0].points, BLOCK_NAMES_SIZE, points[k]));
        else
            put_block(0, "", "", "", "");
        if (points[k])
            SET_AHEAD(0, gain, 1.0f - 0.4f * (float)k);
        apply();
        tick();
        TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
        TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
        tick();
        TEST_ASSERT_DOUBLE_WITHIN(2 * OWN_MOVE, heat, sent(HEAT));
        TEST_ASSERT_DOUBLE_WITHIN(2 * OWN_MOVE, reflux, sent(REFLUX));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, D(bench.s.loop[BOTTOM].feedforward));
}

static void another_span_of_what_it_looks_at_begins_anew(void)
{
    helped_auto(helped);
    reading(FEED, 6);
    ticks(200);
    double heat = sent(HEAT);
    set_and_apply("meas3.hi", "20");
    tick();
    TEST_ASSERT_EQUAL_UINT(1, ahead_at(0)->steps);
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.3, D(bench.s.loop[BOTTOM].feedforward));
}

/* ---- giving up ---- */

static void giving_up(const char *reason)
{
    double heat = sent(HEAT), reflux = sent(REFLUX);
    ticks(4);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_GAVE_UP, reason));
    TEST_ASSERT_DOUBLE_WITHIN(4 * OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(4 * OWN_MOVE, reflux, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, D(bench.s.loop[BOTTOM].feedforward));
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[BOTTOM].mode);
    stage_fails.fault = STAGE_WELL;
    reading(FEED, 8);
    ticks(2);
    heat = sent(HEAT);
    request(REQUEST_BLOCK, PLAN_NONE, 0, 1, 0);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_BLOCK_ON, "ahead"));
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.8, D(bench.s.loop[BOTTOM].feedforward));
}

static void when_it_gives_up_its_loops_fill_its_place(void)
{
    helped_auto(helped);
    stage_fails.fault = STAGE_GIVES_UP;
    stage_fails.call = CALL_STEP;
    giving_up("test");
}

static void what_is_no_number_is_given_up(void)
{
#ifndef REFLUX_FIXED_POINT
    helped_auto(helped);
    stage_fails.fault = STAGE_NO_NUMBER;
    stage_fails.call = CALL_STEP;
    giving_up("not_a_number");
#endif
}

static void when_an_input_is_bad_too(void)
{
    helped_auto(helped);
    bad_reading(FEED, QUALITY_BAD, 0);
    giving_up("feed");
}

static void when_it_is_switched_off_too(void)
{
    helped_auto(helped);
    request(REQUEST_BLOCK, PLAN_NONE, 0, 0, 0);
    giving_up("asked");
}

static void wary(void)
{
    put("meas3.hold", "2");
    put_block(0, "wary", "", "feed T5", "heat");
}

static void or_its_loops_go_to_manual_where_its_kind_says_so(void)
{
    helped_auto(wary);
    bad_reading(FEED, QUALITY_BAD, 0);
    ticks(4);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
    TEST_ASSERT_EQUAL_UINT(0, happened(EVENT_BLOCK_GAVE_UP, NULL));
    ASSERT_NO_BUMP(0.5, sent(HEAT));
}

static void after_another_plant_it_begins_anew(void)
{
    helped_auto(helped);
    supervisor_go_safe(&bench.s, "plant");
    reading(FEED, 9);
    tick();
    TEST_ASSERT_EQUAL_UINT(2, ahead_at(0)->follows);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.9, D(bench.s.loop[BOTTOM].feedforward));
}

/* ---- through a compensator ---- */

static void helped_and_crossed(void)
{
    helped();
    put_block(1, "cross", "top bottom", "", "");
}

static void what_is_added_stands_behind_the_compensator(void)
{
    helped_auto(helped_and_crossed);
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    double v = D(bench.s.loop[BOTTOM].v);
    reading(FEED, 6);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.5 + 0.01, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, v, D(bench.s.loop[BOTTOM].v));
    double heat = sent(HEAT), reflux = sent(REFLUX);
    mode(TOP, LOOP_MANUAL);
    tick(); /* what the element adds in this tick comes all the same */
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, heat + 0.009, sent(HEAT));
    ASSERT_NO_BUMP(reflux, sent(REFLUX));
    heat = sent(HEAT);
    mode(TOP, LOOP_AUTO);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, heat + 0.0081, sent(HEAT));
    ASSERT_NO_BUMP(reflux, sent(REFLUX));
}

/* ---- what a plan refuses ---- */

static void refused(const char *group, const char *field, const char *subject, const char *wanted)
{
    struct config_fault fault;
    struct plan *next = &bench.plan[1 - bench.current];
    TEST_ASSERT_NOT_EQUAL(ERR_OK, plan_build(next, &bench.config, 1.0f, &fault));
    TEST_ASSERT_EQUAL_STRING(group, fault.group);
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_EQUAL_STRING(subject, fault.subject);
    if (wanted)
        TEST_ASSERT_EQUAL_STRING(wanted, fault.wanted);
}

static void plans_that_cannot_be_are_refused_in_words(void)
{
    static const char *const wrong[][6] = {
        {"top", "feed", "heat", "loops", "top", "is one more than this kind serves"},
        {"", "", "heat", "inputs", "ahead", "must name what it looks at"},
        {"", "feed", "", "points", "ahead", "must name the manipulated variables it adds to"},
        {"", "feed", "T1", "points", "T1", "must be a manipulated variable that a loop drives"},
        {"", "feed", "spare", "points", "spare",
         "must be a manipulated variable that a loop drives"},
        {"", "feed", "heat heat", "points", "heat", "is named twice"},
        {"", "feed nothing", "heat", "inputs", "nothing",
         "must be a configured measurement or manipulated variable"},
        {"", "heat", "heat", "inputs", "heat", "is moved by what looks at it"},
    };
    for (unsigned k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        bench_start_with(helped);
        put_block(0, "ahead", wrong[k][0], wrong[k][1], wrong[k][2]);
        refused("block", wrong[k][3], wrong[k][4], wrong[k][5]);
    }
    bench_start_with(helped);
    SET_AHEAD(0, lead, 10);
    refused("block", "lead", "ahead", "at most the lag");
}

static void rings_through_others_are_refused_too(void)
{
    bench_start_with(helped);
    put_block(0, "ahead", "", "heat", "reflux");
    apply();
    put_all((const char *const[]){"ff1.from", "reflux", "ff1.to", "heat", "ff1.gain", "1", NULL});
    refused("block", "inputs", "heat", "is moved by what looks at it");
    put("ff1.from", "-");
    put("ff1.to", "-");
    put_block(1, "ahead", "", "reflux", "heat");
    refused("block", "inputs", "heat", "is moved by what looks at it");
    put_block(1, "", "", "", "");
    put_block(0, "ahead", "", "reflux", "heat");
    put_all((const char *const[]){"ff1.from", "spare", "ff1.to", "reflux", NULL});
    apply(); /* a row is no ring */
    put_all((const char *const[]){"ff1.from", "heat", "ff1.to", "reflux", NULL});
    refused("block", "inputs", "reflux", "is moved by what looks at it");
}

static void what_it_may_add_counts_for_what_a_decoupler_must_reach(void)
{
    bench_start_with(helped);
    /* Rows of the inverse of 70 at outputs of one span: 140 where an element adds another. */
    put_all((const char *const[]){"loop1.decouple", "on", "loop2.decouple", "on", "decouple1.d1",
                                  "1", "decouple1.d2", "0.97183", "decouple2.d1", "1",
                                  "decouple2.d2", "1", NULL});
    refused("decouple", "d1", "top", NULL);
    put_block(0, "", "", "", "");
    apply();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_begins_at_rest_and_adds_to_each_of_its_mvs);
    RUN_TEST(its_second_input_counts_too);
    RUN_TEST(it_waits_until_all_its_inputs_have_a_value);
    RUN_TEST(it_does_not_begin_on_an_input_that_is_bad);
    RUN_TEST(without_the_channel_it_adds_nothing_and_begins_anew_when_that_is_back);
    RUN_TEST(one_that_is_told_of_bad_inputs_waits_for_all_and_goes_on_without);
    RUN_TEST(beside_an_element_of_the_fixed_ones_both_add);
    RUN_TEST(it_adds_a_span_at_most);
    RUN_TEST(limits_hold_for_what_it_makes_of_an_mv_and_wind_nobody_up);
    RUN_TEST(an_interlock_holds_over_it_and_afterwards_there_is_no_bump);
    RUN_TEST(it_may_ask_for_a_test_signal_on_what_it_looks_at_while_it_runs);
    RUN_TEST(a_plan_that_changes_nothing_of_it_does_not_touch_it);
    RUN_TEST(other_settings_other_mvs_or_none_move_no_output);
    RUN_TEST(another_span_of_what_it_looks_at_begins_anew);
    RUN_TEST(when_it_gives_up_its_loops_fill_its_place);
    RUN_TEST(what_is_no_number_is_given_up);
    RUN_TEST(when_an_input_is_bad_too);
    RUN_TEST(when_it_is_switched_off_too);
    RUN_TEST(or_its_loops_go_to_manual_where_its_kind_says_so);
    RUN_TEST(after_another_plant_it_begins_anew);
    RUN_TEST(what_is_added_stands_behind_the_compensator);
    RUN_TEST(plans_that_cannot_be_are_refused_in_words);
    RUN_TEST(rings_through_others_are_refused_too);
    RUN_TEST(what_it_may_add_counts_for_what_a_decoupler_must_reach);
    return UNITY_END();
}
