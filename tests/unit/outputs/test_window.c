/* Window outputs: how far the time on departs from the integral of the command, and how long they stay on and off.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs_bench.h"
#include "sample.h"
#include "unity.h"

#include <stdio.h>

#define MS INT64_C(65536)

static struct random_source random_source;
static struct output_settings settings;
static hal_pin pin;
static int64_t owed; /* integral of the command less the time on, 1/65536 ms */
static bool was_on;
static uint32_t same_ms; /* since the pin changed */
static uint32_t least_on, least_off;
static unsigned switched;

void setUp(void)
{
    bench_begin();
}
void tearDown(void)
{
    bench_tell_seed();
}

static void begin(float period, float on, float off)
{
    bench_begin();
    settings = bench_settings(OUTPUT_WINDOW, 0);
    settings.period = period;
    settings.least_on = on;
    settings.least_off = off;
    bench_open(&settings, 1);
    pin = settings.pin[OUTPUT_PIN];
    least_on = output_ms(on);
    least_off = output_ms(off);
    owed = 0;
    was_on = false;
    same_ms = 1; /* the first run() is the millisecond after bench_open() */
    switched = 0;
}

/* One millisecond with this command. Checks the least times. */
static void run(double command)
{
    outputs_command(0, true, (float)command);
    bench_turn();
    bool on = bench_on(pin);
    if (on != was_on) {
        TEST_ASSERT_GREATER_OR_EQUAL_UINT32(was_on ? least_on : least_off, same_ms);
        same_ms = 0;
        switched++;
    }
    was_on = on;
    same_ms++;
    owed += bench_whole((float)command) - (on ? MS : 0);
}

/* Right behind begin(): a whole period and what is left of the one that the clock is in. The next run() is the first one of a period. */
static void run_to_period(unsigned period_ms)
{
    unsigned left_ms = period_ms - bench_now % period_ms;
    for (unsigned k = 1; k < period_ms + left_ms; k++)
        run(0.0);
}

static uint32_t below(uint32_t n)
{
    return random_below(&random_source, n);
}

static double random_command(void)
{
    switch (below(6)) {
    case 0:
        return 0.0;
    case 1:
        return 1.0;
    case 2:
        return 0.02 * below(1001) / 1000.0;
    case 3:
        return 1.0 - 0.02 * below(1001) / 1000.0;
    default:
        return below(65537) / 65536.0;
    }
}

/* Period and least times anywhere in their ranges that output_check() takes. */
static void random_begin(void)
{
    uint32_t period = below(4) ? 100u + below(4000u) : 100u + below(119900u);
    uint32_t on = below(3) ? below(period / 2u + 1u) : below(period + 1u);
    uint32_t off = below(3) ? below((period - on) / 2u + 1u) : period - on;
    begin((float)period / 1000.0f, (float)(on > 60000u ? 60000u : on) / 1000.0f,
          (float)off / 1000.0f);
}

static int64_t longer_ms(void)
{
    return least_on > least_off ? least_on : least_off;
}

static void within_bounds(uint32_t seed)
{
    int64_t period = output_ms(settings.period);
    char text[160];
    if (owed <= (longer_ms() + 1) * MS && owed >= -(period / 4 + longer_ms() + 1) * MS)
        return;
    snprintf(text, sizeof text, "seed %u: %.3f ms owed; period %.3f, least on %.3f, off %.3f s",
             (unsigned)seed, (double)owed / 65536.0, (double)settings.period,
             (double)settings.least_on, (double)settings.least_off);
    TEST_FAIL_MESSAGE(text);
}

static void random_commands_are_followed_within_the_bounds_at_every_millisecond(void)
{
    uint32_t seeds = sample_every_case ? 1000 : 100;
    for (uint32_t seed = 1; seed <= seeds; seed++) {
        random_source = bench_random(seed);
        random_begin();
        uint32_t period = output_ms(settings.period);
        uint32_t longest = below(3) ? 3u * period : 40u;
        longest = longest < 10000u ? longest : 10000u;
        for (unsigned piece = 0; piece < 60; piece++) {
            double command = random_command();
            for (uint32_t k = 1u + below(longest); k > 0; k--) {
                run(command);
                within_bounds(seed);
            }
        }
    }
}

