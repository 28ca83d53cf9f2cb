/* Reasons for refusing a configuration, and the words of each refusal. */
#include "exchange/arena_sizes.h"
#include "plan/plan_build.h"
#include "supervise/arena.h"
#include "supervisor_bench.h"

static struct plan plan;
static struct config_fault fault;

void setUp(void)
{
    bench.tick_ms = 1000;
    bench_config();
}
void tearDown(void) {}

static enum err build(void)
{
    return plan_build(&plan, &bench.config, (float)bench.tick_ms / 1000.0f, &fault);
}

static void refused(enum err code, const char *group, unsigned index, const char *field,
                    const char *subject)
{
    struct parameter p;
    char name[64];
    TEST_ASSERT_EQUAL(code, build());
    TEST_ASSERT_EQUAL(code, fault.code);
    TEST_ASSERT_EQUAL_STRING(group, fault.group);
    TEST_ASSERT_EQUAL(index, fault.index);
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_EQUAL_STRING(subject, fault.subject);
    TEST_ASSERT_TRUE(fault.wanted && fault.wanted[0]);
    /* A refusal names a parameter, so that the reader can set it. */
    snprintf(name, sizeof name, index ? "%s%u.%s" : "%s%.0u.%s", group, index, field);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_find(name, &p), name);
}

static void the_defaults_alone_are_a_plan_without_channels(void)
{
    parameters_defaults(&bench.config);
    TEST_ASSERT_EQUAL(ERR_OK, build());
    TEST_ASSERT_EQUAL(0, plan_stage_end(&plan, STAGE_CONTROL));
}

static void a_plain_configuration_is_resolved_to_indices(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, build());
    TEST_ASSERT_EQUAL(T10, plan.loop[BOTTOM].pv);
    TEST_ASSERT_EQUAL(HEAT, plan.loop[BOTTOM].mv);
    TEST_ASSERT_EQUAL(BOTTOM, plan.owner[HEAT]);
    TEST_ASSERT_EQUAL(PLAN_NONE, plan.owner[SPARE]);
    TEST_ASSERT_EQUAL(PLAN_NONE, plan.loop[BOTTOM].outer);
}

static void loops_are_ordered_with_the_outer_before_the_inner(void)
{
    bench_cascade();
    TEST_ASSERT_EQUAL(ERR_OK, build());
    uint8_t at[CONFIG_LOOPS];
    TEST_ASSERT_EQUAL(4, plan_stage_end(&plan, STAGE_CONTROL));
    for (uint8_t k = 0; k < 4; k++)
        at[plan.listed[k]] = k;
    TEST_ASSERT_TRUE(at[OUTEST] < at[OUTER]);
    TEST_ASSERT_TRUE(at[OUTER] < at[BOTTOM]);
    TEST_ASSERT_EQUAL(OUTER, plan.loop[BOTTOM].outer);
}

static void names_used_twice_are_refused(void)
{
    put("meas2.name", "T1");
    refused(ERR_CONFLICT, "meas", 2, "name", "T1");
    bench_config();
    put("mv2.name", "reflux");
    refused(ERR_CONFLICT, "mv", 2, "name", "reflux");
    bench_config();
    put("loop2.name", "top");
    refused(ERR_CONFLICT, "loop", 2, "name", "top");
    bench_config();
    put("mv3.name", "top");
    refused(ERR_CONFLICT, "mv", 3, "name", "top");
}

static void words_of_the_console_are_no_names(void)
{
    put("meas2.name", "err");
    refused(ERR_CONFLICT, "meas", 2, "name", "err");
    bench_config();
    put("mv3.name", "ok");
    refused(ERR_CONFLICT, "mv", 3, "name", "ok");
    bench_config();
    put("loop1.name", "ok");
    refused(ERR_CONFLICT, "loop", 1, "name", "ok");
}

