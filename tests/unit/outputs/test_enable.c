/* The enable output: on only while clock, tick and main loop turn and no heater is stuck on. A clock that hangs for good cannot be tried here,
 * because nothing runs then: the watchdog of the board resets the chip, and pull resistors hold the pins off.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs_bench.h"
#include "unity.h"

#define LEAST_OFF_MS 5000u

static struct output_settings settings[3]; /* a heater, the enable output, a pump */
static hal_pin heater, enable, pump;

void setUp(void)
{
    bench_begin();
    settings[0] = bench_settings(OUTPUT_PWM, 0);
    settings[0].heater = true;
    settings[1] = bench_settings(OUTPUT_ENABLE, 1);
    settings[2] = bench_settings(OUTPUT_PWM, 2);
    heater = settings[0].pin[OUTPUT_PIN];
    enable = settings[1].pin[OUTPUT_PIN];
    pump = settings[2].pin[OUTPUT_PIN];
    bench_open(settings, 3);
}
void tearDown(void)
{
    bench_tell_seed();
}

static void turns(unsigned ms, bool tick, bool main_loop)
{
    for (unsigned k = 0; k < ms; k++) {
        if (tick)
            outputs_report(OUTPUTS_TICK);
        if (main_loop)
            outputs_report(OUTPUTS_MAIN_LOOP);
        outputs_command(0, true, 0.5f);
        outputs_command(2, true, 0.5f);
        bench_turn();
        /* No heater without the contactor. */
        TEST_ASSERT_FALSE(bench_pins[heater].part > 0 && !bench_on(enable));
    }
}

static void is_on(void)
{
    turns(LEAST_OFF_MS + 2, true, true);
    TEST_ASSERT_TRUE(bench_on(enable));
    TEST_ASSERT_TRUE(bench_pins[heater].part > 0);
}

static void is_off(void)
{
    TEST_ASSERT_FALSE(bench_on(enable));
    TEST_ASSERT_EQUAL(0, bench_pins[heater].part);
    TEST_ASSERT_EQUAL(OUTPUT_NO_ENABLE, outputs_rule(0));
}

static void it_comes_on_after_its_least_time_off_when_all_have_reported(void)
{
    turns(LEAST_OFF_MS - 1, true, true);
    is_off();
    turns(1, true, true);
    TEST_ASSERT_TRUE(bench_on(enable));
    turns(1, true, true);
    TEST_ASSERT_TRUE(bench_pins[heater].part > 0);
}

static void it_stays_off_as_long_as_one_of_them_has_never_reported(void)
{
    turns(20000, true, false);
    is_off();
    turns(1, true, true);
    TEST_ASSERT_TRUE(bench_on(enable));
    bench_open(settings, 3);
    turns(20000, false, true);
    is_off();
}

static void a_tick_that_hangs_drops_it_within_a_second(void)
{
    is_on();
    turns(999, false, true);
    TEST_ASSERT_TRUE(bench_on(enable));
    turns(1, false, true);
    is_off();
}

static void a_main_loop_that_hangs_drops_it_within_a_second(void)
{
    is_on();
    turns(999, true, false);
    TEST_ASSERT_TRUE(bench_on(enable));
    turns(1, true, false);
    is_off();
}

/* A safe position that is not off is that of a loop, not that of a heater without its contactor. */
static void a_heater_with_a_safe_position_is_off_without_the_contactor_too(void)
{
    settings[0] = bench_settings(OUTPUT_ANALOG, 0);
    settings[0].heater = true;
    settings[0].safe = 0.5f;
    bench_open(settings, 3);
    is_on();
    turns(2000, false, true);
    is_off();
}

static void both_hanging_drop_it_within_a_second_and_the_pump_goes_on_until_its_dead_man(void)
{
    is_on();
    for (unsigned k = 0; k < 1000; k++)
        bench_turn();
    is_off();
    TEST_ASSERT_TRUE(bench_pins[pump].part > 0);
    for (unsigned k = 0; k < 1000; k++)
        bench_turn();
    TEST_ASSERT_EQUAL(0, bench_pins[pump].part);
}