/* Somebody who sees the pin chooses the worst command at each moment. */
static void commands_that_go_against_the_output_are_followed_within_the_bounds(void)
{
    for (uint32_t seed = 1; seed <= 200; seed++) {
        random_source = bench_random(seed);
        random_begin();
        bool wants_surplus = below(2), plays = below(2);
        uint32_t period = output_ms(settings.period);
        for (uint32_t k = 0; k < 8000; k++) {
            uint32_t left = period - (k + 1u) % period; /* of the period, at the turn of run() */
            bool on = bench_on(pin);
            double command = on == wants_surplus ? 0.0 : 1.0;
            /* A pulse begins that will not be asked for, or goes on for the least command that lets it. */
            if (wants_surplus && !on)
                command = below(50) ? 1.0 : random_command();
            else if (wants_surplus && plays)
                command = ((double)-owed / 65536.0 + 2.0) / left;
            command = command < 0.0 ? 0.0 : command > 1.0 ? 1.0 : command;
            run(command);
            within_bounds(seed);
        }
    }
}

static void a_constant_command_owes_less_than_a_least_time_at_the_end_of_each_period(void)
{
    for (uint32_t seed = 1; seed <= 100; seed++) {
        random_source = bench_random(seed);
        random_begin();
        double command = random_command();
        uint32_t period = output_ms(settings.period);
        run_to_period(period); /* the least time off after a reset is over */
        for (uint32_t k = 1; k <= 20u * period && k < 500000u; k++) {
            run(command);
            if (k % period != 0)
                continue;
            TEST_ASSERT_TRUE(owed <= (least_on > 1 ? least_on : 1) * MS);
            TEST_ASSERT_TRUE(owed > -(least_off > 1 ? (int64_t)least_off : 1) * MS);
        }
    }
}

static void
a_command_that_changes_at_any_millisecond_of_a_period_has_its_integral_by_the_end_of_it(void)
{
    static const double level[] = {0.0, 0.1, 0.5, 0.77, 1.0};
    enum { PERIOD = 200 };
    for (unsigned a = 0; a < 5; a++)
        for (unsigned b = 0; b < 5; b++)
            for (unsigned change = 0; change < PERIOD; change++) {
                begin(0.2f, 0.0f, 0.0f);
                run_to_period(PERIOD);
                int on = 0, on_before = 0;
                int64_t integral = 0;
                for (unsigned k = 0; k < PERIOD; k++) {
                    double command = k < change ? level[a] : level[b];
                    run(command);
                    on += bench_on(pin);
                    on_before += k < change && bench_on(pin);
                    integral += bench_whole(command);
                }
                /* What was on cannot be undone, and what is missing cannot come faster than with the output on. */
                int wanted = (int)((integral + MS - 1) / MS);
                int most = on_before + PERIOD - (int)change;
                wanted = wanted < on_before ? on_before : wanted > most ? most : wanted;
                TEST_ASSERT_INT_WITHIN(1, wanted, on);
            }
}

static void each_period_has_one_pulse_at_its_beginning(void)
{
    begin(1.0f, 0.02f, 0.02f);
    run_to_period(1000);
    for (unsigned period = 0; period < 50; period++)
        for (unsigned k = 0; k < 1000; k++) {
            run(period < 25 ? 0.25 : 0.75);
            TEST_ASSERT_EQUAL(k < (period < 25 ? 250u : 750u), bench_on(pin));
        }
}

static void a_command_of_0_begins_no_pulse_and_of_1_ends_none(void)
{
    begin(1.0f, 0.3f, 0.3f);
    for (unsigned k = 0; k < 5000; k++)
        run(0.29); /* always less than the least time on is owed at the end of a period, or a pulse has come */
    for (unsigned k = 0; k < 1000; k++)
        run(0.0);
    TEST_ASSERT_FALSE(bench_on(pin));
    switched = 0;
    for (unsigned k = 0; k < 10000; k++)
        run(0.0);
    TEST_ASSERT_EQUAL(0, switched);
    for (unsigned k = 0; k < 1000; k++)
        run(1.0);
    TEST_ASSERT_TRUE(bench_on(pin));
    switched = 0;
    for (unsigned k = 0; k < 10000; k++)
        run(1.0);
    TEST_ASSERT_EQUAL(0, switched);
}

