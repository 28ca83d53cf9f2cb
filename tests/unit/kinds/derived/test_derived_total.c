/* Rates, counters and totals of the kind `derived`: a week without loss, what a total says of what it missed, and what it survives.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "derived_bench.h"
#include "random_source.h"

static struct derived_bench b;

void setUp(void) {}
void tearDown(void) {}

/* A flow in l/h, 0 to 100, and a volume of 0 to 20000 l. */
static void one_total(void)
{
    derived_wire(&b, 1, 1);
    b.settings.form[0] = DERIVED_TOTAL;
    b.settings.weight[0][0] = 1;
    b.settings.per[0] = DERIVED_PER_H;
    b.setup.point[0].hi = 20000;
    derived_take(&b, false);
}

static void begin_total(double flow)
{
    one_total();
    derived_put(&b, 0, flow);
    derived_run(&b, 1);
    TEST_ASSERT_NULL(derived_reset(&b, 0));
}

/* ---- precision ---- */

/* Bound: three roundings of each product, 3 x 2^-24 of the volume, and the steps of num_t in the flow and in the point. */
static void expect_volume(double volume, double hours)
{
    double bound = 3 * 0x1p-24 * volume + hours * 100 * 0x1p-25 + derived_steps(&b, 0, 2);
    TEST_ASSERT_DOUBLE_WITHIN(bound, volume, derived_reads(&b, 0));
    TEST_ASSERT_EQUAL(QUALITY_GOOD, b.point_quality[0]);
}

static void a_week_of_a_small_flow_is_counted_in_full(void)
{
    begin_total(0.125);
    float naive = 0;
    for (unsigned t = 0; t < 7 * 86400; t++) {
        derived_run(&b, 1);
        naive += 0.125f * 1000 / 3600000;
    }
    expect_volume(0.125 * 168, 168);
    /* What it is good for. */
    TEST_ASSERT_TRUE(fabs((double)naive - 21) > 1e-3);
}

static void a_small_flow_counts_on_top_of_a_large_volume_at_short_ticks(void)
{
    begin_total(100);
    b.setup.interval_s = 0.05f;
    b.step_ms = 50;
    derived_run(&b, 168 * 3600); /* 8.4 h */
    double volume = 840;
    expect_volume(volume, 8.4);
    derived_put(&b, 0, 0.001);
    double tiny = 100 * D(b.input[0]);
    derived_run(&b, 1000 * 72);
    /* An hour of 1 ml is a thousandth of a step of the point; the inner value has it. */
    TEST_ASSERT_DOUBLE_WITHIN(3 * 0x1p-24 * volume, volume + tiny, derived_inside(&b, "total_1"));
}

static void a_week_of_random_flow_is_the_sum_in_double(void)
{
    struct random_source r = {20261130};
    double volume = 0;
    printf("seed %llu\n", (unsigned long long)r.state);
    begin_total(0);
    for (unsigned t = 0; t < 7 * 86400; t++) {
        derived_put(&b, 0, random_below(&r, 65536) * 100.0 / 65536);
        volume += 100 * D(b.input[0]) / 3600;
        derived_run(&b, 1);
    }
    expect_volume(volume, 168);
}

/* ---- time ---- */

static void a_lost_sample_costs_no_volume(void)
{
    begin_total(36);
    derived_run(&b, 10);
    b.time_ms += 4000;
    derived_run(&b, 10);
    TEST_ASSERT_DOUBLE_WITHIN(derived_steps(&b, 0, 4), 24 * 0.01, derived_reads(&b, 0));
    TEST_ASSERT_EQUAL(QUALITY_GOOD, b.point_quality[0]);
}

static void flow_that_nobody_measured_is_bad_meanwhile_and_bridged_if_short(void)
{
    begin_total(36);
    b.quality[0] = QUALITY_BAD;
    derived_run(&b, 9);
    TEST_ASSERT_EQUAL(QUALITY_BAD, b.point_quality[0]);
    b.quality[0] = QUALITY_GOOD;
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, b.point_quality[0]);
    TEST_ASSERT_DOUBLE_WITHIN(derived_steps(&b, 0, 4), 10 * 0.01, derived_reads(&b, 0));
}

