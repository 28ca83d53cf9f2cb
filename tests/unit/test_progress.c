/* commission/progress.[ch]: when a step has gone on for long enough and whether it is large enough, on either side of each
 * bound, from models and samples that are made up. */
#include <math.h>
#include <string.h>

#include "commission/experiment_state.h"
#include "commission/origin_state.h"
#include "commission/progress.h"
#include "unity.h"

static struct experiment e;
static real_t y[3];

/* One output of two that answers: over after 100 s, 10 noise deviations high. */
void setUp(void)
{
    memset(&e, 0, sizeof e);
    e.config.outputs = 2;
    e.config.h_s = 2;
    e.config.window = 60;
    e.config.half_least = 40;
    e.config.half_most = 1000;
    e.config.noise_multiple = 20;
    e.config.amplitude_max = REAL_C(0.25);
    e.phase = EXPERIMENT_UP;
    e.amplitude = REAL_C(0.02);
    for (unsigned j = 0; j < 2; j++) {
        e.config.limit[j] = REAL_C(0.2);
        e.before[j].noise_sd = REAL_C(0.002);
        e.interim_fit.found[j].flags = IDENTIFIED_NO_GAIN;
        e.rest[j] = y[j] = REAL_C(0.5);
    }
    e.config.limit[2] = REAL_C(0.001); /* of no output */
    e.before[2].noise_sd = REAL_C(1e-5);
    y[2] = e.drift_per_s[2] = 1;
    e.interim_fit.found[1] = (struct identified){.gain = 1,
                                                 .gain_sd = REAL_C(0.01),
                                                 .time_constant_s = 30,
                                                 .time_constant_sd_s = 1,
                                                 .dead_time_s = 10};
}
void tearDown(void) {}

static void says(enum progress_verdict what, double amplitude, bool small)
{
    struct progress_advice a = progress_judge(&e, y);
    TEST_ASSERT_EQUAL_INT(what, a.verdict);
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, amplitude, (double)a.amplitude);
    TEST_ASSERT_EQUAL(small, a.small);
}

#define WAITS(small)     says(PROGRESS_WAIT, (double)e.amplitude, small)
#define TURNS(small)     says(PROGRESS_TURN, (double)e.amplitude, small)
#define GROWS(amplitude) says(PROGRESS_GROW, amplitude, false)

static void noise_matters_from_a_quarter_of_a_limit_that_it_asks_for(void)
{
    TEST_ASSERT_FALSE(progress_is_noisy(&e));
    e.before[1].noise_sd = REAL_C(0.00249); /* 20 of them: 0.0498 of 0.05 */
    TEST_ASSERT_FALSE(progress_is_noisy(&e));
    e.before[1].noise_sd = REAL_C(0.00251);
    TEST_ASSERT_TRUE(progress_is_noisy(&e));
    e.config.limit[1] = REAL_C(0.25);
    e.config.noise_multiple = 16;
    e.before[1].noise_sd = REAL_C(1.0) / 256; /* a quarter itself is not more */
    TEST_ASSERT_FALSE(progress_is_noisy(&e));
    e.before[1].noise_sd = REAL_C(0.00392);
    TEST_ASSERT_TRUE(progress_is_noisy(&e));
    e.config.outputs = 1;
    TEST_ASSERT_FALSE(progress_is_noisy(&e));
    e.before[0].noise_sd = REAL_C(0.00314); /* of a limit of 0.2 */
    TEST_ASSERT_TRUE(progress_is_noisy(&e));
}

static void a_gain_is_known_within_a_third(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        struct identified f = {.gain = (real_t)sign, .gain_sd = REAL_C(0.329)};
        TEST_ASSERT_TRUE(interim_fit_is_known(&f));
        f.flags = IDENTIFIED_NO_GAIN;
        TEST_ASSERT_FALSE(interim_fit_is_known(&f));
        f.flags = IDENTIFIED_INTEGRATING;
        TEST_ASSERT_FALSE(interim_fit_is_known(&f));
        f.flags = IDENTIFIED_SHORT | IDENTIFIED_OSCILLATORY;
        TEST_ASSERT_TRUE(interim_fit_is_known(&f));
        f.gain_sd = REAL_C(0.7);
        f.gain *= REAL_C(2.2);
        TEST_ASSERT_TRUE(interim_fit_is_known(&f));
        f.gain_sd = REAL_C(0.73);
        TEST_ASSERT_FALSE(interim_fit_is_known(&f));
    }
}

