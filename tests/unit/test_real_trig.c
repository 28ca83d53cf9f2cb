/* num/real_trig.[ch], num/random.[ch]; built in float and in double.
 *
 * Contract
 *   sine, cosine        1.5e-7 of the C library's in double, to 1e4 rad; no number gives no number
 *   normal deviates     first four moments within 4 standard deviations of 200000 draws; the same for one seed
 */
#include <math.h>
#include <stdio.h>

#include "num/random.h"
#include "num/real_trig.h"
#include "random_matrix.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void sine_and_cosine_are_those_of_the_c_library(void)
{
    double worst = 0.0;
    struct random_source r = {11};
    for (int k = 0; k < 200000; k++) {
        double size = pow(10.0, 4.0 * random_fraction(&r));
        real_t angle = (real_t)(random_fraction(&r) * size), sine, cosine;
        real_sincos(angle, &sine, &cosine);
        worst = fmax(worst, fabs((double)sine - sin((double)angle)));
        worst = fmax(worst, fabs((double)cosine - cos((double)angle)));
    }
    printf("sine, cosine: worst %.2g, seed 11\n", worst);
    TEST_ASSERT_TRUE(worst <= 1.5e-7);
}

/* 2/pi with 39 bits behind the point is off by 0.13 of the last: 4e-7 in 1e6, and ten times that with one bit more or less. */
static void large_angles_lose_what_2_over_pi_is_off_by(void)
{
    double worst = 0.0;
    struct random_source r = {12};
    for (int k = 0; k < 20000; k++) {
        real_t angle = (real_t)(1e6 * random_fraction(&r)), sine, cosine;
        real_sincos(angle, &sine, &cosine);
        worst = fmax(worst, fabs((double)sine - sin((double)angle)));
        worst = fmax(worst, fabs((double)cosine - cos((double)angle)));
    }
    TEST_ASSERT_TRUE(worst <= 6e-7);
    real_t sine, cosine;
    real_sincos((real_t)1e6, &sine, &cosine);
    TEST_ASSERT_DOUBLE_WITHIN(6e-7, sin(1e6), (double)sine);
    real_sincos((real_t)-1e6, &sine, &cosine);
    TEST_ASSERT_DOUBLE_WITHIN(6e-7, cos(1e6), (double)cosine);
    if (sizeof(real_t) == sizeof(float)) {
        real_sincos((real_t)1.0000001e6, &sine, &cosine);
        TEST_ASSERT_TRUE(isnan((double)sine) && isnan((double)cosine));
    }
}

static void sine_and_cosine_of_the_axes_and_of_no_number(void)
{
    real_t sine, cosine;
    real_sincos(0, &sine, &cosine);
    TEST_ASSERT_TRUE(sine == 0 && cosine == 1);
    for (int k = -8; k <= 8; k++) {
        double angle = (double)(real_t)(k * 1.5707963267948966);
        real_sincos((real_t)angle, &sine, &cosine);
        TEST_ASSERT_DOUBLE_WITHIN(1.5e-7, sin(angle), (double)sine);
        TEST_ASSERT_DOUBLE_WITHIN(1.5e-7, cos(angle), (double)cosine);
    }
    static const real_t bad[] = {(real_t)NAN, (real_t)INFINITY, (real_t)-INFINITY};
    for (unsigned k = 0; k < 3; k++) {
        real_sincos(bad[k], &sine, &cosine);
        TEST_ASSERT_TRUE(isnan((double)sine) && isnan((double)cosine));
    }
}

static void normal_deviates_have_the_moments_of_the_normal_law(void)
{
    struct random r = random_from(3);
    double sum[5] = {0}, most = 0.0;
    const int n = 200000;
    int inside = 0;
    for (int k = 0; k < n; k++) {
        double d = (double)random_normal(&r), power = 1.0;
        for (int m = 1; m < 5; m++)
            sum[m] += (power *= d);
        inside += fabs(d) < 1.0;
        most = fmax(most, fabs(d));
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, sum[1] / n); /* 4 standard deviations of 200000 each */
    TEST_ASSERT_DOUBLE_WITHIN(0.013, 1.0, sum[2] / n);
    TEST_ASSERT_DOUBLE_WITHIN(0.035, 0.0, sum[3] / n);
    TEST_ASSERT_DOUBLE_WITHIN(0.09, 3.0, sum[4] / n);
    TEST_ASSERT_DOUBLE_WITHIN(0.004, 0.6827, (double)inside / n);
    TEST_ASSERT_TRUE(most > 4.0 && most < 5.9);
}

static void one_seed_gives_one_sequence(void)
{
    struct random r = random_from(1), s = random_from(1), t = random_from(2);
    int different = 0;
    for (int k = 0; k < 100; k++) {
        double d = (double)random_normal(&r);
        TEST_ASSERT_TRUE(d == (double)random_normal(&s));
        different += d != (double)random_normal(&t);
    }
    TEST_ASSERT_GREATER_THAN_INT(95, different);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(sine_and_cosine_are_those_of_the_c_library);
    RUN_TEST(large_angles_lose_what_2_over_pi_is_off_by);
    RUN_TEST(sine_and_cosine_of_the_axes_and_of_no_number);
    RUN_TEST(normal_deviates_have_the_moments_of_the_normal_law);
    RUN_TEST(one_seed_gives_one_sequence);
    return UNITY_END();
}