static void a_longer_stretch_is_left_out_and_said_until_the_next_reset(void)
{
    begin_total(36);
    b.quality[0] = QUALITY_BAD;
    derived_run(&b, 30);
    b.quality[0] = QUALITY_GOOD;
    derived_run(&b, 11);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, b.point_quality[0]);
    TEST_ASSERT_TRUE(derived_says(&b, "gap"));
    TEST_ASSERT_EQUAL_DOUBLE(31, derived_inside(&b, "missed_1"));
    TEST_ASSERT_DOUBLE_WITHIN(derived_steps(&b, 0, 4), 10 * 0.01, derived_reads(&b, 0));
    TEST_ASSERT_NULL(derived_reset(&b, 0));
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, b.point_quality[0]);
    TEST_ASSERT_FALSE(derived_says(&b, "gap"));
    TEST_ASSERT_EQUAL_DOUBLE(0, derived_inside(&b, "missed_1"));
    TEST_ASSERT_DOUBLE_WITHIN(derived_steps(&b, 0, 4), 0.01, derived_reads(&b, 0));
}

static void after_an_absence_of_the_plant_the_total_stays_and_is_uncertain(void)
{
    begin_total(36);
    derived_run(&b, 100);
    derived_kind.follow(b.state, &b.io);
    b.time_ms += 3600000;
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, b.point_quality[0]);
    TEST_ASSERT_DOUBLE_WITHIN(derived_steps(&b, 0, 4), 1, derived_reads(&b, 0));
}

static void plant_time_that_goes_back_is_an_absence(void)
{
    begin_total(36);
    derived_run(&b, 100);
    b.time_ms = 0;
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, b.point_quality[0]);
    TEST_ASSERT_DOUBLE_WITHIN(derived_steps(&b, 0, 4), 1, derived_reads(&b, 0));
}

static void ticks_longer_than_the_bridge_are_no_gaps(void)
{
    one_total();
    b.setup.interval_s = 60;
    b.step_ms = 60000;
    derived_take(&b, false);
    derived_put(&b, 0, 36);
    TEST_ASSERT_NULL(derived_reset(&b, 0));
    derived_run(&b, 61); /* the first step has no time before it */
    TEST_ASSERT_DOUBLE_WITHIN(derived_steps(&b, 0, 4), 36, derived_reads(&b, 0));
    TEST_ASSERT_EQUAL(QUALITY_GOOD, b.point_quality[0]);
    b.time_ms += 60000;
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, b.point_quality[0]);
}

/* ---- reset ---- */

static void a_total_is_bad_until_somebody_says_where_it_begins(void)
{
    one_total();
    derived_put(&b, 0, 36);
    derived_run(&b, 100);
    TEST_ASSERT_EQUAL(QUALITY_BAD, b.point_quality[0]);
    TEST_ASSERT_EQUAL_DOUBLE(0, derived_inside(&b, "total_1"));
    TEST_ASSERT_NULL(derived_reset(&b, 0));
    derived_run(&b, 100);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, b.point_quality[0]);
    TEST_ASSERT_DOUBLE_WITHIN(derived_steps(&b, 0, 4), 1, derived_reads(&b, 0));
}

static void settings_without_a_past_begin_without_a_total(void)
{
    begin_total(36);
    derived_run(&b, 100);
    derived_take(&b, false);
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_BAD, b.point_quality[0]);
    TEST_ASSERT_EQUAL_DOUBLE(0, derived_inside(&b, "total_1"));
}

static void another_unit_of_time_or_factor_keeps_the_volume(void)
{
    begin_total(36);
    derived_run(&b, 100);
    b.settings.per[0] = DERIVED_PER_MIN;
    b.settings.weight[0][0] = 0.5f;
    derived_take(&b, true);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, derived_inside(&b, "total_1"));
    derived_run(&b, 60);
    TEST_ASSERT_DOUBLE_WITHIN(derived_steps(&b, 0, 4), 19, derived_reads(&b, 0));
    TEST_ASSERT_EQUAL(QUALITY_GOOD, b.point_quality[0]);
}

static void a_channel_that_becomes_another_form_loses_its_total(void)
{
    begin_total(36);
    derived_run(&b, 100);
    b.settings.form[0] = DERIVED_SUM;
    derived_take(&b, true);
    derived_run(&b, 1);
    b.settings.form[0] = DERIVED_TOTAL;
    derived_take(&b, true);
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_BAD, b.point_quality[0]);
    TEST_ASSERT_EQUAL_DOUBLE(0, derived_inside(&b, "total_1"));
}

