/* A loop that keeps swinging at rest is told from loads, setpoints and noise. The bounds are those of gmv_cycle.c: 0.5 % of span r.m.s.,
 * 25 times the mean square of what cannot be predicted (from 1 % on 4 times), windows of 32 steps. */
#include <math.h>

#include "kinds/gmv/gmv_cycle_state.h"
#include "unity.h"

#define SETTLED 10

static struct gmv_cycle cycle;

void setUp(void)
{
    gmv_cycle_begin(&cycle);
}

void tearDown(void) {}

typedef double (*signal)(unsigned t);

static double swing(unsigned t)
{
    return 0.03 * sin(6.283185307179586 * t / 9.0);
}

static double small_swing(unsigned t)
{
    return 0.3 * swing(t);
}

static double smaller_swing(unsigned t)
{
    return 0.1 * swing(t);
}

static double dying_swing(unsigned t)
{
    return 7 * swing(t) * exp(-(double)t / 30);
}

static double offset(unsigned t)
{
    (void)t;
    return 0.03;
}

static double load(unsigned t)
{
    return t % 200 < 10 ? 0 : 0.1 * exp(-((double)(t % 200) - 10) / 15);
}

/* Returns whether a cycle is found in 400 steps; prediction errors are `error` of either sign. */
static bool found(signal away, double error, unsigned setpoint_every)
{
    for (unsigned t = 0; t < 400; t++) {
        float setpoint = setpoint_every ? (float)(t / setpoint_every % 2u) : 0.5f;
        if (gmv_cycle_step(&cycle, setpoint, (float)away(t), (float)(t % 2 ? error : -error),
                           SETTLED))
            return true;
    }
    return false;
}

static void a_swing_that_goes_on_is_found_though_it_is_predicted_well(void)
{
    TEST_ASSERT_TRUE(found(swing, 0.002, 0));
    TEST_ASSERT_FLOAT_WITHIN(0.005f, 0.03f / 1.41f, gmv_cycle_size(&cycle));
    setUp();
    TEST_ASSERT_TRUE(found(swing, 0.01, 0)); /* a large one is not predicted as well */
}

static void a_small_one_is_nobodys_concern(void)
{
    TEST_ASSERT_FALSE(found(smaller_swing, 0, 0));
}

static void one_that_dies_away_is_left_alone(void)
{
    TEST_ASSERT_FALSE(found(dying_swing, 0.0001, 0));
}

static void what_cannot_be_predicted_is_no_swing(void)
{
    TEST_ASSERT_FALSE(found(swing, 0.011, 0));
    setUp();
    TEST_ASSERT_FALSE(found(small_swing, 0.002, 0));
}

static void a_load_is_no_swing(void)
{
    TEST_ASSERT_FALSE(found(load, 0.0001, 0));
}

static void what_stays_away_is_no_swing(void)
{
    TEST_ASSERT_FALSE(found(offset, 0.0001, 0));
}

static void while_setpoints_move_nothing_is_judged(void)
{
    TEST_ASSERT_FALSE(found(swing, 0.002, 60));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_swing_that_goes_on_is_found_though_it_is_predicted_well);
    RUN_TEST(a_small_one_is_nobodys_concern);
    RUN_TEST(one_that_dies_away_is_left_alone);
    RUN_TEST(what_cannot_be_predicted_is_no_swing);
    RUN_TEST(a_load_is_no_swing);
    RUN_TEST(what_stays_away_is_no_swing);
    RUN_TEST(while_setpoints_move_nothing_is_judged);
    return UNITY_END();
}