/* ---- how long ---- */

static void dead_time_and_three_time_constants_are_long_enough(void)
{
    e.config.amplitude = REAL_C(0.02); /* given: it is as large as it is to be */
    e.half = 49;
    WAITS(false);
    e.half = 50;
    TURNS(false);
    e.small = true; /* stays as it was */
    TURNS(true);
    e.small = false;
    e.config.half_least = 51;
    WAITS(false);
    e.config.half_least = 50;
    e.interim_fit.found[0] = e.interim_fit.found[1]; /* the slower of the two */
    e.interim_fit.found[0].time_constant_s = 33;
    e.half = 54;
    WAITS(false);
    e.half = 55;
    TURNS(false);
    e.interim_fit.found[0].time_constant_s = 27;
    e.half = 50;
    TURNS(false);
}

/* Makes output 0 unknown: the time of output 1 half as long again. */
static void unknown(bool is)
{
    e.half = is ? 74 : 49;
    WAITS(false);
    e.half = is ? 75 : 50;
    TURNS(false);
}

static void what_is_not_known_gets_half_as_long_again(void)
{
    e.config.amplitude = REAL_C(0.02);
    struct identified *f = &e.interim_fit.found[0];
    *f = e.interim_fit.found[1];
    unknown(false);
    f->gain_sd = REAL_C(0.329);
    unknown(false);
    f->gain_sd = REAL_C(0.331);
    unknown(true);
    f->gain_sd = REAL_C(0.01);
    f->time_constant_sd_s = REAL_C(16.6); /* three of them are half of 100 s */
    unknown(false);
    f->time_constant_sd_s = REAL_C(16.7);
    unknown(true);
    e.drift_per_s[0] = REAL_C(1e-6); /* half of the time constant itself */
    f->time_constant_sd_s = REAL_C(14.9);
    unknown(false);
    f->time_constant_sd_s = REAL_C(15.1);
    unknown(true);
    e.drift_per_s[0] = 0;
    f->time_constant_sd_s = 1;
    f->gain = REAL_C(-0.501); /* five deviations of noise: 0.01 */
    unknown(false);
    f->gain = REAL_C(-0.499);
    unknown(true);
    f->flags = IDENTIFIED_NO_GAIN; /* nothing there is nothing to wait for */
    unknown(false);
}

static void where_nothing_is_known_only_a_drift_ends_it(void)
{
    e.config.amplitude = REAL_C(0.02);
    e.interim_fit.found[1].gain_sd = REAL_C(0.5);
    e.half = 159;
    e.drift_per_s[0] = REAL_C(-1e-6);
    WAITS(false);
    e.half = 160; /* four times the least */
    TURNS(false);
    e.drift_per_s[0] = 0;
    WAITS(false);
    e.drift_per_s[1] = REAL_C(1e-6);
    TURNS(false);
    e.interim_fit.found[0] = e.interim_fit.found[1];
    e.interim_fit.found[0].gain_sd = REAL_C(0.01);
    e.interim_fit.found[0].time_constant_s = 100; /* known: it has an end */
    WAITS(false);
}

/* ---- how large ---- */

static void it_grows_to_a_fifth_more_than_the_noise_asks_for(void)
{
    e.half = 30;
    GROWS(0.048); /* 1.2 times 20 deviations, of which it has 10 */
    e.half = 29;  /* half a window at least */
    WAITS(false);
    e.half = 30;
    e.interim_fit.found[0] = e.interim_fit.found[1]; /* the one that stands out most decides */
    e.interim_fit.found[0].gain = REAL_C(-1.25);
    GROWS(0.0384);
    e.before[0].noise_sd = REAL_C(0.004);
    GROWS(0.048);
    e.interim_fit.found[0].flags = IDENTIFIED_NO_GAIN;
    e.before[1].noise_sd = REAL_C(0.02) / REAL_C(19.9);
    GROWS(0.02 * 24.0 / 19.9);
    e.before[1].noise_sd = REAL_C(0.02) / REAL_C(20.1);
    GROWS(0.024); /* a tenth of the limit at least, and a fifth more */
    e.config.limit[1] = REAL_C(0.19);
    WAITS(false); /* it stands out: go on until it is over */
    e.half = 50;
    TURNS(false);
}

