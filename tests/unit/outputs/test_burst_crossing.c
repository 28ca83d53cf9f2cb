/* Burst outputs with a pin for the zero crossings: what a solid-state relay that switches at zero makes of them, on mains of any frequency, behind
 * detectors that are early, late, bounce and miss; and what is told.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs/mains.h"
#include "outputs_bench.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>

#define CROSSING 100u
#define PIN      48u

/* Mains and a detector. Times in ms. */
static struct {
    double hz, next; /* next crossing */
    bool positive;   /* the half wave behind it */
    bool both;       /* the detector sees both half waves */
    double delay;    /* of its edge */
    double jitter;
    double pending; /* an edge that is still to come; below 0: none */
    double bounce;  /* a second edge so much later; 0: none */
    double missed;  /* part of the edges that do not come, never two in a row */
    bool missed_last, dead;
    double now;
} mains;
static double bounce_at;
static struct random_source random_source;
static unsigned cycles;

/* What the relay has let through. */
static struct {
    unsigned halves, positive; /* half waves, and those of them that are positive */
    unsigned run, odd_runs;    /* half waves of the present run, and runs of an odd number */
    double nearest;            /* a change of the pin to a crossing, ms */
    bool was_on;
} relay;

static double uniform(double lo, double hi)
{
    return lo + (hi - lo) * random_below(&random_source, 1000001) / 1e6;
}

static void a_half_wave_begins(void)
{
    bool on = bench_on(PIN);
    relay.halves += on;
    relay.positive += on && mains.positive;
    if (!on && relay.run % 2u != 0)
        relay.odd_runs++;
    relay.run = on ? relay.run + 1u : 0;
}

static void pass_edges(double until)
{
    if (mains.pending >= 0 && mains.pending < until) {
        bench_edges[CROSSING]++;
        if (mains.bounce > 0)
            bounce_at = mains.pending + mains.bounce;
        mains.pending = -1;
    }
    if (bounce_at >= 0 && bounce_at < until) {
        bench_edges[CROSSING]++;
        bounce_at = -1;
    }
}

static void pass_mains(double until)
{
    pass_edges(fmin(until, mains.next));
    while (mains.next < until) {
        a_half_wave_begins();
        bool seen = (mains.both || mains.positive) && !mains.dead;
        bool misses = seen && !mains.missed_last && uniform(0, 1) < mains.missed;
        if (seen)
            mains.missed_last = misses;
        if (seen && !misses)
            mains.pending = mains.next + mains.delay + uniform(-mains.jitter, mains.jitter);
        mains.positive = !mains.positive;
        mains.next += 500.0 / mains.hz;
    }
    pass_edges(until);
    mains.now = until;
}

static void run(double command, unsigned ms)
{
    for (unsigned k = 0; k < ms; k++) {
        pass_mains(mains.now + 1.0);
        outputs_command(0, true, (float)command);
        bench_turn();
        if (bench_on(PIN) != relay.was_on) {
            double half = 500.0 / mains.hz, ahead = mains.next - mains.now;
            double near = fmin(fabs(ahead), fabs(half - ahead));
            relay.nearest = fmin(relay.nearest, near);
        }
        relay.was_on = bench_on(PIN);
    }
}

static void forget_relay(void)
{
    relay.halves = relay.positive = relay.odd_runs = 0;
    relay.nearest = 1e9;
}

static void begin(double hz, bool both)
{
    bench_begin();
    mains = (typeof(mains)){.hz = hz, .next = uniform(1, 9), .both = both, .pending = -1};
    bounce_at = -1;
    relay = (typeof(relay)){.nearest = 1e9};
    struct output_settings s = bench_settings(OUTPUT_BURST, 3);
    s.pin[OUTPUT_CROSSING] = CROSSING;
    s.mains_60 = hz > 55.0;
    cycles = s.mains_60 ? 3u : 1u + random_below(&random_source, 8);
    s.cycles = (float)cycles;
    TEST_ASSERT_EQUAL(PIN, s.pin[OUTPUT_PIN]);
    bench_open(&s, 1);
}

static void begin_at_random(uint32_t seed)
{
    random_source = bench_random(seed);
    begin(uniform(45.1, 64.9), random_below(&random_source, 2));
    mains.delay = uniform(0.3, 1.0);
    if (random_below(&random_source, 2))
        mains.delay = -mains.delay;
    if (mains.delay < 0) /* an edge ahead of a crossing is one behind the crossing before */
        mains.delay += 500.0 / mains.hz * (mains.both ? 1 : 2);
    mains.jitter = 0.1;
}

void setUp(void)
{
    random_source = bench_random(1);
}
void tearDown(void)
{
    bench_tell_seed();
}