static void a_reset_takes_one_total_or_all_and_refuses_what_is_none(void)
{
    derived_wire(&b, 1, 3);
    for (unsigned k = 0; k < 3; k++) {
        b.settings.form[k] = k ? DERIVED_TOTAL : DERIVED_SUM;
        b.settings.weight[k][0] = 1;
    }
    derived_take(&b, false);
    TEST_ASSERT_EQUAL_STRING("no_total", derived_reset(&b, 1));
    TEST_ASSERT_EQUAL_STRING("no_total", derived_reset(&b, 4));
    TEST_ASSERT_NULL(derived_reset(&b, 3));
    derived_run(&b, 2);
    TEST_ASSERT_EQUAL(QUALITY_BAD, b.point_quality[1]);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, b.point_quality[2]);
    TEST_ASSERT_NULL(derived_reset(&b, 0));
    derived_run(&b, 2);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, b.point_quality[1]);
}

static void flows_below_the_cut_do_not_count(void)
{
    begin_total(0.4);
    b.settings.cut[0] = 0.5f;
    derived_take(&b, true);
    derived_run(&b, 1000);
    TEST_ASSERT_EQUAL_DOUBLE(0, derived_inside(&b, "total_1"));
    derived_put(&b, 0, 36);
    derived_run(&b, 100);
    TEST_ASSERT_DOUBLE_WITHIN(derived_steps(&b, 0, 4), 1, derived_reads(&b, 0));
}

/* ---- rates ---- */

/* A counter of pulses, 450 to the litre, that begins anew after 65535; the flow in l/min. */
static void one_counter(void)
{
    derived_wire(&b, 1, 1);
    b.settings.form[0] = DERIVED_RATE;
    b.settings.weight[0][0] = 1.0f / 450;
    b.settings.per[0] = DERIVED_PER_MIN;
    b.settings.lag_s[0] = 0;
    b.settings.wrap[0] = 65536;
    b.setup.input[0] = (struct block_signal){0, 65536, false};
    derived_take(&b, false);
}

static void the_rate_of_a_counter_is_its_flow_also_where_it_begins_anew(void)
{
    one_counter();
    for (unsigned t = 0; t < 200; t++) {
        derived_put(&b, 0, (65000 + 9 * t) % 65536);
        derived_run(&b, 1);
        if (t == 0) {
            TEST_ASSERT_EQUAL(QUALITY_BAD, b.point_quality[0]);
            continue;
        }
        TEST_ASSERT_EQUAL(QUALITY_GOOD, b.point_quality[0]);
        /* A step of the counter's span is 1/256 of a pulse. */
        TEST_ASSERT_DOUBLE_WITHIN(9.0 / 450 * 60 / 256, 9.0 / 450 * 60, derived_reads(&b, 0));
    }
}

static void pulses_that_came_while_readings_were_bad_are_spread_over_that_time(void)
{
    one_counter();
    derived_put(&b, 0, 0);
    derived_run(&b, 2);
    b.quality[0] = QUALITY_BAD;
    derived_run(&b, 9);
    TEST_ASSERT_EQUAL(QUALITY_BAD, b.point_quality[0]);
    b.quality[0] = QUALITY_GOOD;
    derived_put(&b, 0, 90);
    derived_run(&b, 1);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.2, derived_reads(&b, 0));
}

static void a_rate_begins_anew_after_an_absence(void)
{
    one_counter();
    derived_put(&b, 0, 0);
    derived_run(&b, 2);
    derived_kind.follow(b.state, &b.io);
    derived_put(&b, 0, 30000);
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_BAD, b.point_quality[0]);
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, b.point_quality[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, derived_reads(&b, 0));
}

static void a_rate_behind_a_lag_has_its_time_constant(void)
{
    derived_wire(&b, 1, 1);
    b.settings.form[0] = DERIVED_RATE;
    b.settings.weight[0][0] = 1;
    b.settings.lag_s[0] = 100;
    derived_take(&b, false);
    derived_put(&b, 0, 0);
    derived_run(&b, 2);
    for (unsigned t = 1; t <= 100; t++) {
        derived_put(&b, 0, 0.5 * t);
        derived_run(&b, 1);
    }
    /* Backward Euler of 100 steps of a hundredth. */
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.5 * (1 - pow(1 / 1.01, 100)), derived_reads(&b, 0));
}

/* ---- counters ---- */

