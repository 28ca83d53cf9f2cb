/* The decoupler and the feedforward inside the supervisor: company, limits, the way back. */
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

static void a_loop_that_joins_or_leaves_moves_nobodys_output(void)
{
    both_in_automatic();
    reading(T10, 114.3);
    reading(T1, 85.2);
    ticks(20);
    double heat = sent(HEAT), reflux = sent(REFLUX);
    mode(TOP, LOOP_MANUAL);
    tick();
    ASSERT_NO_BUMP(heat, sent(HEAT));
    ASSERT_NO_BUMP(reflux, sent(REFLUX));
    ticks(10);
    heat = sent(HEAT);
    mode(TOP, LOOP_AUTO);
    tick();
    ASSERT_NO_BUMP(heat, sent(HEAT));
    ASSERT_NO_BUMP(reflux, sent(REFLUX));
}

static void another_matrix_moves_no_output(void)
{
    both_in_automatic();
    reading(T10, 114.3);
    ticks(20);
    double heat = sent(HEAT), reflux = sent(REFLUX);
    set_and_apply("decouple1.d2", "0.2");
    tick();
    ASSERT_NO_BUMP(heat, sent(HEAT));
    ASSERT_NO_BUMP(reflux, sent(REFLUX));
}

static void taking_part_or_no_longer_moves_no_output(void)
{
    both_in_automatic();
    reading(T10, 114.3);
    ticks(20);
    double heat = sent(HEAT), reflux = sent(REFLUX);
    set_and_apply("loop1.decouple", "off");
    tick();
    ASSERT_NO_BUMP(heat, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, reflux, sent(REFLUX));
    reflux = sent(REFLUX);
    set_and_apply("loop1.decouple", "on");
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, reflux, sent(REFLUX));
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

static void an_interlock_takes_its_loop_out_of_the_company_and_back_without_a_bump(void)
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
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, reflux, sent(REFLUX));
    reflux = sent(REFLUX);
    tick();
    ASSERT_NO_BUMP(reflux, sent(REFLUX));
    tick();
    TEST_ASSERT_TRUE(sent(REFLUX) > reflux); /* top goes on alone */
    ticks(100);
    reflux = sent(REFLUX);
    reading(FEED, 5);
    ticks(2);
    ASSERT_NO_BUMP(0.1, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, reflux, sent(REFLUX));
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
    /* Without the way back the integral would have risen by 1.5 in the meantime. */
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

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(entering_automatic_moves_nothing_however_large_the_inverse);
    RUN_TEST(one_loop_moves_both_outputs);
    RUN_TEST(a_loop_in_manual_neither_moves_nor_is_moved);
    RUN_TEST(a_loop_that_joins_or_leaves_moves_nobodys_output);
    RUN_TEST(another_matrix_moves_no_output);
    RUN_TEST(taking_part_or_no_longer_moves_no_output);
    RUN_TEST(output_limits_of_a_decoupled_loop_hold_for_its_output_not_for_the_blocks);
    RUN_TEST(a_saturated_output_does_not_wind_up_any_of_the_decoupled_loops);
    RUN_TEST(an_interlock_takes_its_loop_out_of_the_company_and_back_without_a_bump);
    RUN_TEST(a_feedforward_adds_to_the_output_of_an_acting_loop);
    RUN_TEST(automatic_begins_without_a_bump_under_any_feedforward);
    RUN_TEST(a_new_or_changed_or_removed_feedforward_moves_no_output);
    RUN_TEST(a_feedforward_waits_for_its_measurement_and_begins_without_a_bump);
    RUN_TEST(a_feedforward_that_saturates_the_output_does_not_wind_the_loop_up);
    RUN_TEST(two_feedforwards_on_one_output_add_up);
    RUN_TEST(a_decoupled_loop_takes_its_feedforward_into_account_on_the_way_in);
    return UNITY_END();
}