/* ---- whole cycles ---- */

static void the_relay_lets_whole_cycles_through(void)
{
    for (uint32_t seed = 1; seed <= 200; seed++) {
        begin_at_random(seed);
        run(0.0, 2500);
        TEST_ASSERT_EQUAL(0, outputs_faults(0));
        forget_relay();
        run(uniform(0.05, 0.95), 10000);
        TEST_ASSERT_EQUAL(0, relay.odd_runs);
        TEST_ASSERT_TRUE(relay.halves > 10);
        TEST_ASSERT_INT_WITHIN(1, relay.halves, 2 * relay.positive);
    }
}

static void the_pin_switches_far_from_each_crossing(void)
{
    for (uint32_t seed = 1; seed <= 200; seed++) {
        begin_at_random(seed);
        run(0.0, 2500);
        forget_relay();
        run(0.5, 5000);
        TEST_ASSERT_TRUE(relay.nearest > 0.8);
    }
}

static void the_mean_is_the_command(void)
{
    for (uint32_t seed = 1; seed <= 50; seed++) {
        begin_at_random(seed);
        double command = uniform(0, 1);
        run(command, 2500);
        (void)outputs_readback(0);
        run(command, 60000);
        double group_ms = cycles * 1000.0 / mains.hz;
        TEST_ASSERT_DOUBLE_WITHIN((1.5 * group_ms + 5) / 60000.0, command, outputs_readback(0));
    }
}

static void groups_have_their_cycles_at_each_frequency(void)
{
    static const double hz[] = {45.2, 49.7, 50.0, 50.3, 59.9, 60.0, 64.8};
    for (unsigned k = 0; k < sizeof hz / sizeof *hz; k++) {
        begin(hz[k], k % 2);
        run(0.0, 2500);
        forget_relay();
        run(0.5, 20000); /* on and off in turn */
        double groups = 20.0 * hz[k] / cycles;
        TEST_ASSERT_DOUBLE_WITHIN(2.0 * cycles, groups * cycles, relay.halves);
        TEST_ASSERT_EQUAL(0, relay.odd_runs);
    }
}

/* ---- bounces, misses ---- */

static void bounces_change_nothing(void)
{
    for (uint32_t seed = 1; seed <= 100; seed++) {
        begin_at_random(seed);
        mains.bounce = uniform(0.5, 4.0);
        run(0.0, 2500);
        TEST_ASSERT_FLOAT_WITHIN(0.1f, (float)mains.hz, outputs_mains(0));
        forget_relay();
        run(0.4, 10000);
        TEST_ASSERT_EQUAL(0, relay.odd_runs);
    }
}

static void an_edge_that_does_not_come_now_and_then_changes_nothing(void)
{
    for (uint32_t seed = 1; seed <= 100; seed++) {
        begin_at_random(seed);
        run(0.0, 2500);
        mains.missed = 0.05;
        forget_relay();
        run(0.4, 10000);
        TEST_ASSERT_EQUAL(0, relay.odd_runs);
        TEST_ASSERT_FLOAT_WITHIN(0.2f, (float)mains.hz, outputs_mains(0));
    }
}

/* ---- what is told ---- */

static void the_frequency_is_measured_from_45_to_65_hertz(void)
{
    for (double hz = 45.1; hz < 65.0; hz += 0.7) {
        for (unsigned both = 0; both < 2; both++) {
            begin(hz, both);
            run(0.0, 2500);
            TEST_ASSERT_FLOAT_WITHIN(0.1f, (float)hz, outputs_mains(0));
            TEST_ASSERT_EQUAL(0, outputs_faults(0));
        }
    }
}

static void other_frequencies_are_no_mains(void)
{
    static const double hz[] = {5, 20, 30, 40, 44.5, 65.5, 70, 85, 200, 400};
    for (unsigned k = 0; k < sizeof hz / sizeof *hz; k++) {
        begin(50, k % 2);
        mains.hz = hz[k];
        run(0.0, 5000);
        TEST_ASSERT_EQUAL_FLOAT(0.0f, outputs_mains(0));
        TEST_ASSERT_EQUAL(OUTPUT_NO_CROSSING, outputs_faults(0));
    }
}

static void mains_that_were_never_there_are_told_after_three_seconds_and_groups_run_free(void)
{
    begin(50, true);
    mains.dead = true;
    run(0.5, 2900);
    TEST_ASSERT_EQUAL(0, outputs_faults(0));
    run(0.5, 200);
    TEST_ASSERT_EQUAL(OUTPUT_NO_CROSSING, outputs_faults(0));
    (void)outputs_readback(0);
    run(0.5, 10000);
    TEST_ASSERT_FLOAT_WITHIN(0.05f, 0.5f, outputs_readback(0));
}

