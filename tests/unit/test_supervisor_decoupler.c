/* The decoupler and the feedforward inside the supervisor: members, limits, back-calculation. */
#include "supervisor_bench.h"

/* A strong one, as a column's: the inverse has entries of 6. */
static void strongly_decoupled(void)
{
    put_all((const char *const[]){"loop1.decouple", "on", "loop2.decouple", "on", "decouple1.d2",
                                  "0.9", "decouple2.d1", "0.93", NULL});
}

void setUp(void)
{
    bench_start_with(strongly_decoupled);
}
void tearDown(void) {}

/* Move of both loops' own outputs in a tick, by integration: they go on while the members change. */
#define OWN_MOVE 1.2e-4

static void both_in_automatic(void)
{
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
}

static void entering_automatic_moves_nothing_however_large_the_inverse(void)
{
    out(TOP, 9);
    out(BOTTOM, 0.4);
    tick();
    both_in_automatic();
    ASSERT_NO_BUMP(0.9, sent(REFLUX)); /* v is far outside 0 .. 1 here */
    ASSERT_NO_BUMP(0.2, sent(HEAT));
}

static void one_loop_moves_both_outputs(void)
{
    both_in_automatic();
    reading(T10, 114);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.5 + 0.015, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.5 + 0.9 * 0.015, sent(REFLUX));
}

static void a_loop_in_manual_neither_moves_nor_is_moved(void)
{
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
    reading(T10, 114);
    reading(T1, 90);
    ticks(10);
    TEST_ASSERT_TRUE(sent(HEAT) > 0.51);
    TEST_ASSERT_DOUBLE_WITHIN(0, D(N(0.5)), sent(REFLUX));
}

static void a_loop_that_takes_no_part_moves_nothing_though_the_matrix_has_numbers_for_it(void)
{
    set_and_apply("loop1.decouple", "off");
    both_in_automatic();
    double reflux = sent(REFLUX);
    reading(T10, 114);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.5 + 0.015, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
}

static void a_loop_that_joins_or_leaves_moves_nobodys_output(void)
{
    both_in_automatic();
    reading(T10, 114.3);
    reading(T1, 85.2);
    ticks(20);
    double heat = sent(HEAT), reflux = sent(REFLUX);
    mode(TOP, LOOP_MANUAL);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
    ticks(10);
    heat = sent(HEAT);
    mode(TOP, LOOP_AUTO);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
}

static void another_matrix_moves_no_output(void)
{
    both_in_automatic();
    reading(T10, 114.3);
    ticks(20);
    double heat = sent(HEAT), reflux = sent(REFLUX);
    set_and_apply("decouple1.d2", "0.2");
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
}

static void taking_part_or_no_longer_moves_no_output(void)
{
    both_in_automatic();
    reading(T10, 114.3);
    ticks(20);
    double heat = sent(HEAT), reflux = sent(REFLUX);
    set_and_apply("loop1.decouple", "off");
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
    reflux = sent(REFLUX);
    set_and_apply("loop1.decouple", "on");
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
}

static void rounding_of_the_inverse_never_moves_a_loop_that_was_not_limited(void)
{
    both_in_automatic();
    reading(T10, 114.3);
    reading(T1, 85.2);
    ticks(20);
    put_all((const char *const[]){"loop1.ti", "100000", "loop2.ti", "100000", "loop1.tt", "5",
                                  "loop2.tt", "5", NULL});
    apply();
    setpoint(TOP, 85.2);
    setpoint(BOTTOM, 114.3);
    ticks(3);
    num_t top = bench.s.loop[TOP].v, bottom = bench.s.loop[BOTTOM].v;
    ticks(200);
    TEST_ASSERT_TRUE(num_eq(top, bench.s.loop[TOP].v));
    TEST_ASSERT_TRUE(num_eq(bottom, bench.s.loop[BOTTOM].v));
}

static void output_limits_of_a_decoupled_loop_hold_for_its_output_not_for_the_blocks(void)
{
    set_and_apply("loop2.out_hi", "0.6");
    both_in_automatic();
    reading(T10, 90);
    ticks(50);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, sent(HEAT));
}