static void names_of_nothing_are_refused(void)
{
    put("loop1.pv", "T99");
    refused(ERR_UNKNOWN, "loop", 1, "pv", "T99");
    bench_config();
    put("loop1.pv", "-");
    refused(ERR_UNKNOWN, "loop", 1, "pv", "");
    bench_config();
    put("loop1.out", "T1");
    refused(ERR_UNKNOWN, "loop", 1, "out", "T1");
    bench_config();
    put("ff1.from", "wind");
    refused(ERR_UNKNOWN, "ff", 1, "from", "wind");
    bench_config();
    put("lock1.meas", "wind");
    refused(ERR_UNKNOWN, "lock", 1, "meas", "wind");
    bench_config();
    put("lock1.meas", "T1");
    put("lock1.mv", "wind");
    refused(ERR_UNKNOWN, "lock", 1, "mv", "wind");
}

static void a_feedforward_needs_an_output_that_a_loop_drives(void)
{
    put("ff1.from", "feed");
    put("ff1.to", "spare");
    refused(ERR_UNKNOWN, "ff", 1, "to", "spare");
}

static void a_feedforward_takes_a_measurement_or_an_input_the_measurement_first(void)
{
    put_all((const char *const[]){"ff1.from", "reflux", "ff1.to", "heat", NULL});
    TEST_ASSERT_EQUAL(ERR_OK, build());
    TEST_ASSERT_EQUAL_UINT8(INPUT_IS_MV | REFLUX, plan.feedforward[0].input);
    put("meas3.name", "reflux");
    TEST_ASSERT_EQUAL(ERR_OK, build());
    TEST_ASSERT_EQUAL_UINT8(FEED, plan.feedforward[0].input);
}

static void feedforwards_must_not_lead_back_to_where_they_come_from(void)
{
    put_all((const char *const[]){"ff1.from", "heat", "ff1.to", "heat", NULL});
    refused(ERR_CYCLE, "ff", 1, "from", "heat");
    put("ff1.from", "reflux");
    put_all((const char *const[]){"ff3.from", "heat", "ff3.to", "reflux", NULL});
    refused(ERR_CYCLE, "ff", 1, "from", "reflux");
    put_all((const char *const[]){"loop3.name", "more", "loop3.pv", "T5", "loop3.out", "spare",
                                  "ff3.to", "spare", "ff4.from", "feed", "ff4.to", "reflux", NULL});
    TEST_ASSERT_EQUAL(ERR_OK, build()); /* feed to reflux to heat to spare */
    put_all((const char *const[]){"ff4.from", "spare", "ff4.to", "reflux", NULL});
    refused(ERR_CYCLE, "ff", 1, "from", "reflux");
}

static void an_output_has_one_loop_and_a_loop_one_outer_loop(void)
{
    put("loop2.out", "reflux");
    refused(ERR_CONFLICT, "loop", 2, "out", "reflux");
    bench_config();
    bench_cascade();
    put("loop4.out", "bottom");
    refused(ERR_CONFLICT, "loop", 4, "out", "bottom");
}

static void loops_that_drive_each_other_in_a_ring_are_refused(void)
{
    put("loop1.out", "bottom");
    put("loop2.out", "top");
    refused(ERR_CYCLE, "loop", 1, "out", "bottom");
    bench_config();
    put("loop1.out", "top"); /* itself */
    refused(ERR_CYCLE, "loop", 1, "out", "top");
}

static void spans_and_limits_must_be_in_order(void)
{
    put("meas1.lo", "160");
    refused(ERR_RANGE, "meas", 1, "lo", "T1");
    bench_config();
    put("mv1.hi", "0");
    refused(ERR_RANGE, "mv", 1, "lo", "reflux");
    bench_config();
    put("mv1.min", "10");
    refused(ERR_RANGE, "mv", 1, "min", "reflux");
    bench_config();
    put("mv1.max", "11");
    refused(ERR_RANGE, "mv", 1, "max", "reflux");
    bench_config();
    put("mv1.safe", "-1");
    refused(ERR_RANGE, "mv", 1, "safe", "reflux");
    put("mv1.safe", "1e6");
    refused(ERR_RANGE, "mv", 1, "safe", "reflux");
    bench_config();
    put("loop1.sp_lo", "90");
    put("loop1.sp_hi", "80");
    refused(ERR_RANGE, "loop", 1, "sp_lo", "top");
    bench_config();
    put("loop1.out_lo", "1");
    TEST_ASSERT_EQUAL(ERR_RANGE, build());
}

