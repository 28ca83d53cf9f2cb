/* Analyses that come now and then, late, beside an estimate (kinds/composition/composition_analysis_state.h). */
#include <math.h>

#include "kinds/composition/composition_analysis.h"
#include "kinds/composition/composition_analysis_state.h"
#include "unity.h"

#define H 10

static struct composition_analysis a;

void setUp(void)
{
    a = (struct composition_analysis){.share = 0.5f};
    composition_analysis_begin(&a, H, 1000);
}

void tearDown(void) {}

static bool sample_step(float x, bool usable, float y, float age_s, float most)
{
    const struct composition_sample sample = {
        .y = y, .age_s = age_s, .most = most, .usable = usable};
    return composition_analysis_step(&a, H, x, &sample);
}

/* The estimate falls by 0.001 a step; the truth is by `off` more. A sample of n steps ago is shown in every `apart`-th step. */
static void run(unsigned steps, unsigned n, unsigned apart, float off)
{
    for (unsigned k = 0; k < steps; k++) {
        float x = 0.9f - 0.001f * (float)k;
        unsigned old = k % apart, taken = k - old < n ? 0 : k - old - n;
        bool shown = k >= n;
        (void)sample_step(x, shown, 0.9f - 0.001f * (float)taken + off,
                          shown ? (float)((k - taken) * H) : 0, 0);
    }
}

static void a_constant_error_is_halved_by_each_sample(void)
{
    run(61, 20, 60, 0.02f); /* two: at the steps 20 and 60 */
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.015f, a.correction);
}

static void a_sample_is_compared_with_what_the_estimate_was_then(void)
{
    run(200, 30, 50, 0);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0, a.correction);
}

static void where_steps_are_many_the_nearest_that_is_kept_counts(void)
{
    for (unsigned age = 40; age < 60; age++) {
        a.share = 1;
        composition_analysis_begin(&a, H, 5000);
        TEST_ASSERT_EQUAL(4, a.every);
        for (unsigned k = 0; k < 103; k++) /* three steps after the last that is kept */
            (void)sample_step(0.001f * (float)k, false, 0, 0, 0);
        TEST_ASSERT_FALSE(
            sample_step(0.103f, true, 0.001f * (float)(103 - age), (float)(age * H), 0));
        TEST_ASSERT_FLOAT_WITHIN(0.002f + 1e-6f, 0, a.correction); /* two steps at most */
    }
}

static void the_very_first_step_is_kept(void)
{
    composition_analysis_begin(&a, H, 5000);
    TEST_ASSERT_FALSE(sample_step(0.5f, true, 0.6f, 0, 0));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.05f, a.correction);
}

static void a_number_that_stands_counts_once(void)
{
    (void)sample_step(0.5f, true, 0.6f, 0, 0);
    float once = a.correction;
    for (unsigned k = 1; k < 20; k++)
        (void)sample_step(0.5f, true, 0.6f, (float)(k * H), 0);
    TEST_ASSERT_EQUAL_FLOAT(once, a.correction);
    (void)sample_step(0.5f, true, 0.6f, 0, 0);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.075f, a.correction);
}

static void nothing_valid_counts_for_nothing(void)
{
    for (unsigned k = 0; k < 20; k++)
        TEST_ASSERT_FALSE(sample_step(0.5f, false, 0.9f, 0, 0));
    TEST_ASSERT_EQUAL_FLOAT(0, a.correction);
}

static void a_sample_from_before_it_began_or_beyond_its_reach_is_told_and_left(void)
{
    TEST_ASSERT_TRUE(sample_step(0.5f, true, 0.9f, 300, 0));
    setUp();
    for (unsigned k = 0; k < 300; k++)
        (void)sample_step(0.5f, false, 0.9f, 0, 0);
    TEST_ASSERT_TRUE(sample_step(0.5f, true, 0.9f, 1300, 0));
    TEST_ASSERT_EQUAL_FLOAT(0, a.correction);
}

static void what_is_too_far_off_is_not_believed_and_a_nearer_one_is(void)
{
    (void)sample_step(0.5f, true, 0.61f, 0, 0.1f);
    TEST_ASSERT_TRUE(a.rejected);
    TEST_ASSERT_EQUAL_FLOAT(0, a.correction);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.11f, a.surprise);
    (void)sample_step(0.5f, true, 0.39f, 0, 0.1f);
    TEST_ASSERT_TRUE(a.rejected);
    TEST_ASSERT_EQUAL_FLOAT(0, a.correction);
    (void)sample_step(0.5f, true, 0.41f, 0, 0.1f);
    TEST_ASSERT_FALSE(a.rejected);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, -0.045f, a.correction);
}

static void it_begins_without_a_past(void)
{
    run(100, 20, 40, 0.02f);
    composition_analysis_begin(&a, H, 1000);
    TEST_ASSERT_EQUAL_FLOAT(0, a.correction);
    TEST_ASSERT_TRUE(sample_step(0.5f, true, 0.9f, 200, 0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_constant_error_is_halved_by_each_sample);
    RUN_TEST(a_sample_is_compared_with_what_the_estimate_was_then);
    RUN_TEST(where_steps_are_many_the_nearest_that_is_kept_counts);
    RUN_TEST(the_very_first_step_is_kept);
    RUN_TEST(a_number_that_stands_counts_once);
    RUN_TEST(nothing_valid_counts_for_nothing);
    RUN_TEST(a_sample_from_before_it_began_or_beyond_its_reach_is_told_and_left);
    RUN_TEST(what_is_too_far_off_is_not_believed_and_a_nearer_one_is);
    RUN_TEST(it_begins_without_a_past);
    return UNITY_END();
}