static void reports_just_in_time_keep_it_on(void)
{
    is_on();
    for (unsigned k = 0; k < 50; k++) {
        turns(1, true, true);
        turns(999, false, false);
        TEST_ASSERT_TRUE(bench_on(enable));
    }
}

static void a_clock_that_stood_for_more_than_a_second_drops_it_in_its_first_turn(void)
{
    is_on();
    outputs_report(OUTPUTS_TICK);
    outputs_report(OUTPUTS_MAIN_LOOP);
    bench_turn_after(1000);
    TEST_ASSERT_TRUE(bench_on(enable));
    outputs_report(OUTPUTS_TICK);
    outputs_report(OUTPUTS_MAIN_LOOP);
    bench_turn_after(1001);
    TEST_ASSERT_FALSE(bench_on(enable));
}

static void a_heater_that_is_stuck_on_drops_it_until_it_is_no_longer(void)
{
    is_on();
    outputs_stuck(2, true);
    outputs_stuck(0, true);
    turns(1, true, true);
    is_off();
    outputs_stuck(0, false);
    turns(3 * LEAST_OFF_MS, true, true);
    is_off();
    outputs_stuck(2, false);
    turns(1, true, true);
    TEST_ASSERT_TRUE(bench_on(enable));
}

static void reasons_that_come_and_go_do_not_make_it_chatter(void)
{
    is_on();
    struct random_source source = bench_random(3);
    bool was_on = true;
    unsigned off = 0, drops = 0;
    for (unsigned k = 0; k < 300000; k++) {
        if (random_below(&source, 20) == 0)
            outputs_stuck(0, random_below(&source, 2));
        turns(1, true, true);
        bool on = bench_on(enable);
        if (on && !was_on)
            TEST_ASSERT_GREATER_OR_EQUAL(LEAST_OFF_MS, off);
        drops += was_on && !on;
        off = on ? 0 : off + 1;
        was_on = on;
    }
    TEST_ASSERT_GREATER_THAN(20, drops);
}

static void without_an_enable_output_a_heater_needs_none(void)
{
    bench_open(settings, 1);
    outputs_command(0, true, 0.5f);
    bench_turn();
    TEST_ASSERT_TRUE(bench_pins[heater].part > 0);
}

static void a_heater_reads_back_nothing_while_it_is_off(void)
{
    is_on();
    (void)outputs_readback(0);
    turns(100, true, true);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, outputs_readback(0));
    outputs_stuck(0, true);
    turns(1, true, true);
    (void)outputs_readback(0);
    (void)outputs_readback(1);
    turns(100, true, true);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, outputs_readback(0));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, outputs_readback(1));
}

static void safe_drops_it_and_it_keeps_its_least_time_off(void)
{
    is_on();
    outputs_safe();
    TEST_ASSERT_FALSE(bench_on(enable));
    outputs_resume();
    turns(LEAST_OFF_MS, true, true);
    TEST_ASSERT_FALSE(bench_on(enable));
    turns(1, true, true);
    TEST_ASSERT_TRUE(bench_on(enable));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_comes_on_after_its_least_time_off_when_all_have_reported);
    RUN_TEST(it_stays_off_as_long_as_one_of_them_has_never_reported);
    RUN_TEST(a_tick_that_hangs_drops_it_within_a_second);
    RUN_TEST(a_main_loop_that_hangs_drops_it_within_a_second);
    RUN_TEST(a_heater_with_a_safe_position_is_off_without_the_contactor_too);
    RUN_TEST(both_hanging_drop_it_within_a_second_and_the_pump_goes_on_until_its_dead_man);
    RUN_TEST(reports_just_in_time_keep_it_on);
    RUN_TEST(a_clock_that_stood_for_more_than_a_second_drops_it_in_its_first_turn);
    RUN_TEST(a_heater_that_is_stuck_on_drops_it_until_it_is_no_longer);
    RUN_TEST(reasons_that_come_and_go_do_not_make_it_chatter);
    RUN_TEST(without_an_enable_output_a_heater_needs_none);
    RUN_TEST(a_heater_reads_back_nothing_while_it_is_off);
    RUN_TEST(safe_drops_it_and_it_keeps_its_least_time_off);
    return UNITY_END();
}
