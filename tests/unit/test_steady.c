/* identify/steady.[ch].
 *
 * Contract (both scalar types)
 *   white noise          noise_sd within 10 % (95 of 100 windows of 320 samples), called settled in 98 of 100
 *   drift and level      right within 3 of their stated standard deviations in 97 of 100
 *   a response           never called settled while it moved by more than 6 noise deviations within the window
 */
#include <string.h>

#include "identify/common.h"
#include "identify/steady.h"
#include "step_records.h"
#include "unity.h"

#define SEED 20240610u

static struct steady steady;

void setUp(void) {}
void tearDown(void) {}

static void start(uint32_t outputs, uint32_t block)
{
    struct steady_config c = {outputs, block, 1, (real_t)7e-5, 3, 4};
    TEST_ASSERT_EQUAL_INT(ERR_OK, steady_init(&steady, &c));
}

static void step_one(double y)
{
    real_t value = (real_t)y;
    TEST_ASSERT_EQUAL_INT(ERR_OK, steady_step(&steady, &value));
}

static struct steady_result look(uint32_t output)
{
    struct steady_result r;
    TEST_ASSERT_EQUAL_INT(ERR_OK, steady_look(&steady, output, &r));
    return r;
}

static void before_the_window_is_full_there_is_no_verdict(void)
{
    start(1, 10);
    for (int k = 0; k < 159; k++) {
        step_one(0.5);
        TEST_ASSERT_EQUAL_INT(STEADY_NOT_ENOUGH, look(0).state);
    }
    step_one(0.5);
    TEST_ASSERT_EQUAL_INT(STEADY_SETTLED, look(0).state);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 7e-5, (double)look(0).noise_sd);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, (double)look(0).mean);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 79.5, (double)look(0).age_s);
    steady_reset(&steady);
    step_one(0.7);
    TEST_ASSERT_EQUAL_INT(STEADY_NOT_ENOUGH, look(0).state);
}

static void noise_level_and_drift_are_measured_with_their_deviations(void)
{
    struct random_source source = {SEED};
    int settled = 0, noise_right = 0, slope_right = 0, level_right = 0, mean_right = 0;
    const double sd = 0.005;
    for (int i = 0; i < 500; i++) {
        double drift = 0.02 * sd / 320.0 * (i % 50); /* up to one deviation over the window */
        start(1, 20);
        for (int k = 0; k < 480; k++) /* the ring goes round */
            step_one(0.4 + drift * k + sd * normal(&source));
        struct steady_result r = look(0);
        settled += r.state == STEADY_SETTLED;
        noise_right += fabs((double)r.noise_sd / sd - 1.0) < 0.1;
        slope_right += fabs((double)r.slope_per_s - drift) < 3.0 * (double)r.slope_sd_per_s;
        mean_right += fabs((double)r.mean - 0.4 - drift * 319.5) < 3.0 * (double)r.mean_sd;
        level_right += fabs((double)r.level - 0.4 - drift * 479.0) < 6.0 * (double)r.mean_sd;
    }
    char text[120];
    snprintf(text, sizeof text, "of 500: settled %d, noise %d, slope %d, mean %d, level %d",
             settled, noise_right, slope_right, mean_right, level_right);
    TEST_MESSAGE(text);
    TEST_ASSERT_GREATER_THAN_INT(490, settled);
    TEST_ASSERT_GREATER_THAN_INT(475, noise_right);
    TEST_ASSERT_GREATER_THAN_INT(485, slope_right);
    TEST_ASSERT_GREATER_THAN_INT(485, mean_right);
    TEST_ASSERT_GREATER_THAN_INT(485, level_right);
}

