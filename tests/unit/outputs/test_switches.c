/* Relays, pulse widths and analogue outputs.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs_bench.h"
#include "unity.h"

static struct output_settings settings;
static hal_pin pin;

void setUp(void)
{
    bench_begin();
}
void tearDown(void)
{
    bench_tell_seed();
}

static void begin(struct output_settings s)
{
    settings = s;
    pin = s.pin[OUTPUT_PIN];
    bench_open(&settings, 1);
}

static void run(double command, unsigned ms)
{
    for (unsigned k = 0; k < ms; k++) {
        outputs_command(0, true, (float)command);
        bench_turn();
    }
}

static void a_relay_switches_at_the_edges_of_its_hysteresis(void)
{
    settings = bench_settings(OUTPUT_RELAY, 0);
    settings.hysteresis = 0.2f;
    settings.least_on = settings.least_off = 0.0f;
    begin(settings);
    static const struct {
        double command;
        bool on;
    } row[] = {{0.0, false},  {0.59, false}, {0.6001, true}, {0.41, true}, {0.399, false},
               {0.59, false}, {1.0, true},   {0.5, true},    {0.0, false}};
    for (unsigned k = 0; k < sizeof row / sizeof *row; k++) {
        run(row[k].command, 2);
        TEST_ASSERT_EQUAL(row[k].on, bench_on(pin));
    }
}

/* The check takes half a code of 16 bits as rounding of the settings. */
static void an_analogue_output_that_falls_half_a_code_below_0_is_at_0(void)
{
    settings = bench_settings(OUTPUT_ANALOG, 0);
    settings.offset = 0.5f;
    settings.gain = -0.5f - 0x1p-17f;
    begin(settings);
    run(1.0, 2);
    TEST_ASSERT_EQUAL_UINT16(0, bench_pins[pin].part);
}

static void a_relay_without_hysteresis_does_not_chatter_at_its_edge(void)
{
    settings = bench_settings(OUTPUT_RELAY, 0);
    settings.hysteresis = 0.0f;
    settings.least_on = settings.least_off = 0.0f;
    begin(settings);
    run(0.5, 1000);
    TEST_ASSERT_TRUE(bench_on(pin));
    TEST_ASSERT_EQUAL_UINT(1, bench_pins[pin].rises);
}

static void a_relay_keeps_its_least_times_whatever_the_command_does(void)
{
    settings = bench_settings(OUTPUT_RELAY, 0);
    settings.least_on = 0.3f;
    settings.least_off = 0.7f;
    begin(settings);
    struct random_source source = bench_random(7);
    bool on = false;
    unsigned same = 1, changes = 0; /* same: since bench_open() */
    for (unsigned k = 0; k < 400000; k++) {
        run(random_below(&source, 40) ? 0.5 : on ? 0.0 : 1.0, 1);
        if (bench_on(pin) != on) {
            TEST_ASSERT_GREATER_OR_EQUAL(on ? 300u : 700u, same);
            on = !on;
            same = 0;
            changes++;
        }
        same++;
    }
    TEST_ASSERT_GREATER_THAN(300, changes);
}

static void an_output_that_is_on_when_low_has_the_levels_turned_round(void)
{
    settings = bench_settings(OUTPUT_RELAY, 0);
    settings.low = true;
    begin(settings);
    run(0.0, 100);
    TEST_ASSERT_TRUE(bench_pins[pin].high);
    run(1.0, 100);
    TEST_ASSERT_FALSE(bench_pins[pin].high);
}

static void a_pulse_width_is_the_command_and_is_written_only_when_it_changes(void)
{
    begin(bench_settings(OUTPUT_PWM, 0));
    run(0.25, 1);
    TEST_ASSERT_UINT16_WITHIN(1, HAL_PWM_FULL / 4, bench_pins[pin].part);
    run(1.0, 1);
    TEST_ASSERT_EQUAL(HAL_PWM_FULL, bench_pins[pin].part);
    unsigned set = bench_pins[pin].pwm_set;
    run(1.0, 500);
    TEST_ASSERT_EQUAL(set, bench_pins[pin].pwm_set);
    run(0.0, 1);
    TEST_ASSERT_EQUAL(0, bench_pins[pin].part);
    TEST_ASSERT_EQUAL(1000, bench_pins[pin].hz);
}

static void a_pulse_width_reads_back_the_mean_of_the_commands(void)
{
    begin(bench_settings(OUTPUT_PWM, 0));
    run(0.3, 1);
    (void)outputs_readback(0);
    run(0.3, 300);
    run(0.8, 700);
    /* The last command of each piece holds for the millisecond after it. */
    double wanted = (double)(301 * bench_whole(0.3f) + 699 * bench_whole(0.8f)) / 65536.0 / 1000.0;
    TEST_ASSERT_FLOAT_WITHIN(1e-7f, (float)wanted, outputs_readback(0));
}

static void an_analogue_output_has_gain_and_offset(void)
{
    settings = bench_settings(OUTPUT_ANALOG, 0);
    settings.offset = 0.2f;
    settings.gain = 0.8f; /* 2-10 V */
    begin(settings);
    static const double command[] = {0.0, 0.5, 1.0};
    for (unsigned k = 0; k < 3; k++) {
        run(command[k], 1);
        TEST_ASSERT_UINT16_WITHIN(2, (uint16_t)((0.2 + 0.8 * command[k]) * HAL_PWM_FULL),
                                  bench_pins[pin].part);
    }
    settings.offset = 1.0f;
    settings.gain = -1.0f;
    begin(settings);
    for (unsigned k = 0; k < 3; k++) {
        run(command[k], 1);
        TEST_ASSERT_UINT16_WITHIN(2, (uint16_t)((1.0 - command[k]) * HAL_PWM_FULL),
                                  bench_pins[pin].part);
    }
}

static void an_analogue_output_at_command_0_is_written_too(void)
{
    settings = bench_settings(OUTPUT_ANALOG, 0);
    settings.offset = 0.5f;
    settings.gain = 0.5f;
    begin(settings);
    run(0.0, 1);
    TEST_ASSERT_UINT16_WITHIN(1, HAL_PWM_FULL / 2, bench_pins[pin].part);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_relay_switches_at_the_edges_of_its_hysteresis);
    RUN_TEST(an_analogue_output_that_falls_half_a_code_below_0_is_at_0);
    RUN_TEST(a_relay_without_hysteresis_does_not_chatter_at_its_edge);
    RUN_TEST(a_relay_keeps_its_least_times_whatever_the_command_does);
    RUN_TEST(an_output_that_is_on_when_low_has_the_levels_turned_round);
    RUN_TEST(a_pulse_width_is_the_command_and_is_written_only_when_it_changes);
    RUN_TEST(a_pulse_width_reads_back_the_mean_of_the_commands);
    RUN_TEST(an_analogue_output_has_gain_and_offset);
    RUN_TEST(an_analogue_output_at_command_0_is_written_too);
    return UNITY_END();
}
