/* What output_check() refuses, and its words.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs_bench.h"
#include "unity.h"

#include <math.h>
#include <string.h>

static struct output_settings s[3];
static struct output_problem problem;

void setUp(void)
{
    bench_begin();
    for (uint8_t k = 0; k < 3; k++)
        s[k] = bench_settings(OUTPUT_WINDOW, k);
}
void tearDown(void) {}

static bool check(uint8_t index)
{
    return output_check(s, 3, index, &problem);
}

static void refuses(uint8_t index, const char *words)
{
    TEST_ASSERT_FALSE(check(index));
    TEST_ASSERT_EQUAL_STRING(words, problem.words);
}

static void the_first_settings_of_each_type_with_its_pins_are_right(void)
{
    for (unsigned type = OUTPUT_NONE; type < OUTPUT_TYPES; type++) {
        s[0] = bench_settings((enum output_type)type, 0);
        TEST_ASSERT_TRUE(check(0));
    }
}

static void every_number_is_refused_outside_its_range_and_only_by_types_that_use_it(void)
{
    for (size_t k = 0; k < output_number_count; k++) {
        const struct output_number *number = &output_numbers[k];
        TEST_ASSERT_TRUE(number->lo <= number->initial && number->initial <= number->hi);
        const float wrong[] = {number->lo - 0.01f * fabsf(number->lo) - 1e-6f,
                               number->hi + 0.01f * number->hi, NAN, INFINITY};
        for (unsigned type = 1; type < OUTPUT_TYPES; type++)
            for (unsigned w = 0; w < 4; w++) {
                s[0] = bench_settings((enum output_type)type, 0);
                *(float *)(void *)((char *)&s[0] + number->offset) = wrong[w];
                bool uses = (number->types & OUTPUT_BIT(type)) != 0;
                TEST_ASSERT_EQUAL(!uses, check(0));
                if (uses)
                    TEST_ASSERT_EQUAL_PTR(number, problem.number);
            }
    }
}

static void the_ends_of_a_range_are_taken(void)
{
    s[0].dead_man = 0.5f;
    TEST_ASSERT_TRUE(check(0));
    s[0].dead_man = 2.0f;
    s[0].period = 120.0f;
    TEST_ASSERT_TRUE(check(0));
    s[0].period = 0.1f;
    TEST_ASSERT_TRUE(check(0));
}

static void least_times_must_fit_into_the_period(void)
{
    s[0].period = 10.0f;
    s[0].least_on = 4.0f;
    s[0].least_off = 6.0f;
    TEST_ASSERT_TRUE(check(0));
    s[0].least_off = 6.001f;
    refuses(0, "least time on and least time off together are longer than the period");
}

static void a_pin_that_is_missing_taken_or_used_twice_is_refused(void)
{
    s[1] = bench_settings(OUTPUT_MOTOR_VALVE, 1);
    bench_pins[s[0].pin[OUTPUT_PIN]].taken = true;
    refuses(0, "the pin is not free: this board lacks it, or something else needs it");
    TEST_ASSERT_EQUAL(OUTPUT_PIN, problem.pin);
    s[1].pin[OUTPUT_SECOND_PIN] = HAL_PIN_NONE;
    refuses(1, "a pin is missing");
    TEST_ASSERT_EQUAL(OUTPUT_SECOND_PIN, problem.pin);
    s[1].pin[OUTPUT_SECOND_PIN] = s[1].pin[OUTPUT_PIN];
    refuses(1, "the output has the same pin twice");
    s[1] = bench_settings(OUTPUT_MOTOR_VALVE, 1);
    s[2].pin[OUTPUT_PIN] = s[1].pin[OUTPUT_CLOSED_END];
    TEST_ASSERT_TRUE(check(1));
    refuses(2, "another output has the same pin");
    TEST_ASSERT_EQUAL(1, problem.other);
}

static void a_pin_that_the_type_does_not_use_does_not_count(void)
{
    s[0].pin[OUTPUT_SECOND_PIN] = s[1].pin[OUTPUT_PIN];
    s[2].pin[OUTPUT_SECOND_PIN] = s[2].pin[OUTPUT_PIN];
    TEST_ASSERT_TRUE(check(1));
    TEST_ASSERT_TRUE(check(2));
}

static void contacts_and_direction_may_be_missing(void)
{
    s[0] = bench_settings(OUTPUT_MOTOR_VALVE, 0);
    s[0].pin[OUTPUT_OPEN_END] = s[0].pin[OUTPUT_CLOSED_END] = HAL_PIN_NONE;
    TEST_ASSERT_TRUE(check(0));
    s[0] = bench_settings(OUTPUT_STEPPER, 0);
    s[0].pin[OUTPUT_SECOND_PIN] = HAL_PIN_NONE;
    TEST_ASSERT_TRUE(check(0));
}

static void bursts_are_whole_cycles_and_whole_milliseconds(void)
{
    s[0] = bench_settings(OUTPUT_BURST, 0);
    s[0].cycles = 4.0f;
    TEST_ASSERT_TRUE(check(0));
    s[0].cycles = 2.5f;
    refuses(0, "the number of cycles is not whole");
    s[0].mains_60 = true;
    s[0].cycles = 6.0f;
    TEST_ASSERT_TRUE(check(0));
    s[0].cycles = 4.0f;
    refuses(0, "at 60 Hz the cycles must be a multiple of 3, because only these are whole "
               "milliseconds");
}

static void a_stepper_makes_at_most_500_and_at_least_a_tenth_of_a_step_a_second(void)
{
    s[0] = bench_settings(OUTPUT_STEPPER, 0);
    s[0].steps = 360.0f;
    s[0].flow = 5.0f;
    TEST_ASSERT_TRUE(check(0));
    s[0].flow = 5.01f;
    refuses(0, "flow and steps make more than 500 steps a second");
    s[0].flow = 0.001f;
    s[0].steps = 361.0f;
    TEST_ASSERT_TRUE(check(0));
    s[0].steps = 359.0f;
    refuses(0, "flow and steps make less than 0.1 steps a second");
}

static void an_analogue_output_stays_within_its_span(void)
{
    s[0] = bench_settings(OUTPUT_ANALOG, 0);
    s[0].offset = 0.2f;
    s[0].gain = 0.8f;
    TEST_ASSERT_TRUE(check(0));
    s[0].gain = 0.81f;
    refuses(0, "offset and gain take the output out of 0 to 1 at command 1");
    s[0].gain = -0.21f;
    refuses(0, "offset and gain take the output out of 0 to 1 at command 1");
}

static void a_pulse_width_without_a_timer_is_refused(void)
{
    s[0] = bench_settings(OUTPUT_PWM, 0);
    s[1] = bench_settings(OUTPUT_ANALOG, 1);
    s[2] = bench_settings(OUTPUT_WINDOW, 2);
    for (unsigned k = 0; k < 3; k++)
        bench_pins[s[k].pin[OUTPUT_PIN]].no_timer = true;
    refuses(0, "the pin has no timer for a pulse width, or not with this frequency");
    TEST_ASSERT_EQUAL(OUTPUT_PIN, problem.pin);
    refuses(1, "the pin has no timer for a pulse width, or not with this frequency");
    TEST_ASSERT_TRUE(check(2));
}

static void two_pulse_widths_of_one_timer_have_one_frequency_and_two_channels(void)
{
    s[0] = bench_settings(OUTPUT_PWM, 0);
    s[1] = bench_settings(OUTPUT_ANALOG, 1);
    s[1].frequency = s[0].frequency = 1000.0f;
    bench_pins[s[0].pin[OUTPUT_PIN]].timer = bench_pins[s[1].pin[OUTPUT_PIN]].timer = 200;
    bench_pins[s[1].pin[OUTPUT_PIN]].channel = 1;
    TEST_ASSERT_TRUE(check(1));
    s[1].frequency = 1001.0f;
    refuses(1, "another output of the pin's timer has another frequency");
    TEST_ASSERT_EQUAL(0, problem.other);
    s[1].frequency = 1000.0f;
    bench_pins[s[1].pin[OUTPUT_PIN]].channel = 0;
    refuses(1, "another output has the same channel of the pin's timer");
    TEST_ASSERT_EQUAL(0, problem.other);
    s[0] = bench_settings(OUTPUT_WINDOW, 0); /* needs no timer */
    TEST_ASSERT_TRUE(check(1));
}