/* Steps of all sizes and speeds, with and without noise: what the window sees to be still moving is not at rest. */
static void a_response_is_not_settled_before_it_is(void)
{
    struct random_source source = {SEED};
    int early = 0, verdicts = 0;
    for (int i = 0; i < 200; i++) {
        const double sd = i % 4 ? 0.004 : 0.0, floor_sd = 7e-5;
        struct test_element e = {1.0, spread_over(&source, 20.0, 400.0), 0.0};
        double size = spread_over(&source, 0.02, 0.5);
        start(1, 20);
        for (int k = 0; k < 4000; k++) {
            step_one(size * step_response(&e, k) + sd * normal(&source));
            if (k % 20 || look(0).state != STEADY_SETTLED)
                continue;
            /* what moved within the window */
            double motion = size * (step_response(&e, k) - step_response(&e, k - 320));
            verdicts++;
            early += motion > 6.0 * (sd > floor_sd ? sd : floor_sd);
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(10000, verdicts);
    TEST_ASSERT_EQUAL_INT(0, early);
}

static void a_response_settles_in_the_end(void)
{
    struct random_source source = {SEED};
    struct test_element e = {1.0, 80.0, 0.0};
    int settled = 0;
    for (int i = 0; i < 100; i++) {
        start(1, 20);
        for (int k = 0; k < 320 + 8 * 80; k++)
            step_one(0.1 * step_response(&e, k) + 0.002 * normal(&source));
        settled += look(0).state == STEADY_SETTLED;
    }
    TEST_ASSERT_GREATER_THAN_INT(97, settled);
}

static void a_climb_moves_and_a_bend_or_a_swing_is_restless(void)
{
    struct random_source source = {SEED};
    for (int i = 0; i < 100; i++) {
        start(3, 20);
        for (int k = 0; k < 320; k++) {
            real_t y[3] = {(real_t)(1e-4 * k + 0.004 * normal(&source)),
                           (real_t)(0.03 * sin(6.283 * k / 150.0) + 0.004 * normal(&source)),
                           (real_t)((k > 160 ? 0.03 : 0.0) + 0.004 * normal(&source))};
            TEST_ASSERT_EQUAL_INT(ERR_OK, steady_step(&steady, y));
        }
        TEST_ASSERT_EQUAL_INT(STEADY_MOVING, look(0).state);
        TEST_ASSERT_EQUAL_INT(STEADY_RESTLESS, look(1).state);
        TEST_ASSERT_EQUAL_INT(STEADY_RESTLESS, look(2).state);
        TEST_ASSERT_TRUE(look(1).variance_ratio > 4);
    }
}

/* 12 bits: a drift slower than the resolution shows as steps of one count. */
static void quantisation_is_not_taken_for_motion(void)
{
    struct random_source source = {SEED};
    const double count = 1.0 / 4096.0;
    int settled = 0;
    for (int i = 0; i < 200; i++) {
        double phase = uniform(&source, 0.0, 1.0), sd = i % 2 ? 0.002 : 0.0;
        start(1, 20);
        for (int k = 0; k < 320; k++) {
            double y =
                0.3 + count * (phase + (i % 2 ? 0.0 : 0.2) * k / 320.0) + sd * normal(&source);
            step_one(floor(y / count + 0.5) * count);
        }
        settled += look(0).state == STEADY_SETTLED;
    }
    TEST_ASSERT_GREATER_THAN_INT(160, settled);
}

static void the_ring_forgets_what_is_older_than_the_window(void)
{
    start(1, 5);
    for (int k = 0; k < 1000; k++)
        step_one(k < 900 ? 10.0 * k : 0.25);
    TEST_ASSERT_EQUAL_INT(STEADY_SETTLED, look(0).state);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.25, (double)look(0).mean);
}

static void what_cannot_be_is_refused(void)
{
    const struct steady_config good = {2, 20, 1, (real_t)1e-4, 3, 4};
    struct steady_config c = good;
    TEST_ASSERT_EQUAL_INT(ERR_OK, steady_init(&steady, &c));
    struct steady was = steady;
    c.block = 0;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, steady_init(&steady, &c));
    c = good;
    c.noise_floor = 0;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, steady_init(&steady, &c));
    c = good;
    c.motion_limit = (real_t)NAN;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, steady_init(&steady, &c));
    c = good;
    c.outputs = CHANNEL_MAX + 1;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, steady_init(&steady, &c));
    const real_t y[2] = {0, (real_t)NAN};
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, steady_step(&steady, y));
    const real_t huge[2] = {0, (real_t)1e30};
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, steady_step(&steady, huge));
    TEST_ASSERT_EQUAL_MEMORY(&was, &steady, sizeof was);
    struct steady_result r;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, steady_look(&steady, 2, &r));
}

static void the_distance_from_rest_is_the_smaller_of_level_and_drift(void)
{
    static const double cases[][4] = {
        /* away, carried, most, distance */
        {0.3, 0.0, 1, 0.3},   {0.3, 0.3, 1, 0.0},      {0.3, 0.5, 1, -0.2},
        {0.1, 0.5, 1, 0.1},   {-0.3, -0.2, 1, -0.1},   {-0.3, 0.2, 1, -0.3},
        {0.9, 2.0, 0.4, 0.5}, {-0.9, -2.0, 0.4, -0.5}, {0.0, 0.5, 1, 0.0}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double found =
            (double)steady_away((real_t)cases[i][0], (real_t)cases[i][1], (real_t)cases[i][2]);
        TEST_ASSERT_TRUE(fabs(found - cases[i][3]) < 1e-6);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(before_the_window_is_full_there_is_no_verdict);
    RUN_TEST(noise_level_and_drift_are_measured_with_their_deviations);
    RUN_TEST(a_response_is_not_settled_before_it_is);
    RUN_TEST(a_response_settles_in_the_end);
    RUN_TEST(a_climb_moves_and_a_bend_or_a_swing_is_restless);
    RUN_TEST(quantisation_is_not_taken_for_motion);
    RUN_TEST(the_ring_forgets_what_is_older_than_the_window);
    RUN_TEST(the_distance_from_rest_is_the_smaller_of_level_and_drift);
    RUN_TEST(what_cannot_be_is_refused);
    return UNITY_END();
}
