/* The record of a PI at rest against what a law does, step by step. */
#include <string.h>

#include "kinds/gmv/gmv_record_state.h"
#include "unity.h"

#define SETTLED 10u
#define WINDOW  64u
#define W       0.5f

static struct gmv_record r;
static float answer_floor; /* what is added to each error of an answer */

void setUp(void)
{
    memset(&r, 0, sizeof r);
    answer_floor = 0;
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
        TEST_ASSERT_EQUAL_FLOAT(0, gmv_record_law(&r, W, 0, 0, SETTLED));
}

/* By how many times it is worse within so many steps; 0: it is not. */
static float law_acts(unsigned steps, float away, float moved)
{
    for (unsigned k = 0; k < steps; k++) {
        float times = gmv_record_law(&r, W, away, k % 2 ? moved : -moved, SETTLED);
        if (times > 0)
            return times;
    }
    return 0;
}

static void more_than_twice_the_error_and_three_times_the_moves_for_two_windows_is_worse(void)
{
    pi_acts(200, 0.004f, 0.001f);
    law_begins();
    TEST_ASSERT_EQUAL_FLOAT(0, law_acts(2 * WINDOW - 2, 0.0082f, 0.0031f));
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 3.1f, law_acts(2, 0.0082f, 0.0031f));
}

static void a_window_that_is_no_worse_begins_the_count_anew(void)
{
    pi_acts(200, 0.004f, 0.001f);
    law_begins();
    for (unsigned k = 0; k < 5; k++) {
        TEST_ASSERT_EQUAL_FLOAT(0, law_acts(WINDOW, 0.02f, 0.02f));
        TEST_ASSERT_EQUAL_FLOAT(0, law_acts(WINDOW, 0.001f, 0.001f));
    }
}

static void errors_below_half_a_percent_of_span_are_no_reason_by_themselves(void)
{
    pi_acts(200, 0.001f, 0.0001f);
    law_begins();
    TEST_ASSERT_EQUAL_FLOAT(0, law_acts(10 * WINDOW, 0.0045f, 0.0015f));
}

static void three_times_the_moves_and_half_a_percent_of_span_at_no_smaller_error_is_worse(void)
{
    pi_acts(200, 0.004f, 0.002f);
    law_begins();
    TEST_ASSERT_EQUAL_FLOAT(0, law_acts(10 * WINDOW, 0.0039f, 0.01f));
    TEST_ASSERT_EQUAL_FLOAT(0, law_acts(10 * WINDOW, 0.0041f, 0.0058f));
    TEST_ASSERT_TRUE(law_acts(2 * WINDOW, 0.0041f, 0.0062f) > 0);
    pi_acts(400, 0.004f, 0.001f);
    law_begins();
    TEST_ASSERT_EQUAL_FLOAT(0, law_acts(10 * WINDOW, 0.0041f, 0.0045f)); /* small moves */
}

/* So many setpoint moves of 10 %, each one answered by an error that shrinks by `shrinks` a step; the law's, or the PI's.
 * By how many times the law is worse at once; 0: it is not. */
static float answers(bool law, unsigned moves, float shrinks, float size)
{
    for (unsigned n = 0; n < moves; n++) {
        float away = 0.1f * size;
        for (unsigned k = 0; k < SETTLED; k++, away *= shrinks) {
            float setpoint = W + (n % 2 ? 0 : 0.1f * size), times = 0;
            if (law)
                times = gmv_record_law(&r, setpoint, away + answer_floor, 0.1f, SETTLED);
            else
                gmv_record_pi(&r, setpoint, away + answer_floor, 0.1f, SETTLED);
            if (times > 0)
                return times;
        }
    }
    return 0;
}

static void while_setpoints_move_moves_of_the_mv_are_not_judged(void)
{
    pi_acts(200, 0.004f, 0.001f);
    law_begins();
    TEST_ASSERT_EQUAL_FLOAT(0, answers(true, 100, 0.8f, 1));
}

/* Sums of ten steps are 4.46 times the first error with 0.8, 5.36 times with 0.85, 6.51 with 0.9. */
static void answers_to_setpoints_that_are_a_third_larger_than_the_pis_are_worse(void)
{
    (void)answers(false, 20, 0.8f, 1);
    gmv_record_begin(&r);
    TEST_ASSERT_EQUAL_FLOAT(0, answers(true, 40, 0.85f, 1));
    gmv_record_begin(&r);
    TEST_ASSERT_EQUAL_FLOAT(0, answers(true, 12, 0.9f, 1)); /* too few of them */
    TEST_ASSERT_FLOAT_WITHIN(0.05f, 1.46f, answers(true, 4, 0.9f, 1));
}

