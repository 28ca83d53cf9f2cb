/* num/real_math.[ch] against double.
 *
 * Contract           error, in units of the last place of the float result
 *   float_exp        0.505 over the full range, subnormal results included
 *   float_log        0.501 over the full range, subnormal arguments included
 *   float_pow        0.505 wherever the result is finite; 0.515 for bases so near 1 that exponents reach 1e9
 *
 * The full range is walked in steps of a prime number of float bit patterns; REFLUX_MATH_STEP=1 in the environment
 * walks all of them (minutes).
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "num/real_math.h"
#include "random_source.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static float float_from(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Distance from the reference in units of the last place that a float of its size has. */
static double ulps(float result, double reference)
{
    if (isnan(reference) || isnan(result))
        return isnan(reference) && isnan(result) ? 0.0 : INFINITY;
    if (isinf(result)) /* right where rounding to nearest overflows: 2^128 - 2^103 */
        return fabs(reference) >= 0x1.ffffffp127 && (reference > 0) == (result > 0) ? 0.0
                                                                                    : INFINITY;
    int exponent;
    (void)frexp(reference, &exponent);
    double unit = ldexp(1.0, exponent - 24 < -149 ? -149 : exponent - 24);
    return fabs((double)result - reference) / unit;
}

struct worst {
    double error;
    float x, y;
    uint64_t n;
};

static void look(struct worst *w, float x, float y, float result, double reference)
{
    double error = ulps(result, reference);
    w->n++;
    if (!(error <= w->error)) {
        *w = (struct worst){error, x, y, w->n};
    }
}

static void show(const char *name, const struct worst *w, double bound)
{
    char text[160];
    snprintf(text, sizeof text, "%s: %" PRIu64 " arguments, largest error %.5f ulp at %.9g %.9g",
             name, w->n, w->error, (double)w->x, (double)w->y);
    TEST_MESSAGE(text);
    TEST_ASSERT_TRUE_MESSAGE(w->error <= bound, text);
}

static double uniform(struct random_source *r, double lo, double hi)
{
    return lo + (hi - lo) * (double)(random_next(r) >> 11) * 0x1p-53;
}

static uint32_t step(void)
{
    const char *text = getenv("REFLUX_MATH_STEP");
    long n = text ? strtol(text, NULL, 10) : 0;
    return n > 0 ? (uint32_t)n : 2003;
}

static void exponential_and_logarithm_over_the_full_range(void)
{
    struct worst exponential = {0}, logarithm = {0};
    for (uint64_t bits = 0; bits <= UINT32_MAX; bits += step()) {
        float x = float_from((uint32_t)bits);
        look(&exponential, x, 0.0f, float_exp(x), exp((double)x));
        look(&logarithm, x, 0.0f, float_log(x), log((double)x));
    }
    /* Densely where results are neither 0, 1 nor infinite, and around 1. */
    for (int k = 0; k < 1200000; k++) {
        float x = -104.5f + (float)k * 1.625e-4f;
        look(&exponential, x, 0.0f, float_exp(x), exp((double)x));
    }
    for (int k = 0; k < 500000; k++) {
        float x = 0.5f + (float)k * 3.0e-6f;
        look(&logarithm, x, 0.0f, float_log(x), log((double)x));
    }
    show("float_exp", &exponential, 0.505);
    show("float_log", &logarithm, 0.501);
}

static void power_wherever_the_result_is_a_float(void)
{
    struct random_source r = {20240521u};
    struct worst w = {0}, near_one = {0};
    for (uint32_t i = 0; i < 1000000; i++) {
        float x = float_from((uint32_t)(uniform(&r, 0.0, 1.0) * 0x7F800000u));
        double most = 160.0 / fabs(log2((double)x) + 1e-30);
        float y = (float)uniform(&r, -most, most);
        look(&w, x, y, float_pow(x, y), pow((double)x, (double)y));
        x = (float)(1.0 + uniform(&r, -1.0, 1.0) * exp2(uniform(&r, -23.0, -1.0)));
        most = 160.0 / fabs(log2((double)x) + 1e-30);
        if (most > 1e12)
            continue;
        y = (float)uniform(&r, -most, most);
        look(&near_one, x, y, float_pow(x, y), pow((double)x, (double)y));
        x = -(float)(1 + i % 50);
        y = (float)((int)(i % 41) - 20);
        look(&w, x, y, float_pow(x, y), pow((double)x, (double)y));
    }
    show("float_pow", &w, 0.505);
    show("float_pow near 1", &near_one, 0.515);
}

static void special_arguments(void)
{
    TEST_ASSERT_FLOAT_IS_NAN(float_exp(NAN));
    TEST_ASSERT_TRUE(float_exp(INFINITY) == INFINITY && float_exp(-INFINITY) == 0.0f);
    TEST_ASSERT_TRUE(float_exp(0.0f) == 1.0f && float_exp(-0.0f) == 1.0f);
    TEST_ASSERT_FLOAT_IS_NAN(float_log(NAN));
    TEST_ASSERT_FLOAT_IS_NAN(float_log(-1.0f));
    TEST_ASSERT_TRUE(float_log(0.0f) == -INFINITY && float_log(-0.0f) == -INFINITY);
    TEST_ASSERT_TRUE(float_log(INFINITY) == INFINITY && float_log(1.0f) == 0.0f);
    TEST_ASSERT_FLOAT_IS_NAN(float_pow(NAN, 0.0f));
    TEST_ASSERT_FLOAT_IS_NAN(float_pow(1.0f, NAN));
    TEST_ASSERT_FLOAT_IS_NAN(float_pow(-2.0f, 0.5f));
    static const float x[] = {0.0f, 0.5f, 1.0f, 3.0f, INFINITY, -1.0f, -3.0f, -INFINITY};
    static const float y[] = {0.0f, 1.0f, -1.0f, 2.0f, -2.0f, 3e7f, INFINITY, -INFINITY};
    for (size_t i = 0; i < sizeof x / sizeof x[0]; i++)
        for (size_t j = 0; j < sizeof y / sizeof y[0]; j++)
            TEST_ASSERT_TRUE_MESSAGE((float)pow((double)x[i], (double)y[j]) ==
                                         float_pow(x[i], y[j]),
                                     "as the C standard has it");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(exponential_and_logarithm_over_the_full_range);
    RUN_TEST(power_wherever_the_result_is_a_float);
    RUN_TEST(special_arguments);
    return UNITY_END();
}
