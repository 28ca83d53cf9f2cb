/* The dead man: what each kind of output does when commands stop, at every phase of it, and when everything is to be safe.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs_bench.h"
#include "unity.h"

static struct output_settings settings;
static hal_pin pin;

/* Outputs that are off in their safe position. */
static const enum output_type switches[] = {OUTPUT_WINDOW, OUTPUT_BURST, OUTPUT_RELAY, OUTPUT_PWM,
                                            OUTPUT_STEPPER};
#define SWITCHES (sizeof switches / sizeof *switches)

void setUp(void) {}
void tearDown(void)
{
    bench_tell_seed();
}

/* A period, a group, an analogue output or a valve within a few hundred milliseconds. */
static void begin(enum output_type type, float dead_man)
{
    bench_begin();
    settings = bench_settings(type, 0);
    settings.dead_man = dead_man;
    settings.period = 0.2f;
    settings.flow = 2.0f;
    settings.ramp = 10000.0f;
    settings.travel = 1.0f;
    settings.pause = 0.05f;
    settings.pin[OUTPUT_OPEN_END] = settings.pin[OUTPUT_CLOSED_END] = HAL_PIN_NONE;
    pin = settings.pin[OUTPUT_PIN];
    bench_open(&settings, 1);
}

static void command(double fraction, unsigned ms)
{
    for (unsigned k = 0; k < ms; k++) {
        outputs_command(0, true, (float)fraction);
        bench_turn();
    }
}

static void silence(unsigned ms)
{
    for (unsigned k = 0; k < ms; k++)
        bench_turn();
}

static bool is_on(void)
{
    return bench_pins[pin].pwm ? bench_pins[pin].part > 0 : bench_on(pin);
}

/* Turns with the output on, among so many without a command. */
static unsigned on_in_silence(unsigned ms)
{
    unsigned on = 0;
    for (unsigned k = 0; k < ms; k++) {
        bench_turn();
        on += is_on();
    }
    return on;
}

static void commands_that_stop_at_any_phase_switch_each_kind_off_in_time(void)
{
    for (unsigned k = 0; k < SWITCHES; k++)
        for (unsigned phase = 0; phase < 260; phase++) {
            begin(switches[k], 0.5f);
            command(0.7, 300 + phase);
            TEST_ASSERT_TRUE(on_in_silence(499) > 0);
            TEST_ASSERT_EQUAL(OUTPUT_COMMANDED, outputs_rule(0));
            TEST_ASSERT_EQUAL(0, on_in_silence(3000));
            TEST_ASSERT_EQUAL(OUTPUT_DEAD_MAN, outputs_rule(0));
        }
}

static void the_time_is_as_set_and_at_most_two_seconds(void)
{
    static const float time[] = {0.5f, 0.75f, 2.0f};
    for (unsigned k = 0; k < 3; k++) {
        begin(OUTPUT_PWM, time[k]);
        command(0.7, 300);
        TEST_ASSERT_EQUAL(output_ms(time[k]) - 1u, on_in_silence(5000));
    }
}

static void the_same_command_again_holds_it_off(void)
{
    begin(OUTPUT_PWM, 0.5f);
    for (unsigned k = 0; k < 100; k++) {
        command(0.7, 1);
        TEST_ASSERT_EQUAL(499, on_in_silence(499));
    }
}

static void it_does_not_wait_for_the_least_time_on_but_keeps_the_least_time_off(void)
{
    begin(OUTPUT_RELAY, 0.5f);
    settings.least_on = 60.0f;
    settings.least_off = 7.0f;
    bench_open(&settings, 1);
    command(1.0, 7000);
    TEST_ASSERT_TRUE(is_on());
    silence(500);
    TEST_ASSERT_FALSE(is_on());
    command(1.0, 6999);
    TEST_ASSERT_FALSE(is_on());
    command(1.0, 1);
    TEST_ASSERT_TRUE(is_on());
}