static void it_grows_four_times_at_most(void)
{
    e.half = 30;
    e.before[1].noise_sd = REAL_C(0.02) / REAL_C(5.9);
    GROWS(0.08);
    e.before[1].noise_sd = REAL_C(0.02) / REAL_C(6.1);
    GROWS(0.02 * 24.0 / 6.1);
    e.before[1].noise_sd = REAL_C(0.02) / REAL_C(5.1);
    GROWS(0.08);
}

static void there_are_edges_for_so_many_steps(void)
{
    e.half = 30;
    e.record.input.edges = EXCITATION_EDGES_MAX - 3u;
    GROWS(0.048);
    e.record.input.edges++; /* up, down and back take two more */
    WAITS(false);
}

static void it_grows_no_farther_than_there_is_room(void)
{
    e.half = 30;
    e.config.amplitude_max = REAL_C(0.03);
    GROWS(0.03);
    e.config.amplitude_max = REAL_C(0.0221);
    GROWS(0.0221);
    e.config.amplitude_max = REAL_C(0.0219); /* less than a tenth more is not worth it */
    WAITS(true);
    e.half = 50;
    TURNS(true);
}

static void no_output_is_taken_past_07_of_its_room(void)
{
    double most = 1.02 * 0.02 + 0.002; /* with two deviations of the gain and one of the noise */
    e.half = 30;
    e.config.limit[1] = REAL_C(0.05);
    GROWS(0.02 * 0.7 * 0.05 / most);
    /* The test so far, the reversal included, counts for all outputs. */
    e.config.limit[1] = REAL_C(0.2);
    e.config.limit[0] = REAL_C(0.05);
    y[0] = REAL_C(0.5175);
    GROWS(0.04);
    y[0] = REAL_C(0.4825);
    GROWS(0.04);
    e.limits.low[0] = REAL_C(-1.75);
    y[0] = REAL_C(0.4999999);
    WAITS(true); /* 0.07 to the other side */
    e.config.limit[0] = REAL_C(0.2);
    GROWS(0.04);
    struct origin origin = {.fixed = true};
    e.limits.low[0] = 0;
    origin.channel[1].left = REAL_C(0.15);
    e.config.origin = &origin;
    GROWS(0.02 * 0.7 * 0.05 / most);
}

/* The means of the two halves of the present level, 30 samples each. */
static void moves(unsigned j, double first, double second)
{
    e.record.block = 1;
    e.record.h_s = 2;
    e.record.points = 61;
    e.record.input.edges = 1;
    for (unsigned i = 1; i < 61; i++)
        e.record.y[j][i] = (real_t)(i < 31 ? first : second);
}

static void without_a_model_it_grows_by_what_was_seen_to_move(void)
{
    const double sd = 4.5 * 0.002 / sqrt(30.0);
    e.interim_fit.found[1].gain_sd = REAL_C(0.5);
    moves(1, 0.0, 0.0);
    e.half = 29; /* half a window at least */
    WAITS(false);
    e.half = 30;
    GROWS(0.08);
    e.record.input.edges = 2; /* once it has grown a whole one */
    e.record.input.edge[1].sample = 0;
    WAITS(false);
    e.half = 60;
    GROWS(0.08);
    moves(1, 0.001, 0.002); /* 0.005 ahead, and three deviations of that */
    GROWS(0.06);
    moves(1, -0.005, -0.01); /* 0.025 of 0.048 */
    GROWS(0.02 * 0.048 / (0.025 + sd));
    moves(1, 0.0, 0.0);
    moves(0, 0.005, 0.01); /* any output */
    GROWS(0.02 * 0.048 / (0.025 + sd));
    e.config.limit[0] = REAL_C(0.08); /* half of it */
    GROWS(0.02 * 0.04 / (0.025 + sd));
    e.config.limit[0] = REAL_C(0.079); /* less than half as much again is not worth it */
    WAITS(true);
    moves(0, 0.0, 0.0);
    e.config.amplitude_max = REAL_C(0.031);
    GROWS(0.031);
    e.config.amplitude_max = REAL_C(0.0299);
    WAITS(true);
}

