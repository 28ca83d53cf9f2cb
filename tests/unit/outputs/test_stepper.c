/* Stepper pumps: steps made against the integral of the command, pulses, and the change of speed.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs_bench.h"
#include "sample.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static struct random_source random_source;
static struct output_settings settings;
static double full;   /* steps a millisecond at command 1 */
static double wanted; /* integral of the command, steps */
static long steps;
static bool high;
static unsigned since_step, longest_gap;

void setUp(void) {}
void tearDown(void)
{
    bench_tell_seed();
}

static uint32_t below(uint32_t n)
{
    return random_below(&random_source, n);
}

/* So many steps a second at command 1. */
static void begin(double speed, double ramp)
{
    bench_begin();
    settings = bench_settings(OUTPUT_STEPPER, 1);
    settings.steps = 100.0f;
    settings.flow = (float)(speed * 3.6 / 100.0);
    settings.ramp = (float)ramp;
    bench_open(&settings, 1);
    full = (double)settings.flow / 3.6 * (double)settings.steps / 1000.0;
    wanted = 0.0;
    steps = 0;
    high = false;
    since_step = 1000;
    longest_gap = 0;
}

/* A millisecond; checks that pulses are 1 ms long and at least 2 ms apart. */
static void run(double command)
{
    outputs_command(0, true, (float)command);
    bench_turn();
    bool was_high = high;
    high = bench_on(settings.pin[OUTPUT_PIN]);
    TEST_ASSERT_FALSE(was_high && high);
    since_step++;
    if (high) {
        TEST_ASSERT_GREATER_OR_EQUAL(2, since_step);
        longest_gap = since_step > longest_gap ? since_step : longest_gap;
        since_step = 0;
        steps++;
    }
    wanted += (double)bench_whole((float)command) / 65536.0 * full;
}

static double random_command(void)
{
    uint32_t how = below(5);
    return how == 0 ? 0.0 : how == 1 ? 1.0 : below(65537) / 65536.0;
}

static void steps_equal_the_integral_of_the_command_once_it_has_been_followed(void)
{
    for (uint32_t seed = 1; seed <= 100; seed++) {
        random_source = bench_random(seed);
        double speed = 5.0 + below(490), ramp = 50.0 + below(5000);
        begin(speed, ramp);
        for (unsigned piece = 0; piece < 30; piece++) {
            double command = random_command();
            for (unsigned k = 1 + below(3000); k > 0; k--)
                run(command);
        }
        /* Long enough for anything that is owed, with room below the full speed. */
        for (unsigned k = 0; k < 60000; k++)
            run(0.5);
        char text[100];
        snprintf(text, sizeof text, "seed %u: speed %g ramp %g", (unsigned)seed, speed, ramp);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1.3, wanted, (double)steps, text);
    }
}

static void what_is_owed_stays_within_its_bound_whatever_the_command_does(void)
{
    for (uint32_t seed = 1; seed <= 200; seed++) {
        random_source = bench_random(seed);
        double speed = 5.0 + below(490), ramp = 50.0 + below(2000);
        begin(speed, ramp);
        double bound = speed * speed / ramp + 2.0, command = 0.0;
        unsigned longest = (unsigned)(2000.0 * speed / ramp) + 2;
        unsigned left = 0;
        for (unsigned k = 0; k < 30000; k++) {
            if (left-- == 0) {
                command = below(2) ? (below(2) ? 1.0 : 0.0) : random_command();
                left = below(longest);
            }
            run(command);
            TEST_ASSERT_TRUE(fabs(wanted - (double)steps) <= bound);
        }
    }
}

/* From rest to half the full speed. With v the speed and a the ramp, the motor owes v^2 / 2a when it has got there; it turns faster for v / (a sqrt 2),
 * slows down for as long, and owes nothing after v / a (1 + sqrt 2), the shortest time that the ramp allows. */
static void what_a_ramp_has_owed_is_made_up_in_the_shortest_time_without_running_past(void)
{
    static const double ramp[] = {100.0, 400.0, 3000.0};
    for (unsigned m = 0; m < 3; m++) {
        begin(400.0, ramp[m]);
        double least_ms = 1000.0 * 200.0 / ramp[m] * (1.0 + sqrt(2.0));
        for (unsigned k = 0; k < 15000; k++) {
            run(0.5);
            TEST_ASSERT_TRUE((double)steps <= wanted + 1.3);
            if (k > least_ms * 1.02 + 10.0)
                TEST_ASSERT_TRUE((double)steps >= wanted - 1.3);
        }
    }
}

/* From the times of the steps: with a change of speed of no more than the ramp, the number of steps in two windows of the same length that
 * touch differs by no more than ramp * window^2, and a step at either end of each. */
