/* Commands to the clock, what is read back, the wrap of the clock, and opening.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs_bench.h"
#include "unity.h"

#include <math.h>

void setUp(void)
{
    bench_begin();
}
void tearDown(void)
{
    bench_tell_seed();
}

/* Two kinds of each that switch, one turned round, and a pulse width. */
static unsigned many(struct output_settings *s)
{
    unsigned n = 0;
    for (unsigned k = 0; k < 2; k++) {
        s[n] = bench_settings(OUTPUT_WINDOW, (uint8_t)n);
        s[n].period = 0.5f;
        n++;
        s[n] = bench_settings(OUTPUT_BURST, (uint8_t)n);
        n++;
        s[n] = bench_settings(OUTPUT_RELAY, (uint8_t)n);
        s[n].low = k;
        n++;
    }
    return n;
}

static void every_output_reads_back_its_time_on_between_samples(void)
{
    struct output_settings s[6];
    unsigned n = many(s);
    struct random_source source = bench_random(11);
    bench_open(s, (uint8_t)n);
    for (unsigned sample = 0; sample < 200; sample++) {
        unsigned on[6] = {0}, ms = 1 + random_below(&source, 900);
        for (unsigned k = 0; k < ms; k++) {
            for (unsigned m = 0; m < n; m++) {
                on[m] += bench_on(s[m].pin[OUTPUT_PIN]);
                outputs_command((uint8_t)m, true, (float)random_below(&source, 1001) / 1000.0f);
            }
            bench_turn();
        }
        for (unsigned m = 0; m < n; m++)
            TEST_ASSERT_TRUE(outputs_readback((uint8_t)m) == (float)on[m] / (float)ms);
    }
}

static void a_readback_without_a_millisecond_is_0_and_changes_nothing(void)
{
    struct output_settings s = bench_settings(OUTPUT_PWM, 0);
    bench_open(&s, 1);
    outputs_command(0, true, 1.0f);
    bench_turn();
    (void)outputs_readback(0);
    bench_turn();
    bench_turn();
    TEST_ASSERT_EQUAL_FLOAT(1.0f, outputs_readback(0));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, outputs_readback(0));
    bench_turn();
    TEST_ASSERT_EQUAL_FLOAT(1.0f, outputs_readback(0));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, outputs_readback(OUTPUTS_MAX - 1u));
}

static void a_day_between_samples_is_read_back_too(void)
{
    struct output_settings s = bench_settings(OUTPUT_PWM, 0);
    bench_open(&s, 1);
    outputs_command(0, true, 0.5f);
    bench_turn();
    (void)outputs_readback(0);
    for (unsigned k = 0; k < 86400; k++) {
        outputs_command(0, true, 0.5f);
        bench_turn_after(1000);
    }
    TEST_ASSERT_EQUAL_FLOAT(0.5f, outputs_readback(0));
}

/* The same commands from a clock that wraps and from one that does not. */
static void the_wrap_of_the_clock_changes_nothing(void)
{
    static bool first[6][6000];
    struct output_settings s[6];
    unsigned n = many(s);
    for (unsigned round = 0; round < 2; round++) {
        bench_begin();
        if (round)
            bench_now %= 1500u; /* the same place in periods of 500 ms and groups of 60 ms */
        uint32_t start = bench_now;
        struct random_source source = bench_random(12);
        bench_open(s, (uint8_t)n);
        for (unsigned k = 0; k < 6000; k++) {
            for (unsigned m = 0; m < n; m++)
                /* Half of them run through the wrap at 3000 ms. The dead man of the others counts through it. */
                if (random_below(&source, 500) != 0 && k < (m % 2 ? 1500u : 3500u))
                    outputs_command((uint8_t)m, true, (float)random_below(&source, 1001) / 1000.0f);
            bench_turn();
            for (unsigned m = 0; m < n; m++) {
                bool on = bench_on(s[m].pin[OUTPUT_PIN]);
                if (round)
                    TEST_ASSERT_EQUAL(first[m][k], on);
                else
                    first[m][k] = on;
            }
        }
        TEST_ASSERT_EQUAL(6001u, bench_now - start);
        TEST_ASSERT_EQUAL(round == 0, bench_now < start);
    }
}

static void turns_without_a_new_millisecond_do_nothing(void)
{
    struct output_settings s = bench_settings(OUTPUT_RELAY, 0);
    bench_open(&s, 1);
    for (unsigned k = 0; k < 100; k++)
        bench_turn();
    outputs_command(0, true, 1.0f);
    for (unsigned k = 0; k < 5000; k++)
        bench_turn_after(0);
    TEST_ASSERT_FALSE(bench_on(s.pin[OUTPUT_PIN]));
    bench_turn();
    TEST_ASSERT_TRUE(bench_on(s.pin[OUTPUT_PIN]));
    TEST_ASSERT_EQUAL(OUTPUT_COMMANDED, outputs_rule(0));
}

static void a_command_is_cut_at_0_and_1_and_a_nan_is_not_driven(void)
{
    struct output_settings s = bench_settings(OUTPUT_PWM, 0);
    bench_open(&s, 1);
    static const struct {
        float fraction;
        uint16_t part;
    } row[] = {
        {0.5f, 32768}, {7.0f, HAL_PWM_FULL}, {-1.0f, 0}, {INFINITY, HAL_PWM_FULL}, {0.25f, 16384}};
    for (unsigned k = 0; k < sizeof row / sizeof *row; k++) {
        outputs_command(0, true, row[k].fraction);
        bench_turn();
        TEST_ASSERT_EQUAL(OUTPUT_COMMANDED, outputs_rule(0));
        TEST_ASSERT_UINT16_WITHIN(1, row[k].part, bench_pins[s.pin[OUTPUT_PIN]].part);
    }
    outputs_command(0, true, NAN);
    bench_turn();
    TEST_ASSERT_EQUAL(OUTPUT_NO_DRIVER, outputs_rule(0));
    TEST_ASSERT_EQUAL(0, bench_pins[s.pin[OUTPUT_PIN]].part);
}