static void counted_volume(void)
{
    one_counter();
    b.settings.form[0] = DERIVED_TOTAL;
    b.setup.point[0].hi = 20000;
    derived_take(&b, false);
    derived_put(&b, 0, 65000);
    derived_run(&b, 1);
    TEST_ASSERT_NULL(derived_reset(&b, 0));
}

static void a_week_of_pulses_is_counted_to_the_pulse(void)
{
    uint64_t count = 65000;
    counted_volume();
    for (unsigned t = 0; t < 7 * 86400; t++) {
        count += t % 3 ? 7 : 0;
        derived_put(&b, 0, (double)(count % 65536));
        derived_run(&b, 1);
    }
    double litres = (double)(count - 65000) / 450;
    TEST_ASSERT_DOUBLE_WITHIN(2 * 0x1p-24 * litres + 1.0 / 450 / 256, litres,
                              derived_inside(&b, "total_1"));
    TEST_ASSERT_EQUAL(QUALITY_GOOD, b.point_quality[0]);
}

static void pulses_count_on_while_nobody_reads_them(void)
{
    counted_volume();
    b.quality[0] = QUALITY_BAD;
    derived_run(&b, 600);
    TEST_ASSERT_EQUAL(QUALITY_BAD, b.point_quality[0]);
    b.quality[0] = QUALITY_GOOD;
    derived_put(&b, 0, 65450);
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, b.point_quality[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1, derived_inside(&b, "total_1"));
}

static void a_counter_that_was_put_back_leaves_a_gap(void)
{
    counted_volume();
    derived_put(&b, 0, 65450);
    derived_run(&b, 1);
    derived_put(&b, 0, 50000);
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, b.point_quality[0]);
    derived_put(&b, 0, 50450);
    derived_run(&b, 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 2, derived_inside(&b, "total_1"));
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, b.point_quality[0]);
}

static void a_counter_with_another_factor_begins_without_a_total(void)
{
    counted_volume();
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, b.point_quality[0]);
    b.settings.weight[0][0] = 1.0f / 455;
    derived_take(&b, true);
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_BAD, b.point_quality[0]);
}

static void a_counter_behind_an_absence_is_another_one(void)
{
    counted_volume();
    derived_kind.follow(b.state, &b.io);
    derived_put(&b, 0, 65450);
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, b.point_quality[0]);
    TEST_ASSERT_EQUAL_DOUBLE(0, derived_inside(&b, "total_1"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_week_of_pulses_is_counted_to_the_pulse);
    RUN_TEST(pulses_count_on_while_nobody_reads_them);
    RUN_TEST(a_counter_that_was_put_back_leaves_a_gap);
    RUN_TEST(a_counter_with_another_factor_begins_without_a_total);
    RUN_TEST(a_counter_behind_an_absence_is_another_one);
    RUN_TEST(a_week_of_a_small_flow_is_counted_in_full);
    RUN_TEST(a_small_flow_counts_on_top_of_a_large_volume_at_short_ticks);
    RUN_TEST(a_week_of_random_flow_is_the_sum_in_double);
    RUN_TEST(a_lost_sample_costs_no_volume);
    RUN_TEST(flow_that_nobody_measured_is_bad_meanwhile_and_bridged_if_short);
    RUN_TEST(a_longer_stretch_is_left_out_and_said_until_the_next_reset);
    RUN_TEST(after_an_absence_of_the_plant_the_total_stays_and_is_uncertain);
    RUN_TEST(plant_time_that_goes_back_is_an_absence);
    RUN_TEST(ticks_longer_than_the_bridge_are_no_gaps);
    RUN_TEST(a_total_is_bad_until_somebody_says_where_it_begins);
    RUN_TEST(settings_without_a_past_begin_without_a_total);
    RUN_TEST(another_unit_of_time_or_factor_keeps_the_volume);
    RUN_TEST(a_channel_that_becomes_another_form_loses_its_total);
    RUN_TEST(a_reset_takes_one_total_or_all_and_refuses_what_is_none);
    RUN_TEST(flows_below_the_cut_do_not_count);
    RUN_TEST(the_rate_of_a_counter_is_its_flow_also_where_it_begins_anew);
    RUN_TEST(pulses_that_came_while_readings_were_bad_are_spread_over_that_time);
    RUN_TEST(a_rate_begins_anew_after_an_absence);
    RUN_TEST(a_rate_behind_a_lag_has_its_time_constant);
    return UNITY_END();
}