static void a_pause_longer_than_the_travel_is_refused(void)
{
    s[0] = bench_settings(OUTPUT_MOTOR_VALVE, 0);
    s[0].travel = 5.0f;
    s[0].pause = 5.1f;
    refuses(0, "the pause is longer than the travel time");
}

static void there_is_one_enable_output_and_it_does_not_chatter(void)
{
    s[0] = bench_settings(OUTPUT_ENABLE, 0);
    s[1] = bench_settings(OUTPUT_ENABLE, 1);
    TEST_ASSERT_TRUE(check(0));
    refuses(1, "another output is the enable output already");
    TEST_ASSERT_EQUAL(0, problem.other);
    s[0].least_off = 0.9f;
    refuses(0, "the enable output must stay off for at least 1 s");
}

static void a_type_that_does_not_exist_is_refused_and_harms_no_other(void)
{
    s[0].type = OUTPUT_TYPES;
    refuses(0, "there is no such type of output");
    TEST_ASSERT_TRUE(check(1));
}

static void every_type_has_a_name_of_its_own(void)
{
    for (unsigned a = 0; a < OUTPUT_TYPES; a++)
        for (unsigned b = 0; b < a; b++)
            TEST_ASSERT_TRUE(strcmp(output_type_name((uint8_t)a), output_type_name((uint8_t)b)) !=
                             0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_first_settings_of_each_type_with_its_pins_are_right);
    RUN_TEST(every_number_is_refused_outside_its_range_and_only_by_types_that_use_it);
    RUN_TEST(the_ends_of_a_range_are_taken);
    RUN_TEST(least_times_must_fit_into_the_period);
    RUN_TEST(a_pin_that_is_missing_taken_or_used_twice_is_refused);
    RUN_TEST(a_pin_that_the_type_does_not_use_does_not_count);
    RUN_TEST(contacts_and_direction_may_be_missing);
    RUN_TEST(bursts_are_whole_cycles_and_whole_milliseconds);
    RUN_TEST(a_stepper_makes_at_most_500_and_at_least_a_tenth_of_a_step_a_second);
    RUN_TEST(an_analogue_output_stays_within_its_span);
    RUN_TEST(a_pulse_width_without_a_timer_is_refused);
    RUN_TEST(two_pulse_widths_of_one_timer_have_one_frequency_and_two_channels);
    RUN_TEST(a_pause_longer_than_the_travel_is_refused);
    RUN_TEST(there_is_one_enable_output_and_it_does_not_chatter);
    RUN_TEST(a_type_that_does_not_exist_is_refused_and_harms_no_other);
    RUN_TEST(every_type_has_a_name_of_its_own);
    return UNITY_END();
}
