/* commission/swing.[ch]: half cycles that decay, and such that do not. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "commission/swing.h"
#include "commission/swing_state.h"
#include "step_records.h"
#include "unity.h"

#define SEED 20260731u
#define TAU  6.283185307179586

static struct swing w;
static struct random_source noise;

void setUp(void)
{
    memset(&w, 0, sizeof w);
    noise.state = SEED;
}
void tearDown(void) {}

/* A setpoint step of 1 answered by a second order of that damping after a dead time; samples of the period's fiftieth part. */
static bool grows(double damping, double noise_sd, unsigned samples)
{
    memset(&w, 0, sizeof w);
    double root = sqrt(1.0 - damping * damping), omega = TAU / 50.0 / root;
    for (unsigned n = 0; n < samples; n++) {
        double t = n > 10 ? omega * (n - 10.0) : 0.0;
        double error = exp(-damping * t) * (cos(root * t) + damping / root * sin(root * t));
        if (noise_sd > 0.0)
            error += noise_sd * normal(&noise);
        swing_step(&w, (real_t)error, &swing_accepted, (real_t)noise_sd, 0);
    }
    swing_end(&w, &swing_accepted, (real_t)noise_sd, 0);
    return w.grows;
}

/* exp(-pi zeta / sqrt(1 - zeta^2)) = 0.7 at 0.1128 */
static void the_damping_decides(void)
{
    TEST_ASSERT_TRUE(grows(-0.02, 0.0, 300));
    TEST_ASSERT_TRUE(grows(0.0, 0.0, 300));
    TEST_ASSERT_TRUE(grows(0.105, 0.0, 300));
    TEST_ASSERT_FALSE(grows(0.12, 0.0, 300));
    TEST_ASSERT_FALSE(grows(0.3, 0.0, 300));
    TEST_ASSERT_FALSE(grows(0.9, 0.0, 300));
}

static void noise_alone_is_no_oscillation_and_hides_none(void)
{
    unsigned seen = 0;
    printf("seed %u\n", SEED);
    for (unsigned n = 0; n < 200; n++) {
        TEST_ASSERT_FALSE(grows(0.4, 0.125, 400)); /* an eighth of the step: the most a trial has */
        TEST_ASSERT_FALSE(grows(0.16, 0.125, 400)); /* half cycles of 0.6 */
        seen += grows(0.0, 0.125, 400);
    }
    TEST_ASSERT_TRUE(seen > 190);
}

/* Steady half cycles as given, 20 samples each; the last may be cut short. */
static bool half_cycles(const double *height, unsigned n, unsigned last)
{
    memset(&w, 0, sizeof w);
    for (unsigned k = 0; k < n; k++)
        for (unsigned i = 0; i < (k + 1 < n ? 20u : last); i++)
            swing_step(&w, (real_t)height[k], &swing_accepted, 0, 0);
    swing_end(&w, &swing_accepted, 0, 0);
    return w.grows;
}

static void two_half_cycles_in_a_row_are_held_against_those_before(void)
{
    TEST_ASSERT_FALSE(half_cycles((double[]){1, -0.69}, 2, 20));
    TEST_ASSERT_FALSE(half_cycles((double[]){1, -0.71, 0.49}, 3, 20));
    TEST_ASSERT_TRUE(half_cycles((double[]){1, -0.71, 0.51}, 3, 20));
    TEST_ASSERT_FALSE(half_cycles((double[]){-1, 0.3, -0.2, 0.15, -0.1}, 5,
                                  20)); /* one alone is another loop's */
    TEST_ASSERT_TRUE(half_cycles((double[]){-1, 0.3, -0.2, 0.15, -0.11}, 5, 20));
    TEST_ASSERT_FALSE(half_cycles((double[]){1, -0.5, 0.3, -0.3, 0.3}, 5, 13)); /* not over yet */
    TEST_ASSERT_TRUE(half_cycles((double[]){1, -0.5, 0.3, -0.3, 0.3}, 5, 15));
    TEST_ASSERT_TRUE(half_cycles((double[]){1, -0.5, 0.4, -0.4}, 4, 40));
    TEST_ASSERT_FALSE(half_cycles((double[]){1, -0.5, 0.4, -0.4}, 4, 41)); /* a tail */
    /* Swings below a twentieth of the largest do not matter. */
    TEST_ASSERT_FALSE(half_cycles((double[]){1, -0.04, 0.04, -0.04}, 4, 20));
    TEST_ASSERT_TRUE(half_cycles((double[]){1, -0.06, 0.06, -0.06}, 4, 20));
}

static void a_slow_tail_is_no_oscillation(void)
{
    for (unsigned n = 0; n < 400; n++) /* at the setpoint after 20, past it by a tenth for long */
        swing_step(&w, n < 20 ? REAL_C(1.0) : REAL_C(-0.1), &swing_accepted, 0, 0);
    swing_end(&w, &swing_accepted, 0, 0);
    TEST_ASSERT_FALSE(w.grows);
}

static void a_constant_part_that_may_be_there_is_left_out(void)
{
    memset(&w, 0, sizeof w);
    for (unsigned i = 0; i < 20; i++)
        swing_step(&w, REAL_C(1.0), &swing_accepted, 0, REAL_C(0.1));
    for (unsigned i = 0; i < 20; i++)
        swing_step(&w, REAL_C(-0.85), &swing_accepted, 0, REAL_C(0.1));
    swing_end(&w, &swing_accepted, 0, REAL_C(0.1));
    TEST_ASSERT_FALSE(w.grows); /* 0.85 20 - 0.1 40 < 0.7 20 */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_damping_decides);
    RUN_TEST(noise_alone_is_no_oscillation_and_hides_none);
    RUN_TEST(two_half_cycles_in_a_row_are_held_against_those_before);
    RUN_TEST(a_slow_tail_is_no_oscillation);
    RUN_TEST(a_constant_part_that_may_be_there_is_left_out);
    return UNITY_END();
}