static void a_saturated_output_does_not_wind_up_any_of_the_decoupled_loops(void)
{
    both_in_automatic();
    reading(T10, 105); /* heat saturates */
    ticks(4000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, sent(HEAT));
    double reflux = sent(REFLUX);
    TEST_ASSERT_TRUE(reflux > 0.0 && reflux <= 1.0);
    reading(T10, 125); /* and comes off at once when the error turns */
    ticks(3);
    TEST_ASSERT_TRUE(sent(HEAT) < 0.95);
}

static void an_interlock_takes_its_loop_out_of_the_decoupler_and_back_without_a_bump(void)
{
    put_all((const char *const[]){"lock1.meas", "feed", "lock1.mv", "heat", "lock1.limit", "8",
                                  "lock1.value", "0.2", NULL});
    apply();
    both_in_automatic();
    reading(T1, 85.5);
    ticks(10);
    double reflux = sent(REFLUX);
    reading(FEED, 9);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
    reflux = sent(REFLUX);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
    tick();
    TEST_ASSERT_TRUE(sent(REFLUX) > reflux); /* top goes on alone */
    ticks(100);
    reflux = sent(REFLUX);
    reading(FEED, 5);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, 0.1, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, reflux, sent(REFLUX));
}

/* ---- feedforward ---- */

static void with_feedforward(void)
{
    put_all((const char *const[]){"ff1.from", "feed", "ff1.to", "heat", "ff1.gain", "0.4",
                                  "ff1.reference", "5", NULL});
}

static void a_feedforward_adds_to_the_output_of_an_acting_loop(void)
{
    bench_start_with(with_feedforward);
    mode(BOTTOM, LOOP_AUTO);
    tick();
    reading(FEED, 6);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.54, sent(HEAT));
    mode(BOTTOM, LOOP_MANUAL);
    reading(FEED, 8);
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.54, sent(HEAT)); /* manual is manual */
}

static void automatic_begins_without_a_bump_under_any_feedforward(void)
{
    bench_start_with(with_feedforward);
    reading(FEED, 9);
    ticks(3);
    mode(BOTTOM, LOOP_AUTO);
    tick();
    ASSERT_NO_BUMP(0.5, sent(HEAT));
}

static void a_new_or_changed_or_removed_feedforward_moves_no_output(void)
{
    static const char *const changes[][2] = {
        {"ff1.gain", "0.1"},  {"ff1.reference", "2"}, {"ff1.lag", "30"},    {"ff1.dead", "20"},
        {"ff1.to", "reflux"}, {"ff1.from", "-"},      {"ff2.from", "feed"}, {"ff1.lo", "0"}};
    for (unsigned k = 0; k < sizeof changes / sizeof changes[0]; k++) {
        bench_start_with(with_feedforward);
        put_all((const char *const[]){"ff2.to", "heat", "ff2.gain", "-0.3", NULL});
        apply();
        mode(BOTTOM, LOOP_AUTO);
        mode(TOP, LOOP_AUTO);
        reading(FEED, 7);
        ticks(5);
        double heat = sent(HEAT), reflux = sent(REFLUX);
        set_and_apply(changes[k][0], changes[k][1]);
        tick();
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(BUMP, heat, sent(HEAT), changes[k][0]);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(BUMP, reflux, sent(REFLUX), changes[k][0]);
    }
}

static void a_feedforward_waits_for_its_measurement_and_begins_without_a_bump(void)
{
    bench_start();
    bad_reading(FEED, QUALITY_MISSING, 0);
    with_feedforward();
    put("ff1.reference", "1");
    put("meas3.name", "feed2"); /* a channel never seen */
    put("ff1.from", "feed2");
    apply();
    mode(BOTTOM, LOOP_AUTO);
    ticks(2);
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    reading(FEED, 9);
    tick();
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    reading(FEED, 8);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.46, sent(HEAT));
}

static void a_feedforward_that_saturates_the_output_does_not_wind_the_loop_up(void)
{
    bench_start_with(with_feedforward);
    mode(BOTTOM, LOOP_AUTO);
    tick();
    put("ff1.gain", "1");
    reading(T10, 112);
    apply();
    tick();
    reading(FEED, 10);
    ticks(3000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, sent(HEAT));
    reading(FEED, 5);
    ticks(2);
    /* Without back-calculation the integral would have risen by 1.5 in the meantime. */
    TEST_ASSERT_TRUE(sent(HEAT) < 0.6);
}

