/* Burst outputs: whole cycles, the mean, and what a solid-state relay that switches at zero makes of them on real mains.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs_bench.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define MS INT64_C(65536)

static struct random_source random_source;
static hal_pin pin;
static uint32_t group_ms;
static int64_t owed;

void setUp(void)
{
    bench_begin();
}
void tearDown(void)
{
    bench_tell_seed();
}

static uint32_t below(uint32_t n)
{
    return random_below(&random_source, n);
}

static void begin(unsigned cycles, bool mains_60)
{
    bench_begin();
    struct output_settings settings = bench_settings(OUTPUT_BURST, 3);
    settings.cycles = (float)cycles;
    settings.mains_60 = mains_60;
    bench_open((struct output_settings[]){bench_settings(OUTPUT_NONE, 0), settings}, 2);
    pin = settings.pin[OUTPUT_PIN];
    group_ms = mains_60 ? cycles / 3u * 50u : cycles * 20u;
    owed = 0;
}

static bool run(double command)
{
    outputs_command(1, true, (float)command);
    bench_turn();
    owed += bench_whole((float)command) - (bench_on(pin) ? MS : 0);
    return bench_on(pin);
}

/* Right behind begin(), to the last millisecond before a group. */
static void run_to_group(void)
{
    uint32_t left_ms = group_ms - bench_now % group_ms;
    for (uint32_t k = 1; k < left_ms; k++)
        run(0.0);
}

static void random_cycles(void)
{
    bool mains_60 = below(2);
    unsigned cycles = mains_60 ? 3u + 3u * below(4) : 1u + below(12);
    begin(cycles, mains_60);
}

static double random_command(void)
{
    uint32_t how = below(5);
    return how == 0 ? 0.0 : how == 1 ? 1.0 : below(65537) / 65536.0;
}

static void the_pin_changes_only_between_whole_groups(void)
{
    for (uint32_t seed = 1; seed <= 100; seed++) {
        random_source = bench_random(seed);
        random_cycles();
        run_to_group();
        bool on = false;
        for (uint32_t k = 0; k < 400u * group_ms; k++) {
            double command = below(7) ? 0.4 : random_command();
            bool was_on = on;
            on = run(command);
            if (k % group_ms != 0)
                TEST_ASSERT_EQUAL(was_on, on);
        }
    }
}

static void a_constant_command_owes_no_more_than_half_a_group(void)
{
    for (uint32_t seed = 1; seed <= 200; seed++) {
        random_source = bench_random(seed);
        random_cycles();
        run_to_group();
        double command = random_command();
        for (uint32_t k = 0; k < 300u * group_ms; k++) {
            run(command);
            TEST_ASSERT_TRUE(llabs(owed) * 2 <= (int64_t)group_ms * MS);
        }
    }
}

static void any_command_owes_no_more_than_one_and_a_half_groups(void)
{
    for (uint32_t seed = 1; seed <= 300; seed++) {
        random_source = bench_random(seed);
        random_cycles();
        bool against = below(2);
        double command = 0.0;
        for (uint32_t k = 0; k < 100u * group_ms; k++) {
            if (against)
                command = bench_on(pin) ? 0.0 : 1.0;
            else if (below(group_ms) == 0)
                command = random_command();
            run(command);
            TEST_ASSERT_TRUE(llabs(owed) * 2 <= (int64_t)group_ms * 3 * MS);
        }
    }
}

static void the_mean_over_an_hour_is_that_of_the_commands_to_half_a_group(void)
{
    begin(1, false);
    random_source = bench_random(60);
    int64_t integral = 0, on = 0;
    double command = 0.0;
    for (uint32_t k = 0; k < 3600000u; k++) {
        if (k % 1000u == 0)
            command = k < 3590000u ? random_command() : 0.37;
        on += run(command);
        integral += bench_whole((float)command);
    }
    TEST_ASSERT_TRUE(llabs(integral - on * MS) <= 10 * MS);
}

/* A relay that switches at zero: it conducts the half wave that begins while its input is on. */
struct balance {
    long half_waves, sum;        /* number of half waves, positive less negative */
    long largest;                /* of |sum| */
    int gate;                    /* sum of the present gate */
    int repeated, most_repeated; /* gates in a row that were out of balance to the same side */
    int side;
    int most_of_a_gate;
};

static void close_gate(struct balance *b)
{
    b->most_of_a_gate = abs(b->gate) > b->most_of_a_gate ? abs(b->gate) : b->most_of_a_gate;
    int side = (b->gate > 0) - (b->gate < 0);
    b->repeated = side == 0 ? 0 : side == b->side ? b->repeated + 1 : 1;
    if (b->repeated > b->most_repeated)
        b->most_repeated = b->repeated;
    b->side = side;
    b->gate = 0;
}