static void answers_are_compared_for_the_same_size_of_the_move(void)
{
    (void)answers(false, 20, 0.8f, 1);
    gmv_record_begin(&r);
    TEST_ASSERT_EQUAL_FLOAT(0, answers(true, 40, 0.8f, 2));
    gmv_record_begin(&r);
    TEST_ASSERT_TRUE(answers(true, 40, 0.9f, 0.5f) > 1.3f);
}

/* An error of 0.4 % of span stays whatever the size of the move. Means of an answer to 1 %: 0.85 % with 0.8, 1.2 % with 0.95. */
static void noise_after_moves_smaller_than_the_pis_is_no_worse_answer(void)
{
    pi_acts(200, 0.004f, 0.001f);
    answer_floor = 0.004f;
    (void)answers(false, 20, 0.8f, 1);
    gmv_record_begin(&r);
    TEST_ASSERT_EQUAL_FLOAT(0, answers(true, 40, 0.8f, 0.1f));
    gmv_record_begin(&r);
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 1.55f, answers(true, 40, 0.95f, 0.1f));
}

static void errors_of_a_tenth_of_a_percent_of_span_after_setpoints_decide_nothing(void)
{
    (void)answers(false, 20, 0.8f, 1);
    gmv_record_begin(&r);
    TEST_ASSERT_EQUAL_FLOAT(0, answers(true, 40, 0.9f, 0.015f));
}

/* For 90 steps of a hundred the MV stands at a limit and the PV a whole move away. */
static void what_the_pv_does_while_the_mv_stands_at_a_limit_is_no_answer(void)
{
    (void)answers(false, 20, 0.8f, 1);
    gmv_record_begin(&r);
    for (unsigned n = 0; n < 100; n++) {
        TEST_ASSERT_EQUAL_FLOAT(0, answers(true, 2, 0.8f, 1));
        for (unsigned k = 0; k < 90; k++)
            TEST_ASSERT_EQUAL_FLOAT(0, gmv_record_law(&r, W, 0.1f, 0, 100));
    }
    TEST_ASSERT_TRUE(answers(true, 60, 0.9f, 1) > 1.3f);
}

static void what_the_law_takes_over_with_is_no_answer(void)
{
    (void)answers(false, 20, 0.8f, 1);
    gmv_record_begin(&r);
    for (unsigned k = 0; k < SETTLED - 1; k++)
        TEST_ASSERT_EQUAL_FLOAT(0, gmv_record_law(&r, W, 2, 0.1f, SETTLED));
    TEST_ASSERT_EQUAL_FLOAT(0, answers(true, 40, 0.8f, 1));
}

static void what_comes_before_the_first_move_is_no_answer(void)
{
    for (unsigned k = 0; k < 5; k++)
        gmv_record_pi(&r, W, 0.4f, 0.1f, SETTLED);
    (void)answers(false, 20, 0.8f, 1);
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 4.46f, gmv_record_answer(&r));
}

static void answers_that_were_cut_short_say_nothing_of_a_whole_one(void)
{
    (void)answers(false, 20, 0.95f, 1); /* 0.6 of the move are left after ten steps */
    TEST_ASSERT_EQUAL_FLOAT(0, gmv_record_answer(&r));
    (void)answers(false, 400, 0.8f, 1);
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 4.46f, gmv_record_answer(&r));
}

static void against_few_answers_of_the_pi_the_law_must_be_three_times_worse(void)
{
    (void)answers(false, 5, 0.8f, 1);
    TEST_ASSERT_EQUAL_FLOAT(0, gmv_record_answer(&r));
    gmv_record_begin(&r);
    TEST_ASSERT_EQUAL_FLOAT(0, answers(true, 40, 0.95f, 1)); /* 8.0 beside 4.46 */
    gmv_record_begin(&r);
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 3.4f, answers(true, 40, 1.09f, 1)); /* 15.2 */
}

static void against_next_to_no_answers_of_the_pi_nothing_is_judged(void)
{
    (void)answers(false, 3, 0.8f, 1);
    gmv_record_begin(&r);
    TEST_ASSERT_EQUAL_FLOAT(0, answers(true, 40, 1.09f, 1));
}

/* ---- sensor noise ---- */

static uint32_t lottery;

/* Uniform within +/-0.01: the mean square is 3.33e-5. */
static float noise(void)
{
    lottery = lottery * 1664525u + 1013904223u;
    return ((float)(lottery >> 8) / 8388608.0f - 1) * 0.01f;
}