static void a_span_that_float_cannot_resolve_is_refused(void)
{
    put("meas1.lo", "1000000");
    put("meas1.hi", "1000001");
    refused(ERR_RANGE, "meas", 1, "lo", "T1");
    put("meas1.lo", "0");
    put("meas1.hi", "1e-30");
    refused(ERR_RANGE, "meas", 1, "lo", "T1");
    put("meas1.hi", "9.9e-7"); /* 1e-6 at least, and a ten thousandth of its ends */
    refused(ERR_RANGE, "meas", 1, "lo", "T1");
    put("meas1.lo", "999901");
    put("meas1.hi", "1000000");
    refused(ERR_RANGE, "meas", 1, "lo", "T1");
    bench_config();
    put("mv1.lo", "1000000");
    put("mv1.hi", "1000001");
    refused(ERR_RANGE, "mv", 1, "lo", "reflux");
}

static void setpoint_limits_outside_the_span_are_refused(void)
{
    put("loop1.sp_lo", "50");
    put("loop1.sp_hi", "100");
    refused(ERR_RANGE, "loop", 1, "sp_lo", "top");
    put("loop1.sp_lo", "70");
    put("loop1.sp_hi", "1000");
    refused(ERR_RANGE, "loop", 1, "sp_hi", "top");
}

static void rates_too_slow_or_fast_to_be_kept_are_refused(void)
{
    put("loop1.sp_ramp", "1e-8");
    refused(ERR_RANGE, "loop", 1, "sp_ramp", "top");
    bench_config();
    put("mv1.rate", "1e-9");
    refused(ERR_RANGE, "mv", 1, "rate", "reflux");
    put("mv1.rate", "1e9");
    refused(ERR_RANGE, "mv", 1, "rate", "reflux");
    bench_config();
    put("loop1.out_rate", "1e-12");
    refused(ERR_RANGE, "loop", 1, "out_rate", "top");
}

static void times_between_zero_and_what_a_block_can_do_are_refused_by_parameter_name(void)
{
    put("loop1.ti", "0.001");
    refused(ERR_RANGE, "loop", 1, "ti", "top");
    bench_config();
    put("loop1.tt", "0.001");
    refused(ERR_RANGE, "loop", 1, "tt", "top");
    bench_config();
    put_all((const char *const[]){"ff1.from", "feed", "ff1.to", "heat", "ff1.lead", "1000", NULL});
    refused(ERR_RANGE, "ff", 1, "lead", "feed");
    put_all((const char *const[]){"ff1.lead", "0", "ff1.lo", "0.5", "ff1.hi", "0.5", NULL});
    refused(ERR_RANGE, "ff", 1, "hi", "feed");
    put_all((const char *const[]){"ff1.lo", "-1", "ff1.reference", "1000", NULL});
    refused(ERR_RANGE, "ff", 1, "reference", "feed");
}

static void a_phase_must_be_below_its_divisor(void)
{
    put("loop1.divisor", "3");
    put("loop1.phase", "2");
    TEST_ASSERT_EQUAL(ERR_OK, build());
    put("loop1.phase", "3");
    refused(ERR_RANGE, "loop", 1, "phase", "top");
}

static void a_divisor_that_makes_the_step_too_long_is_refused(void)
{
    put("tick.base", "3600");
    put("loop1.divisor", "10000");
    refused(ERR_RANGE, "loop", 1, "divisor", "top");
}

static void a_base_tick_below_a_twentieth_second_is_refused(void)
{
    put("tick.base", "0.04");
    refused(ERR_RANGE, "tick", 0, "base", "");
    put("tick.base", "0.05");
    TEST_ASSERT_EQUAL(ERR_OK, build());
    put("tick.base", "0");
    bench.tick_ms = 20; /* the plant's own is no better */
    refused(ERR_RANGE, "tick", 0, "base", "");
}