static void the_next_command_ends_it_and_nothing_is_made_up_for(void)
{
    begin(OUTPUT_WINDOW, 0.5f);
    command(1.0, 1000);
    silence(10000);
    unsigned on = 0;
    for (unsigned k = 0; k < 10000; k++) {
        command(0.25, 1);
        on += is_on();
    }
    TEST_ASSERT_INT_WITHIN(50, 2500, on);
}

/* A pulse of 5 s is cut short with 1.25 s too much given; the next one is whole. */
static void what_was_carried_over_before_is_forgotten(void)
{
    begin(OUTPUT_WINDOW, 0.5f);
    settings.period = 10.0f;
    bench_open(&settings, 1);
    command(0.5, 2000);
    silence(1000);
    TEST_ASSERT_FALSE(is_on());
    unsigned on = 0;
    for (unsigned k = 0; k < 9000; k++) {
        command(0.5, 1);
        on += is_on();
    }
    TEST_ASSERT_INT_WITHIN(1, 5000, on);
}

static void a_burst_that_was_cut_short_owes_nothing(void)
{
    begin(OUTPUT_BURST, 0.5f);
    settings.cycles = 25.0f;
    bench_open(&settings, 1);
    command(0.9, 900); /* part of a group of 500 ms */
    silence(1000);
    command(0.2, 500);
    TEST_ASSERT_FALSE(is_on()); /* less than half a group is owed */
    command(0.2, 500);
    TEST_ASSERT_TRUE(is_on());
}

/* 400 steps are owed after 4 s of the ramp. */
static void a_stepper_that_was_stopped_on_its_ramp_owes_nothing(void)
{
    begin(OUTPUT_STEPPER, 0.5f);
    settings.flow = 7.2f; /* 200 steps a second */
    settings.ramp = 50.0f;
    bench_open(&settings, 1);
    command(1.0, 4000);
    silence(3000);
    unsigned steps = 0;
    for (unsigned k = 0; k < 30000; k++) {
        command(0.1, 1);
        steps += is_on();
    }
    TEST_ASSERT_INT_WITHIN(2, 600, steps);
}

static void before_the_first_command_every_kind_is_off(void)
{
    for (unsigned k = 0; k < SWITCHES; k++) {
        begin(switches[k], 2.0f);
        TEST_ASSERT_EQUAL(0, on_in_silence(1000));
    }
}

static void a_motor_valve_is_on_its_way_to_its_safe_place_in_time_at_any_phase(void)
{
    for (unsigned phase = 0; phase < 1200; phase += 7) {
        begin(OUTPUT_MOTOR_VALVE, 0.5f);
        settings.safe = 1.0f;
        bench_open(&settings, 1);
        command(0.0, 3000);
        command(0.3, 1300); /* no longer at an end */
        command(phase % 2 ? 0.8 : 0.05, phase);
        silence(500);
        TEST_ASSERT_EQUAL(OUTPUT_DEAD_MAN, outputs_rule(0));
        silence(51);
        TEST_ASSERT_TRUE(bench_on(pin));
        TEST_ASSERT_FALSE(bench_on(settings.pin[OUTPUT_SECOND_PIN]));
        silence(1200);
        TEST_ASSERT_FALSE(bench_on(pin));
        (void)outputs_readback(0);
        silence(10);
        TEST_ASSERT_EQUAL_FLOAT(1.0f, outputs_readback(0));
    }
}

static void an_analogue_output_goes_to_its_safe_position(void)
{
    begin(OUTPUT_ANALOG, 0.5f);
    settings.safe = 0.75f;
    bench_open(&settings, 1);
    command(0.1, 1000);
    silence(500);
    TEST_ASSERT_UINT16_WITHIN(2, (uint16_t)(0.75 * HAL_PWM_FULL), bench_pins[pin].part);
}

static void an_output_that_nobody_drives_is_off_at_once(void)
{
    for (unsigned k = 0; k < SWITCHES; k++) {
        begin(switches[k], 2.0f);
        command(1.0, 500);
        for (unsigned ms = 0; ms < 3000; ms++) {
            outputs_command(0, false, 1.0f);
            bench_turn();
            TEST_ASSERT_FALSE(is_on());
        }
        TEST_ASSERT_EQUAL(OUTPUT_NO_DRIVER, outputs_rule(0));
    }
}

