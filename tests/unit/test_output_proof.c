/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* Outputs are proved by what their channels do: faults within their bounds, and nothing of an output that is well. */
#include <stdio.h>
#include <string.h>

#include "io/output_proof.h"
#include "unity.h"

#define TICK_MS 1000u
#define HOUR_S  3600u

static struct output_proof proof;
static struct proof_config heater, pump;
static struct output_proof_look look;
static enum output_proof_fault fault; /* of the last sample */
static unsigned waited_s;             /* until the last change that was waited for */

void setUp(void)
{
    memset(&proof, 0, sizeof proof);
    heater = (struct proof_config){.change = 5.0f,
                                   .on_s = 300,
                                   .off_s = 1800,
                                   .limit = 75,
                                   .kind = PROOF_KIND_WARMS,
                                   .device = 1};
    pump = (struct proof_config){
        .change = 0.5f, .on_s = 30, .off_s = 60, .kind = PROOF_KIND_FLOWS, .device = 1};
    look = (struct output_proof_look){.reading = 20.0f, .usable = true, .since_ms = TICK_MS};
    fault = PROOF_FINE;
}

void tearDown(void) {}

/* Passes so many seconds in which the reading changes evenly by `by`; ends early where what is known changes. */
static void pass(const struct proof_config *c, unsigned seconds, float by)
{
    enum output_proof_fault before = fault;
    float begin = look.reading;
    for (waited_s = 1; waited_s <= seconds; waited_s++) {
        look.reading = begin + by * (float)waited_s / (float)seconds;
        fault = output_proof_step(&proof, c, &look);
        if (fault != before)
            return;
    }
}

static void told_within(enum output_proof_fault wanted, unsigned seconds)
{
    TEST_ASSERT_EQUAL_INT(wanted, fault);
    TEST_ASSERT_LESS_OR_EQUAL_UINT(seconds + 1u, waited_s);
}

/* ---- heater ---- */

static void a_heater_that_is_on_and_warms_nothing_is_dead(void)
{
    look.part = 0.8f;
    pass(&heater, HOUR_S, -3.0f);
    told_within(PROOF_NO_HEAT, heater.on_s);
}

static void the_longest_window_ends_with_the_slowest_tick(void)
{
    heater.on_s = UINT16_MAX;
    look.part = 1.0f;
    look.since_ms = HOUR_S * 1000u;
    pass(&heater, 40, 0.0f); /* ticks */
    told_within(PROOF_NO_HEAT, 1u + UINT16_MAX / HOUR_S);
}