static void without_a_plant_and_a_base_tick_one_second_is_assumed(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, plan_build(&plan, &bench.config, 0.0f, &fault));
    TEST_ASSERT_EQUAL_FLOAT(1.0f, plan.tick_s);
    TEST_ASSERT_EQUAL(ERR_OK, plan_set_tick(&plan, 30.0f, &fault));
    TEST_ASSERT_EQUAL_FLOAT(30.0f, plan.tick_s);
    TEST_ASSERT_EQUAL(BOTTOM, plan.owner[HEAT]);
}

/* Rows of D^-1 that add up to 100 with this one: 127 is what a number holds, feedforward included. */
static void a_decoupler_whose_own_outputs_would_leave_the_range_of_the_number_is_refused(void)
{
    put_all((const char *const[]){"loop1.decouple", "on", "loop2.decouple", "on", "decouple1.d1",
                                  "1.5", "decouple1.d2", "-1.49", "decouple2.d1", "-1.49",
                                  "decouple2.d2", "1.5", NULL});
    TEST_ASSERT_EQUAL(ERR_OK, build());
    put_all((const char *const[]){"ff1.from", "feed", "ff1.to", "heat", "ff1.lo", "-0.5", "ff1.hi",
                                  "0.5", NULL});
    TEST_ASSERT_EQUAL(ERR_OK, build()); /* 50.2 and 49.8 * 1.5 */
    put("ff1.lo", "-1");
    refused(ERR_SINGULAR, "decouple", 1, "d1", "top");
    TEST_ASSERT_NOT_NULL(strstr(fault.wanted, "127"));
    put_all((const char *const[]){"ff1.from", "-", "decouple1.d2", "-1.495", NULL});
    refused(ERR_SINGULAR, "decouple", 1, "d1", "top");
}

static void a_decoupler_must_have_an_inverse_also_with_some_loops_in_manual(void)
{
    put_all((const char *const[]){"loop1.decouple", "on", "loop2.decouple", "on", "decouple1.d2",
                                  "0.5", "decouple2.d1", "0.5", NULL});
    TEST_ASSERT_EQUAL(ERR_OK, build());
    put("decouple1.d2", "2");
    refused(ERR_SINGULAR, "decouple", 1, "d1", "top");
    put_all(
        (const char *const[]){"decouple1.d2", "1", "decouple2.d1", "1", "decouple2.d2", "0", NULL});
    refused(ERR_SINGULAR, "decouple", 2, "d1", "bottom"); /* alone it would have nothing */
}

static void rows_of_loops_outside_the_decoupler_do_not_matter(void)
{
    put("decouple1.d1", "0");
    put("loop2.decouple", "on");
    TEST_ASSERT_EQUAL(ERR_OK, build());
}

static void only_loops_with_an_output_of_their_own_can_be_decoupled(void)
{
    bench_cascade();
    put("loop3.decouple", "on");
    refused(ERR_CONFLICT, "loop", 3, "decouple", "outer");
}

static void loops_beyond_the_matrix_cannot_be_decoupled(void)
{
    put_all((const char *const[]){"loop9.name", "ninth", "loop9.pv", "T5", "loop9.out", "spare",
                                  "loop9.decouple", "on", NULL});
    refused(ERR_RANGE, "loop", 9, "decouple", "ninth");
    put("loop9.decouple", "off");
    TEST_ASSERT_EQUAL(ERR_OK, build());
}

static void dead_times_that_do_not_fit_say_how_many_bytes_they_need(void)
{
    put_all((const char *const[]){"ff1.from", "feed", "ff1.to", "heat", "ff1.dead", "3000",
                                  "ff2.from", "feed", "ff2.to", "reflux", "ff2.dead", "2000",
                                  NULL});
    refused(ERR_MEMORY, "ff", 2, "dead", "feed");
    uint8_t placed[PLACED_KINDS];
    arena_count(&plan, placed);
    uint32_t lines = 4 * (3002 + 2002), before = arena_state_bytes(placed) + lines;
    TEST_ASSERT_TRUE(fault.bytes > before &&
                     fault.bytes < before + 1000); /* and the states of the blocks */
    TEST_ASSERT_EQUAL(0, fault.bytes % 8);
    put("ff2.dead", "700");
    TEST_ASSERT_EQUAL(ERR_OK, build());
    /* Behind the states of channels and loops, and behind one another. */
    uint32_t at = arena_state_bytes(placed) / ARENA_GRAIN;
    for (unsigned b = 0; b < PLAN_BLOCKS; b++) {
        TEST_ASSERT_EQUAL(at, plan.block[b].grain);
        at += plan.block[b].grains;
    }
    TEST_ASSERT_TRUE(at * ARENA_GRAIN <= PLAN_ARENA_BYTES);
    TEST_ASSERT_TRUE(plan.block[BLOCK_FEEDFORWARDS].grains * ARENA_GRAIN >= 4 * 3002);
}