/* Mains with this frequency and phase (in half waves, at the beginning) for so many ms at this command. */
static struct balance conducted(double hz, double phase, double command, uint32_t ms)
{
    struct balance b = {0};
    double half_ms = 500.0 / hz;
    double next = phase * half_ms;
    unsigned n = 0;
    run_to_group();
    for (uint32_t k = 0; k < ms; k++) {
        bool on = run(command);
        while (next < k + 1.0) {
            next += half_ms;
            n++;
            if (!on)
                continue;
            int sign = n % 2 ? 1 : -1;
            b.half_waves++;
            b.sum += sign;
            b.gate += sign;
            b.largest = labs(b.sum) > b.largest ? labs(b.sum) : b.largest;
        }
        if ((k + 1) % group_ms == 0 && on)
            close_gate(&b);
    }
    return b;
}

static void on_true_mains_every_gate_has_as_many_half_waves_of_either_polarity(void)
{
    for (uint32_t seed = 1; seed <= 60; seed++) {
        random_source = bench_random(seed);
        bool mains_60 = below(2);
        begin(mains_60 ? 3u : 1u + below(3), mains_60);
        double phase = (below(998) + 1) / 1000.0;
        double command = (1 + below(99)) / 100.0;
        struct balance b = conducted(mains_60 ? 60.0 : 50.0, phase, command, 20000);
        TEST_ASSERT_EQUAL(0, b.most_repeated);
        TEST_ASSERT_LESS_OR_EQUAL(1, b.largest);
        TEST_ASSERT_TRUE(b.half_waves > 0);
    }
}

/* The gates slip along the mains and meet a crossing at each half wave that they have slipped; d times the half waves of that time are as many
 * meetings, and every other one is on the same side. */
static void on_mains_off_their_frequency_no_two_gates_in_a_row_lean_to_the_same_side(void)
{
    static const double off[] = {-0.01, -0.004, -0.001, -0.0002, 0.0002, 0.001, 0.004, 0.01};
    for (unsigned d = 0; d < sizeof off / sizeof *off; d++)
        for (uint32_t seed = 1; seed <= 20; seed++) {
            random_source = bench_random(seed);
            bool mains_60 = seed % 2;
            double hz = (mains_60 ? 60.0 : 50.0) * (1.0 + off[d]);
            begin(mains_60 ? 3u : 1u + below(3), mains_60);
            double command = (1 + below(99)) / 100.0;
            struct balance b = conducted(hz, (below(998) + 1) / 1000.0, command, 60000);
            TEST_ASSERT_LESS_OR_EQUAL(1, b.most_repeated);
            TEST_ASSERT_LESS_OR_EQUAL(1, b.most_of_a_gate);
            TEST_ASSERT_TRUE((double)labs(b.sum) <= fabs(off[d]) / 2.0 * 120.0 * hz + 2.0);
        }
}

static void commands_of_0_and_1_are_off_and_on_for_good(void)
{
    begin(2, false);
    run_to_group();
    for (unsigned k = 0; k < 5000; k++)
        TEST_ASSERT_TRUE(run(1.0));
    for (unsigned k = 0; k < 5000; k++)
        TEST_ASSERT_FALSE(run(0.0));
}

static void a_clock_that_stood_keeps_the_beat_of_the_groups(void)
{
    static const uint32_t stood[] = {2, 30, 59, 60, 61, 350};
    for (unsigned m = 0; m < sizeof stood / sizeof *stood; m++) {
        begin(3, false);
        run_to_group();
        bench_turn_after(stood[m]);
        uint32_t ms = group_ms - 1u + stood[m];
        unsigned changes = 0;
        for (unsigned k = 0; k < 4000; k++) {
            bool was = bench_on(pin);
            run(0.5);
            ms++;
            changes += was != bench_on(pin);
            if (was != bench_on(pin))
                TEST_ASSERT_EQUAL(0, ms % group_ms);
        }
        TEST_ASSERT_GREATER_THAN(50, changes);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_pin_changes_only_between_whole_groups);
    RUN_TEST(a_constant_command_owes_no_more_than_half_a_group);
    RUN_TEST(any_command_owes_no_more_than_one_and_a_half_groups);
    RUN_TEST(the_mean_over_an_hour_is_that_of_the_commands_to_half_a_group);
    RUN_TEST(on_true_mains_every_gate_has_as_many_half_waves_of_either_polarity);
    RUN_TEST(on_mains_off_their_frequency_no_two_gates_in_a_row_lean_to_the_same_side);
    RUN_TEST(commands_of_0_and_1_are_off_and_on_for_good);
    RUN_TEST(a_clock_that_stood_keeps_the_beat_of_the_groups);
    return UNITY_END();
}