static void two_feedforwards_on_one_output_add_up(void)
{
    bench_start_with(with_feedforward);
    put_all((const char *const[]){"ff2.from", "T5", "ff2.to", "heat", "ff2.gain", "-0.5",
                                  "ff2.reference", "100", NULL});
    apply();
    mode(BOTTOM, LOOP_AUTO);
    tick();
    reading(FEED, 6);
    reading(T5, 102);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.5 + 0.04 - 0.01, sent(HEAT));
}

static void a_decoupled_loop_takes_its_feedforward_into_account_on_the_way_in(void)
{
    with_feedforward();
    apply();
    reading(FEED, 9);
    tick();
    both_in_automatic();
    ASSERT_NO_BUMP(0.5, sent(HEAT));
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
}

/* The upset that trips an interlock, or makes somebody act, is the one the feedforward sees. */
static void a_feedforward_that_moves_in_the_tick_in_which_the_members_change_moves_its_output(void)
{
    with_feedforward();
    apply();
    mode(BOTTOM, LOOP_AUTO);
    ticks(3);
    reading(FEED, 6);
    mode(TOP, LOOP_AUTO);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, 0.54, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, 0.5, sent(REFLUX));
    reading(FEED, 8);
    mode(TOP, LOOP_MANUAL);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, 0.62, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(OWN_MOVE, 0.5, sent(REFLUX));
}

/* A correction of -0.3 from an output of 0.8: the loop's own part is 1.1 then. */
static void automatic_begins_without_a_bump_and_reaches_both_ends_where_feedforward_takes_away(void)
{
    for (unsigned velocity = 0; velocity < 2; velocity++) {
        bench_start_with(with_feedforward);
        set_and_apply("loop2.algorithm", velocity ? "velocity" : "positional");
        out(BOTTOM, 1.6);
        reading(FEED, 0); /* below the reference by half the span; 0.4 of it is -0.2 */
        set_and_apply("ff1.gain", "0.6");
        ticks(3);
        mode(BOTTOM, LOOP_AUTO);
        ticks(2);
        ASSERT_NO_BUMP(0.8, sent(HEAT));
        reading(T10, 108); /* too cold: all there is */
        ticks(2000);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, sent(HEAT));
        reading(T10, 122);
        ticks(4000);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, sent(HEAT));
    }
}

static void output_limits_hold_for_what_reaches_the_manipulated_variable(void)
{
    bench_start_with(with_feedforward);
    set_and_apply("loop2.out_hi", "0.7");
    mode(BOTTOM, LOOP_AUTO);
    ticks(2);
    reading(FEED, 10); /* 0.5 and 0.2 more */
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.7, sent(HEAT));
    reading(T10, 110);
    ticks(500);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.7, sent(HEAT));
    reading(T10, 116); /* and does not wind up there */
    ticks(2);
    TEST_ASSERT_TRUE(sent(HEAT) < 0.69);
}

static void an_output_found_outside_its_loops_limits_enters_them_at_the_loops_rate(void)
{
    bench_start();
    put_all((const char *const[]){"loop2.out_hi", "0.7", "loop2.out_rate", "0.01", NULL});
    apply();
    out(BOTTOM, 1.6);
    tick();
    mode(BOTTOM, LOOP_AUTO);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.79, sent(HEAT));
    ticks(5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.74, sent(HEAT));
    ticks(20);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.7, sent(HEAT));
    mode(BOTTOM, LOOP_MANUAL);
    out(BOTTOM, 0.2);
    set_and_apply("loop2.out_lo", "0.3");
    tick();
    mode(BOTTOM, LOOP_AUTO);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.11, sent(HEAT));
    ticks(40);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.3, sent(HEAT));
}

/* D^-1 of this has rows that add up to 100: v of 95 at outputs of 0.95, where one product alone is 142. */
static void nearly_opposite(void)
{
    put_all((const char *const[]){"loop1.decouple", "on", "loop2.decouple", "on", "decouple1.d1",
                                  "1.5", "decouple1.d2", "-1.49", "decouple2.d1", "-1.49",
                                  "decouple2.d2", "1.5", NULL});
}