static void an_interlock_forces_within_the_span(void)
{
    put_all(
        (const char *const[]){"lock1.meas", "T10", "lock1.mv", "heat", "lock1.value", "2.5", NULL});
    refused(ERR_RANGE, "lock", 1, "value", "heat");
}

static void a_test_step_wider_than_half_the_span_and_unknown_pairs_are_refused(void)
{
    put("mv1.test_step", "6");
    refused(ERR_RANGE, "mv", 1, "test_step", "reflux");
    put("mv1.test_step", "5");
    put("pair2.meas", "T1");
    refused(ERR_UNKNOWN, "pair", 2, "mv", "");
    put("pair2.mv", "nobody");
    refused(ERR_UNKNOWN, "pair", 2, "mv", "nobody");
    put("pair2.mv", "heat");
    TEST_ASSERT_EQUAL(ERR_OK, build());
    put("pair2.meas", "heat");
    refused(ERR_UNKNOWN, "pair", 2, "meas", "heat");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_defaults_alone_are_a_plan_without_channels);
    RUN_TEST(a_plain_configuration_is_resolved_to_indices);
    RUN_TEST(loops_are_ordered_with_the_outer_before_the_inner);
    RUN_TEST(names_used_twice_are_refused);
    RUN_TEST(words_of_the_console_are_no_names);
    RUN_TEST(names_of_nothing_are_refused);
    RUN_TEST(a_feedforward_needs_an_output_that_a_loop_drives);
    RUN_TEST(a_feedforward_takes_a_measurement_or_an_input_the_measurement_first);
    RUN_TEST(feedforwards_must_not_lead_back_to_where_they_come_from);
    RUN_TEST(an_output_has_one_loop_and_a_loop_one_outer_loop);
    RUN_TEST(loops_that_drive_each_other_in_a_ring_are_refused);
    RUN_TEST(spans_and_limits_must_be_in_order);
    RUN_TEST(a_span_that_float_cannot_resolve_is_refused);
    RUN_TEST(setpoint_limits_outside_the_span_are_refused);
    RUN_TEST(rates_too_slow_or_fast_to_be_kept_are_refused);
    RUN_TEST(times_between_zero_and_what_a_block_can_do_are_refused_by_parameter_name);
    RUN_TEST(a_phase_must_be_below_its_divisor);
    RUN_TEST(a_divisor_that_makes_the_step_too_long_is_refused);
    RUN_TEST(a_base_tick_below_a_twentieth_second_is_refused);
    RUN_TEST(without_a_plant_and_a_base_tick_one_second_is_assumed);
    RUN_TEST(a_decoupler_whose_own_outputs_would_leave_the_range_of_the_number_is_refused);
    RUN_TEST(a_decoupler_must_have_an_inverse_also_with_some_loops_in_manual);
    RUN_TEST(rows_of_loops_outside_the_decoupler_do_not_matter);
    RUN_TEST(only_loops_with_an_output_of_their_own_can_be_decoupled);
    RUN_TEST(loops_beyond_the_matrix_cannot_be_decoupled);
    RUN_TEST(dead_times_that_do_not_fit_say_how_many_bytes_they_need);
    RUN_TEST(an_interlock_forces_within_the_span);
    RUN_TEST(a_test_step_wider_than_half_the_span_and_unknown_pairs_are_refused);
    return UNITY_END();
}
