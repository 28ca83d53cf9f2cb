/* The record of a PI at rest against what a law does, step by step. */
#include <string.h>

#include "adapt/gmv_record.h"
#include "unity.h"

#define SETTLED 10u
#define WINDOW  64u
#define W       0.5f

static struct gmv_record r;

void setUp(void)
{
    memset(&r, 0, sizeof r);
}

void tearDown(void) {}

static void pi_acts(unsigned steps, float away, float moved)
{
    gmv_record_begin(&r);
    for (unsigned k = 0; k < steps; k++)
        gmv_record_pi(&r, W, away, k % 2 ? moved : -moved, SETTLED);
}

static void law_begins(void)
{
    gmv_record_begin(&r);
    for (unsigned k = 0; k < SETTLED; k++)
        TEST_ASSERT_FALSE(gmv_record_law(&r, W, 0, 0, SETTLED));
}

/* Whether it is worse within so many steps. */
static bool law_acts(unsigned steps, float away, float moved)
{
    for (unsigned k = 0; k < steps; k++)
        if (gmv_record_law(&r, W, away, k % 2 ? moved : -moved, SETTLED))
            return true;
    return false;
}

static void more_than_twice_the_error_and_three_times_the_moves_for_two_windows_is_worse(void)
{
    pi_acts(200, 0.004f, 0.001f);
    law_begins();
    TEST_ASSERT_FALSE(law_acts(2 * WINDOW - 2, 0.0082f, 0.0031f));
    TEST_ASSERT_TRUE(law_acts(2, 0.0082f, 0.0031f));
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 3.1f, gmv_record_times(&r));
}

static void a_window_that_is_no_worse_begins_the_count_anew(void)
{
    pi_acts(200, 0.004f, 0.001f);
    law_begins();
    for (unsigned k = 0; k < 5; k++) {
        TEST_ASSERT_FALSE(law_acts(WINDOW, 0.02f, 0.02f));
        TEST_ASSERT_FALSE(law_acts(WINDOW, 0.001f, 0.001f));
    }
}

static void errors_below_half_a_percent_of_span_are_no_reason_by_themselves(void)
{
    pi_acts(200, 0.001f, 0.0001f);
    law_begins();
    TEST_ASSERT_FALSE(law_acts(10 * WINDOW, 0.0045f, 0.0015f));
}

static void three_times_the_moves_and_half_a_percent_of_span_at_no_smaller_error_is_worse(void)
{
    pi_acts(200, 0.004f, 0.002f);
    law_begins();
    TEST_ASSERT_FALSE(law_acts(10 * WINDOW, 0.0039f, 0.01f));
    TEST_ASSERT_FALSE(law_acts(10 * WINDOW, 0.0041f, 0.0058f));
    TEST_ASSERT_TRUE(law_acts(2 * WINDOW, 0.0041f, 0.0062f));
    pi_acts(400, 0.004f, 0.001f);
    law_begins();
    TEST_ASSERT_FALSE(law_acts(10 * WINDOW, 0.0041f, 0.0045f)); /* small moves */
}

static void while_setpoints_move_nothing_is_judged(void)
{
    pi_acts(200, 0.004f, 0.001f);
    law_begins();
    for (unsigned k = 0; k < 100 * SETTLED; k++)
        TEST_ASSERT_FALSE(gmv_record_law(&r, W + (float)(k / SETTLED % 2) / 10, 0.1f,
                                         k % 2 ? 0.1f : -0.1f, SETTLED));
}

static void what_the_pi_does_after_a_setpoint_counts_until_it_has_been_at_rest(void)
{
    for (unsigned k = 0; k < 200; k++)
        gmv_record_pi(&r, W + (float)(k / SETTLED % 2) / 10, 0.1f, 0.01f, SETTLED);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.01f, r.error);
    pi_acts(200, 0.004f, 0.001f);
    TEST_ASSERT_FLOAT_WITHIN(1e-7f, 1.6e-5f, r.error);
    gmv_record_pi(&r, W + 0.1f, 0.1f, 0.1f, SETTLED);
    TEST_ASSERT_FLOAT_WITHIN(1e-7f, 1.6e-5f, r.error);
}

static void a_few_samples_at_rest_are_no_record_yet(void)
{
    for (unsigned k = 0; k < 200; k++)
        gmv_record_pi(&r, W + (float)(k / SETTLED % 2) / 10, 0.1f, 0.01f, SETTLED);
    pi_acts(SETTLED + 20, 0, 0);
    law_begins();
    TEST_ASSERT_FALSE(law_acts(10 * WINDOW, 0.1f, 0.02f));
}

static void a_pi_that_acts_again_renews_its_record(void)
{
    pi_acts(1000, 0.004f, 0.001f);
    law_begins();
    pi_acts(2000, 0.02f, 0.01f);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 4e-4f, r.error);
    law_begins();
    TEST_ASSERT_FALSE(law_acts(10 * WINDOW, 0.03f, 0.02f));
}

static void without_a_record_nothing_is_judged(void)
{
    pi_acts(10, 0.004f, 0.001f);
    law_begins();
    TEST_ASSERT_FALSE(law_acts(10 * WINDOW, 0.5f, 0.5f));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(more_than_twice_the_error_and_three_times_the_moves_for_two_windows_is_worse);
    RUN_TEST(a_window_that_is_no_worse_begins_the_count_anew);
    RUN_TEST(errors_below_half_a_percent_of_span_are_no_reason_by_themselves);
    RUN_TEST(three_times_the_moves_and_half_a_percent_of_span_at_no_smaller_error_is_worse);
    RUN_TEST(while_setpoints_move_nothing_is_judged);
    RUN_TEST(what_the_pi_does_after_a_setpoint_counts_until_it_has_been_at_rest);
    RUN_TEST(a_few_samples_at_rest_are_no_record_yet);
    RUN_TEST(a_pi_that_acts_again_renews_its_record);
    RUN_TEST(without_a_record_nothing_is_judged);
    return UNITY_END();
}