static void pi_acts_with(float wave, float noise_times)
{
    lottery = 1;
    for (unsigned k = 0; k < 2000; k++)
        gmv_record_pi(&r, W,
                      wave * (float)(k % 200 < 100 ? k % 100 : 100 - k % 100) / 100 +
                          noise_times * noise(),
                      0, SETTLED);
}

static void sensor_noise_shows_in_second_differences(void)
{
    pi_acts_with(0, 1);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 3.33e-5f, gmv_record_noise(&r));
}

static void what_moves_slowly_is_no_noise(void)
{
    pi_acts_with(0.1f, 0);
    TEST_ASSERT_TRUE(gmv_record_noise(&r) < 1e-7f);
    setUp();
    pi_acts_with(0.1f, 1);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 3.33e-5f, gmv_record_noise(&r));
}

static void noise_is_no_more_than_the_control_error(void)
{
    for (unsigned k = 0; k < 2000; k++)
        gmv_record_pi(&r, W, k % 2 ? 0.01f : -0.01f, 0, SETTLED);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1e-4f, gmv_record_noise(&r));
}

static void a_law_with_mean_squares_beyond_the_limits_would_be_worse(void)
{
    pi_acts(400, 0.004f, 0.002f);
    TEST_ASSERT_TRUE(gmv_record_would(&r, 1.7e-5f, 4e-5f));
    TEST_ASSERT_FALSE(gmv_record_would(&r, 1.5e-5f, 4e-5f));
    TEST_ASSERT_FALSE(gmv_record_would(&r, 1.7e-5f, 3.5e-5f));
    setUp();
    TEST_ASSERT_FALSE(gmv_record_would(&r, 1, 1));
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
    TEST_ASSERT_EQUAL_FLOAT(0, law_acts(10 * WINDOW, 0.1f, 0.02f));
}

static void a_pi_that_acts_again_renews_its_record(void)
{
    pi_acts(1000, 0.004f, 0.001f);
    law_begins();
    pi_acts(2000, 0.02f, 0.01f);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 4e-4f, r.error);
    law_begins();
    TEST_ASSERT_EQUAL_FLOAT(0, law_acts(10 * WINDOW, 0.03f, 0.02f));
}

static void without_a_record_nothing_is_judged(void)
{
    pi_acts(10, 0.004f, 0.001f);
    law_begins();
    TEST_ASSERT_EQUAL_FLOAT(0, law_acts(10 * WINDOW, 0.5f, 0.5f));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(more_than_twice_the_error_and_three_times_the_moves_for_two_windows_is_worse);
    RUN_TEST(a_window_that_is_no_worse_begins_the_count_anew);
    RUN_TEST(errors_below_half_a_percent_of_span_are_no_reason_by_themselves);
    RUN_TEST(three_times_the_moves_and_half_a_percent_of_span_at_no_smaller_error_is_worse);
    RUN_TEST(while_setpoints_move_moves_of_the_mv_are_not_judged);
    RUN_TEST(answers_to_setpoints_that_are_a_third_larger_than_the_pis_are_worse);
    RUN_TEST(answers_are_compared_for_the_same_size_of_the_move);
    RUN_TEST(noise_after_moves_smaller_than_the_pis_is_no_worse_answer);
    RUN_TEST(errors_of_a_tenth_of_a_percent_of_span_after_setpoints_decide_nothing);
    RUN_TEST(what_the_pv_does_while_the_mv_stands_at_a_limit_is_no_answer);
    RUN_TEST(what_the_law_takes_over_with_is_no_answer);
    RUN_TEST(what_comes_before_the_first_move_is_no_answer);
    RUN_TEST(answers_that_were_cut_short_say_nothing_of_a_whole_one);
    RUN_TEST(against_few_answers_of_the_pi_the_law_must_be_three_times_worse);
    RUN_TEST(against_next_to_no_answers_of_the_pi_nothing_is_judged);
    RUN_TEST(sensor_noise_shows_in_second_differences);
    RUN_TEST(what_moves_slowly_is_no_noise);
    RUN_TEST(noise_is_no_more_than_the_control_error);
    RUN_TEST(a_law_with_mean_squares_beyond_the_limits_would_be_worse);
    RUN_TEST(what_the_pi_does_after_a_setpoint_counts_until_it_has_been_at_rest);
    RUN_TEST(a_few_samples_at_rest_are_no_record_yet);
    RUN_TEST(a_pi_that_acts_again_renews_its_record);
    RUN_TEST(without_a_record_nothing_is_judged);
    return UNITY_END();
}