static void a_clock_that_comes_back_after_the_time_switches_off_in_its_first_turn(void)
{
    for (unsigned k = 0; k < SWITCHES; k++) {
        begin(switches[k], 2.0f);
        command(1.0, 500);
        bench_turn_after(2000);
        TEST_ASSERT_FALSE(is_on());
        command(1.0, 500);
        bench_turn_after(0x80000000u);
        TEST_ASSERT_FALSE(is_on());
    }
}

/* Each kind, made safe at any phase. */
static void safe_switches_everything_off_at_once_until_it_is_resumed(void)
{
    static const enum output_type every[] = {OUTPUT_WINDOW,     OUTPUT_BURST,   OUTPUT_RELAY,
                                             OUTPUT_PWM,        OUTPUT_STEPPER, OUTPUT_ANALOG,
                                             OUTPUT_MOTOR_VALVE};
    for (unsigned k = 0; k < sizeof every / sizeof *every; k++)
        for (unsigned phase = 0; phase < 210; phase += 3) {
            begin(every[k], 2.0f);
            settings.safe = 1.0f;
            bench_open(&settings, 1);
            command(0.7, 300 + phase);
            outputs_safe();
            TEST_ASSERT_FALSE(is_on());
            for (unsigned ms = 0; ms < 3000; ms++) {
                command(0.7, 1);
                TEST_ASSERT_FALSE(is_on());
                TEST_ASSERT_FALSE(settings.pin[OUTPUT_SECOND_PIN] != HAL_PIN_NONE &&
                                  bench_on(settings.pin[OUTPUT_SECOND_PIN]));
            }
            TEST_ASSERT_EQUAL(OUTPUT_SAFE, outputs_rule(0));
            outputs_resume();
            bool was_on = false;
            for (unsigned ms = 0; ms < 1000; ms++) {
                command(1.0, 1);
                was_on = was_on || is_on();
            }
            TEST_ASSERT_TRUE(was_on);
        }
}

/* An erase of the flash holds the clock off. */
static void an_erase_without_a_turn_of_the_clock_is_off_time(void)
{
    static const enum output_type time[] = {OUTPUT_WINDOW, OUTPUT_BURST, OUTPUT_RELAY, OUTPUT_PWM,
                                            OUTPUT_ANALOG};
    for (unsigned k = 0; k < sizeof time / sizeof *time; k++) {
        begin(time[k], 2.0f);
        command(1.0, 1000);
        TEST_ASSERT_TRUE(is_on());
        (void)outputs_readback(0);
        outputs_safe();
        outputs_resume();
        bench_turn_after(1000);
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.001f, outputs_readback(0));
        TEST_ASSERT_FALSE(is_on());
        command(1.0, 500);
        TEST_ASSERT_TRUE(is_on());
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(commands_that_stop_at_any_phase_switch_each_kind_off_in_time);
    RUN_TEST(the_time_is_as_set_and_at_most_two_seconds);
    RUN_TEST(the_same_command_again_holds_it_off);
    RUN_TEST(it_does_not_wait_for_the_least_time_on_but_keeps_the_least_time_off);
    RUN_TEST(the_next_command_ends_it_and_nothing_is_made_up_for);
    RUN_TEST(what_was_carried_over_before_is_forgotten);
    RUN_TEST(a_burst_that_was_cut_short_owes_nothing);
    RUN_TEST(a_stepper_that_was_stopped_on_its_ramp_owes_nothing);
    RUN_TEST(before_the_first_command_every_kind_is_off);
    RUN_TEST(a_motor_valve_is_on_its_way_to_its_safe_place_in_time_at_any_phase);
    RUN_TEST(an_analogue_output_goes_to_its_safe_position);
    RUN_TEST(an_output_that_nobody_drives_is_off_at_once);
    RUN_TEST(a_clock_that_comes_back_after_the_time_switches_off_in_its_first_turn);
    RUN_TEST(safe_switches_everything_off_at_once_until_it_is_resumed);
    RUN_TEST(an_erase_without_a_turn_of_the_clock_is_off_time);
    return UNITY_END();
}