static void the_number_of_a_command_wraps_without_a_gap(void)
{
    struct output_settings s = bench_settings(OUTPUT_PWM, 0);
    bench_open(&s, 1);
    for (unsigned k = 0; k < 40000; k++) {
        outputs_command(0, true, 0.5f);
        bench_turn_after(499);
        TEST_ASSERT_EQUAL(OUTPUT_COMMANDED, outputs_rule(0));
    }
}

static void a_command_from_before_opening_does_not_count(void)
{
    struct output_settings s = bench_settings(OUTPUT_PWM, 0);
    outputs_command(0, true, 1.0f);
    bench_open(&s, 1);
    bench_turn();
    TEST_ASSERT_EQUAL(OUTPUT_DEAD_MAN, outputs_rule(0));
    TEST_ASSERT_EQUAL(0, bench_pins[s.pin[OUTPUT_PIN]].part);
}

static void an_output_that_cannot_be_opened_closes_all(void)
{
    struct output_settings s[3] = {bench_settings(OUTPUT_RELAY, 0),
                                   bench_settings(OUTPUT_MOTOR_VALVE, 1),
                                   bench_settings(OUTPUT_PWM, 2)};
    uint8_t failed = 99;
    bench_pins[s[2].pin[OUTPUT_PIN]].refuses = true;
    TEST_ASSERT_EQUAL(ERR_RANGE, outputs_open(s, 3, &failed));
    TEST_ASSERT_EQUAL(2, failed);
    for (unsigned k = 0; k < 256; k++)
        TEST_ASSERT_EQUAL(HAL_PIN_CLOSED, bench_pins[k].use);
    outputs_command(0, true, 1.0f);
    bench_turn();
    TEST_ASSERT_EQUAL(OUTPUT_UNUSED, outputs_rule(0));
}

static void opening_again_switches_off_and_gives_up_the_pins_of_before(void)
{
    struct output_settings s = bench_settings(OUTPUT_PWM, 0), other;
    bench_open(&s, 1);
    outputs_command(0, true, 1.0f);
    bench_turn();
    unsigned before = bench_safe;
    other = bench_settings(OUTPUT_STEPPER, 4);
    bench_open(&other, 1);
    TEST_ASSERT_EQUAL(before + 1, bench_safe);
    TEST_ASSERT_EQUAL(HAL_PIN_CLOSED, bench_pins[s.pin[OUTPUT_PIN]].use);
    TEST_ASSERT_EQUAL(HAL_PIN_OUTPUT, bench_pins[other.pin[OUTPUT_PIN]].use);
}

static void opening_again_begins_to_read_back_anew(void)
{
    struct output_settings s = bench_settings(OUTPUT_PWM, 0);
    bench_open(&s, 1);
    for (unsigned round = 0; round < 2; round++) {
        for (unsigned k = 0; k < 101; k++) {
            outputs_command(0, true, 0.5f);
            bench_turn();
        }
        TEST_ASSERT_EQUAL_FLOAT(0.5f * 100.0f / 101.0f, outputs_readback(0));
        bench_open(&s, 1);
    }
}

static void a_clock_that_stood_for_minutes_reads_back_what_the_pin_was(void)
{
    struct output_settings s = bench_settings(OUTPUT_PWM, 0);
    bench_open(&s, 1);
    outputs_command(0, true, 0.75f);
    bench_turn();
    (void)outputs_readback(0);
    bench_turn_after(600000);
    TEST_ASSERT_EQUAL_FLOAT(0.75f, outputs_readback(0));
}

static void all_outputs_have_their_own_commands(void)
{
    struct output_settings s[OUTPUTS_MAX];
    for (unsigned k = 0; k < OUTPUTS_MAX; k++)
        s[k] = bench_settings(OUTPUT_PWM, (uint8_t)k);
    bench_open(s, OUTPUTS_MAX);
    for (unsigned k = 0; k < OUTPUTS_MAX; k++)
        outputs_command((uint8_t)k, true, (float)k / 16.0f);
    bench_turn();
    for (unsigned k = 0; k < OUTPUTS_MAX; k++)
        TEST_ASSERT_UINT16_WITHIN(1, (uint16_t)(k * HAL_PWM_FULL / 16),
                                  bench_pins[s[k].pin[OUTPUT_PIN]].part);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_output_reads_back_its_time_on_between_samples);
    RUN_TEST(a_readback_without_a_millisecond_is_0_and_changes_nothing);
    RUN_TEST(a_day_between_samples_is_read_back_too);
    RUN_TEST(the_wrap_of_the_clock_changes_nothing);
    RUN_TEST(turns_without_a_new_millisecond_do_nothing);
    RUN_TEST(a_command_is_cut_at_0_and_1_and_a_nan_is_not_driven);
    RUN_TEST(the_number_of_a_command_wraps_without_a_gap);
    RUN_TEST(a_command_from_before_opening_does_not_count);
    RUN_TEST(an_output_that_cannot_be_opened_closes_all);
    RUN_TEST(opening_again_switches_off_and_gives_up_the_pins_of_before);
    RUN_TEST(opening_again_begins_to_read_back_anew);
    RUN_TEST(a_clock_that_stood_for_minutes_reads_back_what_the_pin_was);
    RUN_TEST(all_outputs_have_their_own_commands);
    return UNITY_END();
}