static void a_dead_heater_that_warms_again_is_fine(void)
{
    look.part = 1.0f;
    pass(&heater, HOUR_S, 0.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_NO_HEAT, fault);
    pass(&heater, 600, 20.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
}

static void a_dead_heater_is_fine_when_its_liquid_has_come_well_above_the_limit(void)
{
    look.part = 1.0f;
    pass(&heater, HOUR_S, 0.0f);
    look.part = 0.0f;
    look.reading = 79.0f;
    pass(&heater, 60, -1.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_NO_HEAT, fault);
    look.reading = 80.5f;
    pass(&heater, 60, -0.1f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
}

static void a_heater_is_not_dead_because_its_liquid_boils(void)
{
    look.part = 1.0f;
    look.reading = 78.3f;
    pass(&heater, 1000u * HOUR_S, 0.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
}

static void a_heater_that_dies_at_the_boil_is_told_once_its_liquid_is_cooler(void)
{
    look.part = 1.0f;
    look.reading = 78.3f;
    pass(&heater, 600, -4.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
    pass(&heater, HOUR_S, -10.0f);
    told_within(PROOF_NO_HEAT, heater.on_s);
}

static void a_heater_that_holds_a_temperature_with_part_of_its_power_is_not_dead(void)
{
    look.part = 0.6f;
    look.reading = 60.0f;
    pass(&heater, 1000u * HOUR_S, 0.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
}

static void cold_liquid_that_comes_in_is_no_dead_heater(void)
{
    look.part = 1.0f;
    look.reading = 60.0f;
    pass(&heater, 240, -25.0f);
    pass(&heater, 299, 15.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
}

static void a_heater_that_warms_although_it_is_off_is_stuck(void)
{
    pass(&heater, 7u * 24u * HOUR_S, 2.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
    pass(&heater, HOUR_S, 60.0f);
    told_within(PROOF_WARMS, 3u * heater.on_s);
}

static void a_dead_heater_whose_relay_then_shorts_is_stuck_for_the_first_time(void)
{
    look.part = 1.0f;
    pass(&heater, HOUR_S, 0.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_NO_HEAT, fault);
    look.part = 0.0f;
    pass(&heater, 1800, 50.0f);
    told_within(PROOF_WARMS, 3u * heater.on_s);
}

static void a_heater_that_warms_to_the_limit_although_it_is_off_is_stuck_there(void)
{
    pass(&heater, 2u * heater.on_s, 0.0f);
    pass(&heater, heater.on_s + heater.on_s / 4u, 54.9f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
    pass(&heater, 10, 1.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_WARMS, fault);
}

static void warm_liquor_that_is_poured_in_is_no_stuck_heater(void)
{
    for (unsigned n = 0; n < 100; n++) {
        pass(&heater, HOUR_S + 7u * n, 0.0f);
        pass(&heater, heater.on_s / 2u, 60.0f);
        TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
        pass(&heater, 3u * HOUR_S, -60.0f);
    }
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
}

static void warm_feed_that_another_output_brings_is_no_stuck_heater(void)
{
    pass(&heater, HOUR_S, 0.0f);
    look.elsewhere = 0.3f;
    pass(&heater, HOUR_S, 54.0f);
    look.elsewhere = 0.0f;
    pass(&heater, heater.on_s - 5u, 0.9f);
    pass(&heater, HOUR_S, -20.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
}

static void heat_that_was_stored_makes_no_stuck_heater(void)
{
    look.part = 1.0f;
    pass(&heater, 600, 30.0f);
    look.part = 0.0f;
    pass(&heater, heater.on_s - 10u, 6.0f);
    pass(&heater, 10u * HOUR_S, -30.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
}

/* A pot of 50 degC/kW with 2 kW and a time of 3000 s, in a mantle or with a thermowell that adds a lag. */
struct late_heat {
    unsigned lag_s, on_s;
    float change;
};

static const struct late_heat late_heat[] = {
    {200, 146, 0.3f}, {300, 218, 0.3f}, {400, 249, 0.4f}, {400, 201, 0.4f}};

/* Seconds after it was switched off at which something is told; hours without: 0. */
static unsigned told_after_heating(const struct late_heat *l, unsigned heated_s, bool shorted)
{
    double mantle = 0.0, pot = 0.0;
    setUp();
    heater.on_s = (uint16_t)l->on_s;
    heater.change = l->change;
    for (unsigned s = 1; s <= heated_s + 4u * HOUR_S; s++) {
        bool off = s > heated_s;
        mantle += ((off && !shorted ? 0.0 : 100.0) - mantle) / 3000.0;
        pot += (mantle - pot) / l->lag_s;
        look.part = off ? 0.0f : 1.0f;
        look.reading = 20.0f + (float)pot;
        if (output_proof_step(&proof, &heater, &look) != PROOF_FINE && off)
            return s - heated_s;
    }
    return 0;
}

static void heat_that_comes_late_makes_no_stuck_heater(void)
{
    for (unsigned i = 0; i < sizeof late_heat / sizeof *late_heat; i++) {
        TEST_ASSERT_EQUAL_UINT(0, told_after_heating(&late_heat[i], 300, false));
        TEST_ASSERT_EQUAL_UINT(0, told_after_heating(&late_heat[i], 600, false));
    }
}

static void a_relay_that_welds_is_told_where_heat_comes_late_too(void)
{
    for (unsigned i = 0; i < sizeof late_heat / sizeof *late_heat; i++) {
        unsigned after_s = told_after_heating(&late_heat[i], 300, true);
        TEST_ASSERT_TRUE(after_s > 0 && after_s <= 3u * late_heat[i].on_s + 2u);
    }
}

static void a_heater_that_boils_although_it_is_off_is_stuck(void)
{
    look.part = 0.4f;
    look.reading = 99.0f;
    pass(&heater, HOUR_S, 0.0f);
    look.part = 0.0f;
    pass(&heater, HOUR_S, 0.0f);
    told_within(PROOF_NOT_COOLING, heater.off_s);
}

static void a_hot_heater_that_is_off_and_cools_is_fine(void)
{
    look.reading = 99.0f;
    pass(&heater, 2u * HOUR_S, -24.5f);
    pass(&heater, 100u * HOUR_S, -50.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
}

static void a_heater_that_was_stuck_stays_so(void)
{
    look.reading = 99.0f;
    pass(&heater, HOUR_S, 0.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_NOT_COOLING, fault);
    pass(&heater, 2u * HOUR_S, -25.0f);
    pass(&heater, 100u * HOUR_S, -54.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_NOT_COOLING, fault);
    look.part = 1.0f;
    pass(&heater, HOUR_S, 60.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_NOT_COOLING, fault);
}

static void heat_that_goes_on_with_the_heaters_disabled_is_told_too(void)
{
    look.reading = 99.0f;
    pass(&heater, HOUR_S, 0.0f);
    pass(&heater, HOUR_S, 0.0f);
    told_within(PROOF_STILL_HOT, heater.off_s);
    setUp();
    pass(&heater, HOUR_S, 60.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_WARMS, fault);
    pass(&heater, HOUR_S, 60.0f);
    told_within(PROOF_STILL_HOT, 3u * heater.on_s);
}

static void another_heater_of_the_same_liquid_may_warm_it(void)
{
    look.others = 0.5f;
    pass(&heater, HOUR_S, 50.0f);
    look.reading = 90.0f;
    pass(&heater, 10u * HOUR_S, 0.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
}

static void nothing_is_said_without_a_reading(void)
{
    look.part = 1.0f;
    pass(&heater, heater.on_s - 10u, 0.0f);
    look.usable = false;
    pass(&heater, 10u * HOUR_S, 0.0f);
    look.usable = true;
    pass(&heater, heater.on_s - 10u, 0.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
    pass(&heater, 20, 0.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_NO_HEAT, fault);
}

static void a_reading_that_is_no_number_is_none(void)
{
    look.part = 1.0f;
    look.reading = __builtin_nanf("");
    pass(&heater, 10u * HOUR_S, 0.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
}

static void a_time_of_0_leaves_its_part_out(void)
{
    heater.on_s = 0;
    pass(&heater, 10u * HOUR_S, 50.0f);
    look.part = 1.0f;
    pass(&heater, 10u * HOUR_S, 0.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
    heater.on_s = 300;
    heater.off_s = 0;
    look.part = 0.0f;
    look.reading = 99.0f;
    pass(&heater, 100u * HOUR_S, 0.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
}

static void days_that_warm_a_resting_column_are_no_stuck_heater(void)
{
    for (unsigned day = 0; day < 50; day++) {
        pass(&heater, 6u * HOUR_S, 18.0f);
        pass(&heater, 18u * HOUR_S, -18.0f);
    }
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
}

/* ---- pump or valve ---- */

static void a_flow_without_its_pump_is_told(void)
{
    look.reading = 0.0f;
    pass(&pump, HOUR_S, 0.0f);
    look.reading = 0.8f;
    pass(&pump, HOUR_S, 0.0f);
    told_within(PROOF_FLOWS, 2u * pump.off_s);
    look.reading = 0.0f;
    pass(&pump, HOUR_S, 0.0f);
    told_within(PROOF_FINE, 2u * pump.off_s);
}

static void a_flow_that_runs_out_after_its_pump_is_none(void)
{
    look.part = 1.0f;
    look.reading = 8.0f;
    pass(&pump, HOUR_S, 0.0f);
    look.part = 0.0f;
    pass(&pump, pump.off_s - 1u, -8.0f);
    pass(&pump, 10u * HOUR_S, 0.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
}

static void drops_are_counted_over_the_window(void)
{
    for (unsigned n = 0; n < 3u * pump.off_s && fault == PROOF_FINE; n++) {
        look.reading = n % 3u == 0 ? 1.9f : 0.0f; /* 0.63 on the average */
        fault = output_proof_step(&proof, &pump, &look);
    }
    TEST_ASSERT_EQUAL_INT(PROOF_FLOWS, fault);
}

static void a_spike_is_no_flow(void)
{
    for (unsigned n = 0; n < 100u * HOUR_S; n++) {
        look.reading = n % 20u == 0 ? 1000.0f : 0.0f;
        fault = output_proof_step(&proof, &pump, &look);
        TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
    }
}

static void a_pump_that_is_on_and_moves_nothing_is_told(void)
{
    look.part = 1.0f;
    look.reading = 0.1f;
    pass(&pump, HOUR_S, 0.0f);
    told_within(PROOF_NO_FLOW, 2u * pump.on_s);
    look.reading = 5.0f;
    pass(&pump, HOUR_S, 0.0f);
    told_within(PROOF_FINE, 2u * pump.on_s);
}

/* Five ticks of 7 s, 5 s more than the window. */
static void a_flow_is_a_mean_over_the_ticks_that_a_window_really_has(void)
{
    look.part = 1.0f;
    look.since_ms = 7000;
    look.reading = 0.9f * pump.change;
    pass(&pump, 12, 0.0f); /* ticks */
    TEST_ASSERT_EQUAL_INT(PROOF_NO_FLOW, fault);
}

static void a_valve_that_is_partly_open_may_do_as_it_likes(void)
{
    look.part = 0.3f;
    for (unsigned n = 0; n < 4; n++) {
        look.reading = n % 2u ? 0.0f : 9.0f;
        pass(&pump, 10u * HOUR_S, 0.0f);
        TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
    }
}

static void an_output_without_proof_is_not_watched(void)
{
    pump.kind = PROOF_KIND_NONE;
    look.reading = 9.0f;
    pass(&pump, 10u * HOUR_S, 0.0f);
    TEST_ASSERT_EQUAL_INT(PROOF_FINE, fault);
}

static void each_fault_has_words_of_its_own(void)
{
    for (unsigned i = PROOF_FINE + 1u; i < PROOF_FAULTS; i++)
        for (unsigned k = PROOF_FINE; k < i; k++)
            TEST_ASSERT_TRUE(strcmp(output_proof_text((uint8_t)i), output_proof_text((uint8_t)k)));
    TEST_ASSERT_EQUAL_STRING("?", output_proof_text(PROOF_FAULTS));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_heater_that_is_on_and_warms_nothing_is_dead);
    RUN_TEST(the_longest_window_ends_with_the_slowest_tick);
    RUN_TEST(a_dead_heater_that_warms_again_is_fine);
    RUN_TEST(a_dead_heater_is_fine_when_its_liquid_has_come_well_above_the_limit);
    RUN_TEST(a_heater_is_not_dead_because_its_liquid_boils);
    RUN_TEST(a_heater_that_dies_at_the_boil_is_told_once_its_liquid_is_cooler);
    RUN_TEST(a_heater_that_holds_a_temperature_with_part_of_its_power_is_not_dead);
    RUN_TEST(cold_liquid_that_comes_in_is_no_dead_heater);
    RUN_TEST(a_heater_that_warms_although_it_is_off_is_stuck);
    RUN_TEST(a_dead_heater_whose_relay_then_shorts_is_stuck_for_the_first_time);
    RUN_TEST(a_heater_that_warms_to_the_limit_although_it_is_off_is_stuck_there);
    RUN_TEST(warm_liquor_that_is_poured_in_is_no_stuck_heater);
    RUN_TEST(warm_feed_that_another_output_brings_is_no_stuck_heater);
    RUN_TEST(heat_that_was_stored_makes_no_stuck_heater);
    RUN_TEST(heat_that_comes_late_makes_no_stuck_heater);
    RUN_TEST(a_relay_that_welds_is_told_where_heat_comes_late_too);
    RUN_TEST(a_heater_that_boils_although_it_is_off_is_stuck);
    RUN_TEST(a_hot_heater_that_is_off_and_cools_is_fine);
    RUN_TEST(a_heater_that_was_stuck_stays_so);
    RUN_TEST(heat_that_goes_on_with_the_heaters_disabled_is_told_too);
    RUN_TEST(another_heater_of_the_same_liquid_may_warm_it);
    RUN_TEST(nothing_is_said_without_a_reading);
    RUN_TEST(a_reading_that_is_no_number_is_none);
    RUN_TEST(a_time_of_0_leaves_its_part_out);
    RUN_TEST(days_that_warm_a_resting_column_are_no_stuck_heater);
    RUN_TEST(a_flow_without_its_pump_is_told);
    RUN_TEST(a_flow_that_runs_out_after_its_pump_is_none);
    RUN_TEST(drops_are_counted_over_the_window);
    RUN_TEST(a_spike_is_no_flow);
    RUN_TEST(a_pump_that_is_on_and_moves_nothing_is_told);
    RUN_TEST(a_flow_is_a_mean_over_the_ticks_that_a_window_really_has);
    RUN_TEST(a_valve_that_is_partly_open_may_do_as_it_likes);
    RUN_TEST(an_output_without_proof_is_not_watched);
    RUN_TEST(each_fault_has_words_of_its_own);
    return UNITY_END();
}