static void a_command_of_0_begins_no_pulse_even_where_one_is_owed(void)
{
    begin(1.0f, 0.02f, 0.5f);
    run_to_period(1000);
    for (unsigned k = 0; k < 110; k++)
        run(0.1);
    TEST_ASSERT_FALSE(bench_on(pin));
    for (unsigned k = 0; k < 400; k++)
        run(1.0); /* it may not be on yet */
    switched = 0;
    for (unsigned k = 0; k < 5000; k++)
        run(0.0);
    TEST_ASSERT_EQUAL(0, switched);
    run(0.01);
    TEST_ASSERT_TRUE(bench_on(pin));
}

static void a_clock_that_stood_keeps_the_beat_of_the_periods(void)
{
    static const uint32_t stood[] = {2, 500, 999, 1000, 1001, 1730};
    for (unsigned m = 0; m < sizeof stood / sizeof *stood; m++) {
        begin(1.0f, 0.0f, 0.0f);
        run_to_period(1000);
        bench_turn_after(stood[m]);
        /* The first turn of a period is a multiple of 1000 ms after bench_open(). */
        uint32_t ms = 999u + stood[m];
        for (unsigned k = 0; k < 4000; k++) {
            bool was = bench_on(pin);
            run(0.25);
            ms++;
            if (!was && bench_on(pin) && k > 1000)
                TEST_ASSERT_EQUAL(0, ms % 1000u);
        }
    }
}

static void shares_too_small_for_a_pulse_or_a_pause_are_carried_over(void)
{
    static const double command[] = {0.001, 0.01, 0.99, 0.999};
    for (unsigned c = 0; c < 4; c++) {
        begin(1.0f, 0.1f, 0.2f);
        for (unsigned k = 0; k < 2000000; k++)
            run(command[c]);
        TEST_ASSERT_GREATER_THAN(2, switched);
        /* A pulse or a pause is as long as the least one, and at most one period's share longer. */
        double share = command[c] < 0.5 ? command[c] : 1.0 - command[c];
        double least = command[c] < 0.5 ? 0.1 : 0.2, each = switched / 2.0 / 2000.0;
        TEST_ASSERT_TRUE(each <= share / least + 0.001);
        TEST_ASSERT_TRUE(each >= share / (least + share) - 0.001);
    }
}

/* With `all` a day, 86,400,000 turns of the clock, to a millionth; else two hours, to as many milliseconds. */
static void the_mean_over_a_day_is_that_of_the_commands_to_a_millionth(void)
{
    begin(10.0f, 0.05f, 0.05f);
    run_to_period(10000);
    random_source = bench_random(38);
    int64_t integral = 0, on = 0;
    double command = 0.0;
    uint32_t ms = sample_every_case ? 86400000u : 7200000u;
    for (uint32_t k = 0; k < ms; k++) {
        if (k % 1700u == 0)
            command = k < ms - 100000u ? below(65537) / 65536.0 : 0.3;
        outputs_command(0, true, (float)command);
        bench_turn();
        on += bench_on(pin);
        integral += bench_whole(command);
    }
    TEST_ASSERT_DOUBLE_WITHIN(86.4, (double)integral / 65536.0, (double)on);
}

int main(int argc, char **argv)
{
    sample_arguments(argc, argv);
    UNITY_BEGIN();
    RUN_TEST(random_commands_are_followed_within_the_bounds_at_every_millisecond);
    RUN_TEST(commands_that_go_against_the_output_are_followed_within_the_bounds);
    RUN_TEST(a_constant_command_owes_less_than_a_least_time_at_the_end_of_each_period);
    RUN_TEST(
        a_command_that_changes_at_any_millisecond_of_a_period_has_its_integral_by_the_end_of_it);
    RUN_TEST(each_period_has_one_pulse_at_its_beginning);
    RUN_TEST(a_command_of_0_begins_no_pulse_and_of_1_ends_none);
    RUN_TEST(a_command_of_0_begins_no_pulse_even_where_one_is_owed);
    RUN_TEST(a_clock_that_stood_keeps_the_beat_of_the_periods);
    RUN_TEST(shares_too_small_for_a_pulse_or_a_pause_are_carried_over);
    RUN_TEST(the_mean_over_a_day_is_that_of_the_commands_to_a_millionth);
    return UNITY_END();
}