static void mains_that_are_lost_are_told_at_once_and_found_again(void)
{
    for (unsigned both = 0; both < 2; both++) {
        begin(50, both);
        run(0.5, 3000);
        TEST_ASSERT_EQUAL(0, outputs_faults(0));
        mains.dead = true;
        run(0.5, MAINS_LOST_MS + 25u);
        TEST_ASSERT_EQUAL(OUTPUT_NO_CROSSING, outputs_faults(0));
        TEST_ASSERT_EQUAL_FLOAT(0.0f, outputs_mains(0));
        (void)outputs_readback(0);
        run(0.5, 20000);
        TEST_ASSERT_FLOAT_WITHIN(0.03f, 0.5f, outputs_readback(0));
        mains.dead = false;
        run(0.5, 1200);
        TEST_ASSERT_EQUAL(0, outputs_faults(0));
        TEST_ASSERT_FLOAT_WITHIN(0.1f, 50.0f, outputs_mains(0));
    }
}

static void a_pin_that_cannot_count_is_told_and_groups_run_free(void)
{
    bench_begin();
    bench_pins[CROSSING].refuses = true;
    struct output_settings s = bench_settings(OUTPUT_BURST, 3);
    s.pin[OUTPUT_CROSSING] = CROSSING;
    bench_open(&s, 1);
    for (unsigned k = 0; k < 4000; k++) {
        outputs_command(0, true, 0.5f);
        bench_turn();
    }
    TEST_ASSERT_EQUAL(OUTPUT_NO_CROSSING, outputs_faults(0));
    TEST_ASSERT_FLOAT_WITHIN(0.05f, 0.5f, outputs_readback(0));
}

static void without_the_pin_nothing_is_told(void)
{
    bench_begin();
    struct output_settings s = bench_settings(OUTPUT_BURST, 3);
    bench_open(&s, 1);
    for (unsigned k = 0; k < 5000; k++)
        bench_turn();
    TEST_ASSERT_EQUAL(0, outputs_faults(0));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, outputs_mains(0));
}

static void a_command_of_0_and_a_safe_state_keep_the_mains(void)
{
    begin(50, true);
    run(1.0, 3000);
    outputs_safe();
    run(1.0, 5000);
    TEST_ASSERT_FALSE(bench_on(PIN));
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 50.0f, outputs_mains(0));
    outputs_resume();
    forget_relay();
    run(0.5, 5000);
    TEST_ASSERT_EQUAL(0, relay.odd_runs);
    TEST_ASSERT_TRUE(relay.halves > 100);
}

/* ---- settings ---- */

static void several_outputs_may_have_the_same_crossings_and_nothing_else(void)
{
    struct output_problem problem;
    struct output_settings s[2] = {bench_settings(OUTPUT_BURST, 3),
                                   bench_settings(OUTPUT_BURST, 4)};
    bench_begin();
    s[0].pin[OUTPUT_CROSSING] = s[1].pin[OUTPUT_CROSSING] = CROSSING;
    TEST_ASSERT_TRUE(output_check(s, 2, 1, &problem));
    bench_open(s, 2);
    s[1].pin[OUTPUT_PIN] = CROSSING;
    s[1].pin[OUTPUT_CROSSING] = HAL_PIN_NONE;
    TEST_ASSERT_FALSE(output_check(s, 2, 1, &problem));
    TEST_ASSERT_EQUAL_STRING("another output has the same pin", problem.words);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_relay_lets_whole_cycles_through);
    RUN_TEST(the_pin_switches_far_from_each_crossing);
    RUN_TEST(the_mean_is_the_command);
    RUN_TEST(groups_have_their_cycles_at_each_frequency);
    RUN_TEST(bounces_change_nothing);
    RUN_TEST(an_edge_that_does_not_come_now_and_then_changes_nothing);
    RUN_TEST(the_frequency_is_measured_from_45_to_65_hertz);
    RUN_TEST(other_frequencies_are_no_mains);
    RUN_TEST(mains_that_were_never_there_are_told_after_three_seconds_and_groups_run_free);
    RUN_TEST(mains_that_are_lost_are_told_at_once_and_found_again);
    RUN_TEST(a_pin_that_cannot_count_is_told_and_groups_run_free);
    RUN_TEST(without_the_pin_nothing_is_told);
    RUN_TEST(a_command_of_0_and_a_safe_state_keep_the_mains);
    RUN_TEST(several_outputs_may_have_the_same_crossings_and_nothing_else);
    return UNITY_END();
}
