/* Fast samples, filtered and thinned out.
 *
 * Contract, float and double: within 16 REAL_EPSILON (1 + 1/K) of the largest |x|, beside the filter's difference equation in
 * long double, written from its transfer function. */
#include <math.h>

#include "identify/decimate.h"
#include "unity.h"

static struct decimator decimator;

void setUp(void) {}
void tearDown(void) {}

static const double pi = 3.14159265358979323846;

/* Butterworth of second order by the bilinear transformation, direct form. */
static long double by_difference_equation(long double k, long double x, long double *was)
{
    long double n = 1 / (1 + sqrtl(2) * k + k * k);
    long double y = k * k * n * (x + 2 * was[0] + was[1]) - 2 * (k * k - 1) * n * was[2] -
                    (1 - sqrtl(2) * k + k * k) * n * was[3];
    was[1] = was[0];
    was[0] = x;
    was[3] = was[2];
    was[2] = y;
    return y;
}

static void test_samples_are_within_the_contract(void)
{
    static const struct {
        uint32_t ratio;
        double cutoff;
    } of[3] = {{2, 1}, {10, 0.5}, {60, 0.2}};
    for (int c = 0; c < 3; c++) {
        long double k = tanl((long double)pi * of[c].cutoff / (2 * of[c].ratio)), was[4] = {0};
        TEST_ASSERT_EQUAL(ERR_OK, decimator_init(&decimator, of[c].ratio, (real_t)of[c].cutoff));
        for (uint32_t at = 0; at < 40 * of[c].ratio; at++) {
            double x = at == 0 ? 0 : (double)((int)(at * 37 % 64) - 32) / 32;
            real_t kept = 0;
            long double wanted = by_difference_equation(k, x, was);
            bool due = decimator_step(&decimator, (real_t)x, &kept);
            TEST_ASSERT_EQUAL(at % of[c].ratio == 0, due);
            if (due)
                TEST_ASSERT_DOUBLE_WITHIN(16 * (double)REAL_EPSILON * (1 + 1 / (double)k),
                                          (double)wanted, (double)kept);
        }
    }
}

static void test_without_a_cutoff_the_samples_kept_are_as_they_came(void)
{
    real_t kept = 0;
    TEST_ASSERT_EQUAL(ERR_OK, decimator_init(&decimator, 12, REAL_C(0.0)));
    for (int k = 0; k < 120; k++)
        if (decimator_step(&decimator, (real_t)(k * 37 % 64), &kept))
            TEST_ASSERT_TRUE(kept == (real_t)(k * 37 % 64));
}

static void test_a_level_passes_as_it_is_from_the_first_sample_on(void)
{
    real_t kept = 0;
    TEST_ASSERT_EQUAL(ERR_OK, decimator_init(&decimator, 100, REAL_C(0.3)));
    for (int k = 0; k < 1000; k++) {
        (void)decimator_step(&decimator, REAL_C(351.3), &kept);
        TEST_ASSERT_TRUE(kept == REAL_C(351.3));
    }
}

static void test_at_the_cutoff_a_wave_has_less_by_the_root_of_two(void)
{
    double most = 0;
    TEST_ASSERT_EQUAL(ERR_OK, decimator_init(&decimator, 5, REAL_C(0.25)));
    for (int k = 0; k < 4000; k++) { /* 40 samples a wave: 8 that are kept */
        real_t kept;
        bool due = decimator_step(&decimator, (real_t)sin(2 * pi * k / 40 + 0.3), &kept);
        if (due && k > 2000)
            most = fmax(most, fabs((double)kept));
    }
    /* of 8 points on a wave one is at most a sixteenth of a turn from its top */
    TEST_ASSERT_TRUE(most <= sqrt(0.5) + 1e-5 && most >= sqrt(0.5) * cos(pi / 8) - 1e-5);
}

static void test_a_ratio_of_one_changes_nothing(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, decimator_init(&decimator, 1, 1));
    for (int k = 0; k < 10; k++) {
        real_t x = (real_t)(k * 7 % 5), kept = -1;
        TEST_ASSERT_TRUE(decimator_step(&decimator, x, &kept));
        TEST_ASSERT_TRUE(kept == x);
    }
}

static void test_what_is_out_of_range_is_refused(void)
{
    TEST_ASSERT_EQUAL(ERR_RANGE, decimator_init(&decimator, 0, 1));
    TEST_ASSERT_EQUAL(ERR_RANGE, decimator_init(&decimator, 10001, 1));
    TEST_ASSERT_EQUAL(ERR_RANGE, decimator_init(&decimator, 5, REAL_C(0.009)));
    TEST_ASSERT_EQUAL(ERR_RANGE, decimator_init(&decimator, 5, REAL_C(1.1)));
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, decimator_init(&decimator, 5, (real_t)NAN));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_samples_are_within_the_contract);
    RUN_TEST(test_without_a_cutoff_the_samples_kept_are_as_they_came);
    RUN_TEST(test_a_level_passes_as_it_is_from_the_first_sample_on);
    RUN_TEST(test_at_the_cutoff_a_wave_has_less_by_the_root_of_two);
    RUN_TEST(test_a_ratio_of_one_changes_nothing);
    RUN_TEST(test_what_is_out_of_range_is_refused);
    return UNITY_END();
}
