/* Derivatives by differences (host_sim/linear/derivative.h): how near they come, and what they say where there is none. */
#include "linear/derivative.h"
#include "unity.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

void setUp(void) {}

void tearDown(void) {}

#define N 2

static double slope[N];
static struct derivative_found found;
static char err[128];

/* Slopes at 0 of f, with the room given. */
static bool take(bool (*at)(void *, long double, long double *, char *, size_t), double below,
                 double above)
{
    static long double work[DERIVATIVE_WORK * N];
    const struct derivative_task task = {.n = N,
                                         .first = 1,
                                         .values = at,
                                         .step = 0x1p-10L,
                                         .rounding = DBL_EPSILON,
                                         .below = below,
                                         .above = above};
    return derivative_take(&task, work, slope, &found, err, sizeof err);
}

/* Both rounded to double, as plants give them. */
static bool smooth(void *context, long double d, long double *f, char *e, size_t size)
{
    (void)context, (void)e, (void)size;
    f[0] = exp(30.0 * (double)d);
    f[1] = 1000.0 + sin(3.0 + (double)d);
    return true;
}

static void test_smooth_functions_of_double_to_nine_digits(void)
{
    TEST_ASSERT_TRUE(take(smooth, 1.0, 1.0));
    TEST_ASSERT_DOUBLE_WITHIN(30e-9, 30.0, slope[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, cos(3.0), slope[1]);
    TEST_ASSERT_EQUAL(DERIVATIVE_BOTH, found.side);
    TEST_ASSERT_FALSE(found.kink);
}

static void test_at_an_end_the_other_side_serves(void)
{
    TEST_ASSERT_TRUE(take(smooth, 0.0, 1.0));
    TEST_ASSERT_EQUAL(DERIVATIVE_ABOVE, found.side);
    TEST_ASSERT_DOUBLE_WITHIN(30e-6, 30.0, slope[0]);
    TEST_ASSERT_TRUE(take(smooth, 1.0, 1e-7)); /* hardly any room is none */
    TEST_ASSERT_EQUAL(DERIVATIVE_BELOW, found.side);
    TEST_ASSERT_DOUBLE_WITHIN(30e-6, 30.0, slope[0]);
    TEST_ASSERT_FALSE(found.kink);
}

static long double kink_at; /* where the second function's slope goes from 2 to 5 */

static bool bent(void *context, long double d, long double *f, char *e, size_t size)
{
    (void)context, (void)e, (void)size;
    f[0] = exp((double)d);
    f[1] = (double)((d > kink_at ? 5.0L : 2.0L) * (d - kink_at));
    return true;
}

static void test_a_kink_is_found_and_gives_the_slope_above(void)
{
    kink_at = 0.0L;
    TEST_ASSERT_TRUE(take(bent, 1.0, 1.0));
    TEST_ASSERT_TRUE(found.kink);
    TEST_ASSERT_EQUAL_size_t(1, found.kinked);
    TEST_ASSERT_EQUAL(DERIVATIVE_ABOVE, found.side);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 5.0, slope[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, slope[0]);
}

static void test_a_kink_beside_the_point_is_none_of_its_business(void)
{
    for (int i = 1; i < 12; i++) {
        kink_at = (i % 2 ? 1 : -1) * 0x1p-10L * powl(0.6L, i);
        TEST_ASSERT_TRUE(take(bent, 1.0, 1.0));
        TEST_ASSERT_FALSE(found.kink);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, kink_at > 0.0L ? 2.0 : 5.0, slope[1]);
    }
}

/* Slope 0 below, 2 d above: a limit that sets in smoothly. */
static bool rounded_off(void *context, long double d, long double *f, char *e, size_t size)
{
    (void)context, (void)e, (void)size;
    f[0] = (double)d;
    f[1] = d > 0.0L ? (double)(d * d) : 0.0;
    return true;
}

static void test_where_only_the_curvature_jumps_there_is_a_derivative(void)
{
    TEST_ASSERT_TRUE(take(rounded_off, 1.0, 1.0));
    TEST_ASSERT_FALSE(found.kink);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, slope[1]);
}

/* Rounding alone, of another size at every distance. */
static bool noisy(void *context, long double d, long double *f, char *e, size_t size)
{
    (void)context, (void)e, (void)size;
    f[0] = (double)d;
    f[1] = 100.0 + 2.0 * DBL_EPSILON * 100.0 * sin(1e9 * (double)d + 1.0);
    return true;
}

static void test_rounding_is_not_taken_for_a_kink(void)
{
    TEST_ASSERT_TRUE(take(noisy, 1.0, 1.0));
    TEST_ASSERT_FALSE(found.kink);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, slope[1]);
}

/* Only from 0 up. */
static bool half(void *context, long double d, long double *f, char *e, size_t size)
{
    if (d < 0.0L) {
        snprintf(e, size, "below 0");
        return false;
    }
    return smooth(context, d, f, e, size);
}

static bool nowhere(void *context, long double d, long double *f, char *e, size_t size)
{
    if (d != 0.0L) {
        snprintf(e, size, "only here");
        return false;
    }
    return smooth(context, d, f, e, size);
}

static void test_a_side_that_is_refused_is_left_and_without_any_the_reason_is_given(void)
{
    TEST_ASSERT_TRUE(take(half, 1.0, 1.0));
    TEST_ASSERT_EQUAL(DERIVATIVE_ABOVE, found.side);
    TEST_ASSERT_DOUBLE_WITHIN(30e-6, 30.0, slope[0]);
    TEST_ASSERT_FALSE(take(nowhere, 1.0, 1.0));
    TEST_ASSERT_EQUAL_STRING("only here", err);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_smooth_functions_of_double_to_nine_digits);
    RUN_TEST(test_at_an_end_the_other_side_serves);
    RUN_TEST(test_a_kink_is_found_and_gives_the_slope_above);
    RUN_TEST(test_a_kink_beside_the_point_is_none_of_its_business);
    RUN_TEST(test_where_only_the_curvature_jumps_there_is_a_derivative);
    RUN_TEST(test_rounding_is_not_taken_for_a_kink);
    RUN_TEST(test_a_side_that_is_refused_is_left_and_without_any_the_reason_is_given);
    return UNITY_END();
}