static void a_drift_is_no_motion_and_makes_it_grow_sooner(void)
{
    e.interim_fit.found[1].gain_sd = REAL_C(0.5);
    moves(1, 0.0, 0.0);
    for (unsigned i = 1; i < 61; i++)
        e.record.y[1][i] = REAL_C(1e-3) * (real_t)i;
    e.half = 60;
    says(PROGRESS_WAIT, 0.02, true);
    e.drift_per_s[1] = REAL_C(5e-4);
    GROWS(0.12); /* six times */
    e.record.input.edges = 2;
    e.half = 30;
    GROWS(0.12);
    e.half = 29;
    WAITS(false);
}

static void a_half_that_is_long_enough_goes_on_for_a_known_response_only(void)
{
    e.config.amplitude = REAL_C(0.02);
    e.config.half_plenty = 100;
    e.interim_fit.found[1].gain_sd = REAL_C(0.5);
    e.half = 99;
    WAITS(false);
    e.half = 100;
    TURNS(false);
    e.config.half_least = 101;
    WAITS(false);
    e.config.half_least = 40;
    e.interim_fit.found[1].time_constant_s = 100; /* 0.003 is still to come */
    TURNS(false);
    e.before[1].noise_sd = REAL_C(0.001);
    WAITS(false);
    e.config.half_plenty = 0;
    e.half = 5000;
    WAITS(false);
    e.interim_fit.found[1].flags = IDENTIFIED_NO_GAIN;
    e.before[1].noise_sd = REAL_C(0.002);
    y[1] = REAL_C(0.6); /* moved, by whatever it was */
    WAITS(true);
    e.config.half_plenty = 100;
    TURNS(true);
}

/* ---- nothing to be seen ---- */

static void where_nothing_is_seen_it_waits_for_a_dead_time_and_grows(void)
{
    e.interim_fit.found[1].flags = IDENTIFIED_NO_GAIN;
    moves(1, 0.0, 0.0);
    e.half = 119; /* two windows */
    WAITS(false);
    e.config.half_most = 120; /* or three quarters of the longest half */
    e.half = 89;
    WAITS(false);
    e.half = 90;
    GROWS(0.08);
    e.config.half_most = 1000;
    e.half = 120;
    GROWS(0.08);
    e.before[0].noise_sd = REAL_C(0.003); /* where there is noise nothing is no dead time */
    e.half = 29;
    WAITS(false);
    e.half = 30;
    GROWS(0.08);
    /* As large as it is to be: six windows more, and longer where it has moved. */
    e.config.amplitude = REAL_C(0.02);
    e.half = 39; /* the least */
    WAITS(false);
    e.half = 40;
    WAITS(true);
    e.half = 399;
    WAITS(true);
    e.half = 400;
    TURNS(true);
    y[1] = REAL_C(0.5101); /* five deviations */
    TURNS(true);
    e.before[0].noise_sd = REAL_C(0.002);
    WAITS(true);
    y[1] = REAL_C(0.5099);
    TURNS(true);
    y[0] = REAL_C(0.4899);
    WAITS(true);
}

static void what_was_small_before_is_said_while_it_waits(void)
{
    e.interim_fit.found[1].flags = IDENTIFIED_NO_GAIN;
    e.half = 100;
    e.small = true;
    WAITS(true);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(noise_matters_from_a_quarter_of_a_limit_that_it_asks_for);
    RUN_TEST(a_gain_is_known_within_a_third);
    RUN_TEST(dead_time_and_three_time_constants_are_long_enough);
    RUN_TEST(what_is_not_known_gets_half_as_long_again);
    RUN_TEST(where_nothing_is_known_only_a_drift_ends_it);
    RUN_TEST(it_grows_to_a_fifth_more_than_the_noise_asks_for);
    RUN_TEST(it_grows_four_times_at_most);
    RUN_TEST(there_are_edges_for_so_many_steps);
    RUN_TEST(it_grows_no_farther_than_there_is_room);
    RUN_TEST(no_output_is_taken_past_07_of_its_room);
    RUN_TEST(without_a_model_it_grows_by_what_was_seen_to_move);
    RUN_TEST(a_drift_is_no_motion_and_makes_it_grow_sooner);
    RUN_TEST(a_half_that_is_long_enough_goes_on_for_a_known_response_only);
    RUN_TEST(where_nothing_is_seen_it_waits_for_a_dead_time_and_grows);
    RUN_TEST(what_was_small_before_is_said_while_it_waits);
    return UNITY_END();
}