static void the_speed_changes_no_faster_than_the_ramp(void)
{
    enum { MS = 20000 };
    static uint16_t made[MS + 1]; /* steps up to here */
    for (uint32_t seed = 1; seed <= 60; seed++) {
        random_source = bench_random(seed);
        double speed = 100.0 + below(390), ramp = 50.0 + below(1000);
        begin(speed, ramp);
        double command = 0.0;
        for (unsigned k = 0; k < MS; k++) {
            if (below(400) == 0)
                command = random_command();
            run(command);
            made[k + 1] = (uint16_t)steps;
        }
        for (unsigned w = 50; w <= 800; w *= 2)
            for (unsigned k = w; k + w <= MS; k++) {
                int difference = (made[k + w] - made[k]) - (made[k] - made[k - w]);
                double most = ramp * (w / 1000.0) * (w / 1000.0) + 2.01;
                TEST_ASSERT_TRUE(abs(difference) <= most);
            }
    }
}

static void the_speed_never_exceeds_that_of_command_1(void)
{
    for (uint32_t seed = 1; seed <= 60; seed++) {
        random_source = bench_random(seed);
        double speed = 20.0 + below(480);
        begin(speed, 50.0 + below(5000));
        long before = 0;
        double command = 0.0;
        for (unsigned k = 1; k <= 40000; k++) {
            if (below(500) == 0)
                command = random_command();
            run(command);
            if (k % 1000 == 0) {
                TEST_ASSERT_TRUE((double)(steps - before) <= full * 1000.0 + 1.0);
                before = steps;
            }
        }
    }
}

static void a_steady_speed_has_steps_as_even_as_milliseconds_allow(void)
{
    static const double speed[] = {500.0, 400.0, 333.0, 90.0, 7.0};
    for (unsigned k = 0; k < 5; k++) {
        begin(speed[k], 10000.0);
        for (unsigned ms = 0; ms < 3000; ms++)
            run(1.0);
        longest_gap = 0;
        long before = steps;
        for (unsigned ms = 0; ms < 30000; ms++)
            run(1.0);
        TEST_ASSERT_DOUBLE_WITHIN(1.0, 30.0 * speed[k], (double)(steps - before));
        TEST_ASSERT_LESS_OR_EQUAL((unsigned)ceil(1000.0 / speed[k]), longest_gap);
    }
}

/* With `all` a day, to a millionth; else two hours, to as many steps. */
static void the_mean_over_a_day_is_that_of_the_command_to_a_millionth(void)
{
    begin(450.0, 100.0);
    uint32_t ms = sample_every_case ? 86400000u : 7200000u;
    for (uint32_t k = 0; k < ms; k++)
        run(0.7);
    TEST_ASSERT_DOUBLE_WITHIN(27.0, wanted, (double)steps); /* a millionth of a day's */
}

static void the_direction_pin_is_as_set_and_may_be_missing(void)
{
    begin(100.0, 500.0);
    TEST_ASSERT_FALSE(bench_on(settings.pin[OUTPUT_SECOND_PIN]));
    settings.reverse = true;
    bench_open(&settings, 1);
    TEST_ASSERT_TRUE(bench_on(settings.pin[OUTPUT_SECOND_PIN]));
    settings.pin[OUTPUT_SECOND_PIN] = HAL_PIN_NONE;
    bench_open(&settings, 1);
    steps = 0;
    for (unsigned k = 0; k < 1000; k++)
        run(1.0);
    TEST_ASSERT_TRUE(steps > 0);
}

static void reads_back_the_steps_that_were_made(void)
{
    random_source = bench_random(5);
    begin(250.0, 200.0);
    (void)outputs_readback(0);
    for (unsigned sample = 0; sample < 200; sample++) {
        long before = steps;
        double command = random_command();
        unsigned ms = 100 + below(3000);
        for (unsigned k = 0; k < ms; k++)
            run(command);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)(steps - before) / (full * ms),
                                  (double)outputs_readback(0));
    }
}

static void a_clock_that_stood_makes_up_for_no_steps_and_starts_from_rest(void)
{
    begin(400.0, 100.0);
    for (unsigned k = 0; k < 10000; k++)
        run(1.0);
    long before = steps;
    outputs_command(0, true, 1.0f);
    bench_turn_after(1500);
    for (unsigned k = 0; k < 1000; k++)
        run(1.0);
    TEST_ASSERT_INT_WITHIN(2, 50, steps - before); /* ramp t^2 / 2 */
}

int main(int argc, char **argv)
{
    sample_arguments(argc, argv);
    UNITY_BEGIN();
    RUN_TEST(steps_equal_the_integral_of_the_command_once_it_has_been_followed);
    RUN_TEST(what_is_owed_stays_within_its_bound_whatever_the_command_does);
    RUN_TEST(what_a_ramp_has_owed_is_made_up_in_the_shortest_time_without_running_past);
    RUN_TEST(the_speed_changes_no_faster_than_the_ramp);
    RUN_TEST(the_speed_never_exceeds_that_of_command_1);
    RUN_TEST(a_steady_speed_has_steps_as_even_as_milliseconds_allow);
    RUN_TEST(the_mean_over_a_day_is_that_of_the_command_to_a_millionth);
    RUN_TEST(the_direction_pin_is_as_set_and_may_be_missing);
    RUN_TEST(reads_back_the_steps_that_were_made);
    RUN_TEST(a_clock_that_stood_makes_up_for_no_steps_and_starts_from_rest);
    return UNITY_END();
}
