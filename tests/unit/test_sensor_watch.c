/* commission/sensor_watch.[ch]: coarse and rarely renewed sensors among fine ones, from samples with noise. */
#include <math.h>
#include <string.h>

#include "commission/sensor_watch.h"
#include "step_records.h"
#include "unity.h"

static struct sensor_watch w;

void setUp(void)
{
    memset(&w, 0, sizeof w);
}
void tearDown(void) {}

/* `n` samples about 0.5 + climb per sample, with noise, in steps of `step` (0: fine), renewed every `every` samples. */
static void samples(unsigned n, double noise, double climb, double step, unsigned every)
{
    struct random_source random = {7};
    double held = 0.5;
    for (unsigned i = 0; i < n; i++) {
        double y = 0.5 + climb * i + noise * normal(&random);
        if (i % every == 0)
            held = step > 0.0 ? step * round(y / step) : y;
        sensor_watch_step(&w, (real_t)held);
    }
}

static void is(double step, unsigned renewal)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * step + 1e-6, step, (double)sensor_watch_coarse(&w));
    TEST_ASSERT_EQUAL_UINT(renewal, sensor_watch_renewal(&w));
}

static void nothing_is_said_of_a_fine_sensor(void)
{
    is(0.0, 1);
    samples(500, 0.005, 0.0, 0.0, 1);
    is(0.0, 1);
    setUp();
    samples(500, 0.0005, 0.0, 1.0 / 4096, 1); /* 12 bits */
    is(0.0, 1);
    setUp();
    samples(500, 0.005, 0.0, 0.001, 1); /* noise is five steps */
    is(0.0, 1);
    setUp();
    samples(500, 0.0, 0.0, 0.01, 1); /* it has not changed yet */
    is(0.0, 1);
    setUp();
    samples(100, 0.0, 0.0, 0.0, 1);
    for (unsigned i = 0; i < 100; i++) { /* a response without noise, by a fine sensor */
        sensor_watch_step(&w, (real_t)(0.5 + 0.05 * (1.0 - exp(-0.05 * i))));
        TEST_ASSERT_EQUAL(0, sensor_watch_coarse(&w) > REAL_C(0.0));
    }
}

static void the_renewal_of_one_test_is_kept_for_reports(void)
{
    TEST_ASSERT_EQUAL_UINT(1, sensor_watch_noted(&w));
    samples(500, 0.005, 0.0, 0.0, 10);
    TEST_ASSERT_EQUAL_UINT(10, sensor_watch_noted(&w));
    sensor_watch_note(&w);
    for (unsigned i = 0; i < 9; i++) { /* a run that a gap has cut */
        sensor_watch_step(&w, REAL_C(0.5));
        sensor_watch_step(&w, REAL_C(0.6));
    }
    TEST_ASSERT_EQUAL_UINT(1, sensor_watch_renewal(&w));
    TEST_ASSERT_EQUAL_UINT(10, sensor_watch_noted(&w));
}

static void coarse_steps_are_found_at_rest_and_on_the_way(void)
{
    static const double steps[] = {0.001, 0.002, 0.004, 0.01};
    for (unsigned i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        setUp();
        samples(300, steps[i] / 4, 0.0, steps[i], 1);
        is(steps[i], 1);
        setUp();
        samples(300, 0.0, steps[i] / 20, steps[i], 1);
        is(steps[i], 1);
    }
}

static void rare_renewal_is_found_in_noise(void)
{
    for (unsigned every = 2; every <= 30; every += 7) {
        setUp();
        samples(20 * every, 0.003, 0.0, 0.0, every);
        is(0.0, every);
        setUp();
        samples(20 * every, 0.003, 0.0, 1.0 / 4096, every); /* two values may be equal by chance */
        is(0.0, every);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(nothing_is_said_of_a_fine_sensor);
    RUN_TEST(the_renewal_of_one_test_is_kept_for_reports);
    RUN_TEST(coarse_steps_are_found_at_rest_and_on_the_way);
    RUN_TEST(rare_renewal_is_found_in_noise);
    return UNITY_END();
}