static void products_of_a_row_beyond_the_range_of_the_number_cancel(void)
{
    bench_start_with(nearly_opposite);
    out(TOP, 9.5);
    out(BOTTOM, 1.9);
    tick();
    both_in_automatic();
    TEST_ASSERT_DOUBLE_WITHIN(2e-5, 0.95, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(2e-5, 0.95, sent(HEAT));
    ticks(100);
    TEST_ASSERT_DOUBLE_WITHIN(2e-5, 0.95, sent(HEAT));
}

/* v of 25 times 40 asks for a thousand spans: the command ends with the range of Q7.24, the way back must not. */
static void loops_come_back_from_a_command_beyond_the_range_of_the_number(void)
{
    for (unsigned velocity = 0; velocity < 2; velocity++) {
        bench_start();
        put_all((const char *const[]){"loop1.decouple", "on", "loop2.decouple", "on",
                                      "decouple1.d1", "40", "loop1.gain", "50", "loop1.ti", "100",
                                      "loop1.algorithm", velocity ? "velocity" : "positional",
                                      NULL});
        apply();
        both_in_automatic();
        reading(T1, 135);
        ticks(2000);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, sent(REFLUX));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, sent(HEAT));
        reading(T1, 75);
        ticks(3);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, sent(REFLUX));
    }
}

/* Thrown to one end and to the other, the loop stands at that end: with what is added to the output on its own, not beside it. */
static void what_an_output_is_excited_by_is_part_of_the_way_back_from_there(void)
{
    for (unsigned n = 0; n < 4; n++) {
        bench_start();
        put_all((const char *const[]){"loop1.decouple", "on", "loop2.decouple", "on",
                                      "decouple1.d1", "40", "loop1.gain", "50", "loop1.ti", "100",
                                      "loop1.algorithm", "velocity", NULL});
        apply();
        both_in_automatic();
        supervisor_excite(&bench.s, REFLUX, N(n < 2 ? 0.125 : -0.125));
        reading(T1, n % 2 ? 135 : 65);
        ticks(20);
        double end = sent(REFLUX);
        reading(T1, 85);
        tick();
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0 - end, sent(REFLUX));
        tick();
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1.0 - end, sent(REFLUX));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(entering_automatic_moves_nothing_however_large_the_inverse);
    RUN_TEST(one_loop_moves_both_outputs);
    RUN_TEST(a_loop_in_manual_neither_moves_nor_is_moved);
    RUN_TEST(a_loop_that_takes_no_part_moves_nothing_though_the_matrix_has_numbers_for_it);
    RUN_TEST(a_loop_that_joins_or_leaves_moves_nobodys_output);
    RUN_TEST(another_matrix_moves_no_output);
    RUN_TEST(taking_part_or_no_longer_moves_no_output);
    RUN_TEST(rounding_of_the_inverse_never_moves_a_loop_that_was_not_limited);
    RUN_TEST(output_limits_of_a_decoupled_loop_hold_for_its_output_not_for_the_blocks);
    RUN_TEST(a_saturated_output_does_not_wind_up_any_of_the_decoupled_loops);
    RUN_TEST(an_interlock_takes_its_loop_out_of_the_decoupler_and_back_without_a_bump);
    RUN_TEST(a_feedforward_adds_to_the_output_of_an_acting_loop);
    RUN_TEST(automatic_begins_without_a_bump_under_any_feedforward);
    RUN_TEST(a_new_or_changed_or_removed_feedforward_moves_no_output);
    RUN_TEST(a_feedforward_waits_for_its_measurement_and_begins_without_a_bump);
    RUN_TEST(a_feedforward_that_saturates_the_output_does_not_wind_the_loop_up);
    RUN_TEST(two_feedforwards_on_one_output_add_up);
    RUN_TEST(a_decoupled_loop_takes_its_feedforward_into_account_on_the_way_in);
    RUN_TEST(a_feedforward_that_moves_in_the_tick_in_which_the_members_change_moves_its_output);
    RUN_TEST(automatic_begins_without_a_bump_and_reaches_both_ends_where_feedforward_takes_away);
    RUN_TEST(output_limits_hold_for_what_reaches_the_manipulated_variable);
    RUN_TEST(an_output_found_outside_its_loops_limits_enters_them_at_the_loops_rate);
    RUN_TEST(products_of_a_row_beyond_the_range_of_the_number_cancel);
    RUN_TEST(loops_come_back_from_a_command_beyond_the_range_of_the_number);
    RUN_TEST(what_an_output_is_excited_by_is_part_of_the_way_back_from_there);
    return UNITY_END();
}
