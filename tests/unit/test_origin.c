/* commission/origin.[ch]: where limits count from, through all tests.
 *
 * Contract
 *   what a drift as fast as the one before the first test carries, either way, is not left; all else is, and adds up
 */
#include "commission/origin.h"
#include "commission/origin_state.h"
#include "unity.h"

static struct origin origin;

void setUp(void)
{
    origin = (struct origin){0};
}
void tearDown(void) {}

static void rest(double level, double slope, double slope_sd, double since_s)
{
    struct steady_result r = {
        .slope_per_s = (real_t)slope, .slope_sd_per_s = (real_t)slope_sd, .mean_sd = REAL_C(1e-6)};
    origin.since_s = (real_t)since_s;
    origin_take(&origin, 0, &r, (real_t)level);
    origin_taken(&origin);
}

#define LEFT(wanted) TEST_ASSERT_DOUBLE_WITHIN(1e-4, wanted, (double)origin.channel[0].left)

static void the_first_rest_is_the_operating_point(void)
{
    rest(0.5, 0, 1e-7, 0);
    TEST_ASSERT_TRUE(origin.fixed);
    LEFT(0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.03,
                              (double)origin_away(&origin, 0, REAL_C(0.53), REAL_C(0.2)));
}

static void what_tests_leave_adds_up(void)
{
    rest(0.5, 0, 1e-7, 0);
    rest(0.54, 0, 1e-7, 1000);
    LEFT(0.04);
    rest(0.58, 0, 1e-7, 1000);
    LEFT(0.08);
    TEST_ASSERT_TRUE(origin_spent(&origin, 0, REAL_C(0.2)) < REAL_C(1.0));
    rest(0.61, 0, 1e-7, 1000);
    TEST_ASSERT_TRUE(origin_spent(&origin, 0, REAL_C(0.2)) > REAL_C(1.0));
    rest(0.5, 0, 1e-7, 1000); /* it came back */
    LEFT(0.0);
}

static void a_drift_that_was_there_before_is_none_of_it_even_if_it_turns(void)
{
    rest(0.5, 1e-4, 1e-6, 0);
    rest(0.6, 1e-4, 1e-6, 1000);
    LEFT(0.0);
    rest(0.55, -1e-4, 1e-6, 500);
    LEFT(0.0);
    rest(0.40, -1e-4, 1e-6, 1000); /* a third of that is not */
    TEST_ASSERT_TRUE(origin.channel[0].left < REAL_C(-0.03));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.1, (double)origin.channel[0].moved);
}

static void a_drift_that_begins_with_the_tests_is(void)
{
    rest(0.5, 0, 1e-7, 0);
    rest(0.52, 1e-4, 1e-6, 1000); /* e-folds every 400 s or so: it runs away */
    rest(0.60, 4e-4, 1e-6, 1000);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.1, (double)origin.channel[0].left);
}

static void a_drift_that_turns_between_two_looks_at_the_first_rest_is_known(void)
{
    struct steady_result look = {.slope_per_s = REAL_C(1e-4), .slope_sd_per_s = REAL_C(5e-6)};
    origin_look(&origin, 0, &look);
    rest(0.5, 0, 1e-7, 0); /* up and down again */
    rest(0.4, 0, 1e-7, 1000);
    LEFT(0.0);
}

/* ---- number by number, of measurement 3 ---- */

static const struct origin_channel *at = &origin.channel[3];

static void seen(double level, double slope, double slope_sd, double mean_sd, double since_s)
{
    struct steady_result r = {.slope_per_s = (real_t)slope,
                              .slope_sd_per_s = (real_t)slope_sd,
                              .mean_sd = (real_t)mean_sd};
    origin.since_s = (real_t)since_s;
    origin_take(&origin, 3, &r, (real_t)level);
    origin_taken(&origin);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)origin.since_s);
    TEST_ASSERT_EQUAL_FLOAT((float)level, (float)at->level);
}

#define RATE(wanted, value)  TEST_ASSERT_DOUBLE_WITHIN(1e-9, wanted, (double)(value))
#define SHARE(wanted, value) TEST_ASSERT_DOUBLE_WITHIN(1e-6, wanted, (double)(value))

static void the_first_rest_says_how_fast_a_drift_can_be(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        origin.channel[3].left = origin.channel[3].moved = 9;
        seen(0.5, sign * 1e-4, 1e-5, 0, 7);
        RATE(1.625e-4, at->slope_most); /* 1.25 times the slope and three deviations */
        RATE(1.2e-4, at->drift_per_s);  /* the slope and two */
        SHARE(0.0, at->left);
        SHARE(0.0, at->moved);
        setUp(); /* below two deviations it is not significant */
        seen(0.5, sign * 1.99e-5, 1e-5, 0, 0);
        RATE(1.99e-5, at->drift_per_s);
        setUp();
        seen(0.5, sign * 2.01e-5, 1e-5, 0, 0);
        RATE(4.01e-5, at->drift_per_s);
    }
}

static void a_look_before_it_counts_from_three_deviations_on(void)
{
    struct steady_result r = {.slope_per_s = REAL_C(-2.9e-5), .slope_sd_per_s = REAL_C(1e-5)};
    origin_look(&origin, 3, &r);
    RATE(0.0, at->slope_most);
    RATE(0.0, at->drift_per_s);
    r.slope_per_s = REAL_C(-3.1e-5);
    origin_look(&origin, 3, &r);
    RATE(3.875e-5, at->slope_most); /* without its deviation */
    RATE(3.875e-5, at->drift_per_s);
    r.slope_per_s = REAL_C(3.05e-5); /* the fastest counts */
    origin_look(&origin, 3, &r);
    RATE(3.875e-5, at->slope_most);
    seen(0.5, 1e-6, 1e-6, 0, 0);
    RATE(3.875e-5, at->slope_most);
    RATE(3.875e-5, at->drift_per_s);
}

static void what_the_fastest_drift_and_two_deviations_do_not_explain_is_left(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        seen(0.5, 1e-4, 1e-5, 0, 0);
        seen(0.5 + sign * 0.0139, 0, 0, 0.001, 100); /* of 0.012 + 0.002 */
        SHARE(0.0, at->left);
        SHARE(sign * 0.0139, at->moved);
        seen(0.5 + sign * 0.0339, 0, 0, 0.001, 100);
        SHARE(sign * 0.006, at->left);
        SHARE(sign * 0.0339, at->moved);
        RATE(1.2e-4, at->drift_per_s);
        seen(0.5 + sign * 0.0539, sign * 1.5e-4, 1e-6, 0.001, 100); /* a faster one: 1.52e-4 */
        RATE(1.52e-4, at->drift_per_s);
        SHARE(sign * (0.006 + 0.02 - 0.0152 - 0.002), at->left);
        seen(0.5, sign * 9e-4, 1e-6, 0, 0); /* but not faster than it can be */
        RATE(1.625e-4, at->drift_per_s);
        SHARE(sign * (0.0088 - 0.0539), at->left);
        SHARE(0.0, at->moved);
    }
}

static void a_slope_is_a_drift_as_far_as_one_was_seen(void)
{
    origin.channel[3].slope_most = REAL_C(1e-4);
    RATE(1e-4, origin_drift(&origin, 3, REAL_C(2e-4)));
    RATE(-1e-4, origin_drift(&origin, 3, REAL_C(-2e-4)));
    RATE(5e-5, origin_drift(&origin, 3, REAL_C(5e-5)));
    RATE(-5e-5, origin_drift(&origin, 3, REAL_C(-5e-5)));
}

static void it_is_away_from_where_the_fastest_drift_may_have_carried_it(void)
{
    origin.since_s = 200;
    origin.channel[3].level = REAL_C(0.5);
    origin.channel[3].drift_per_s = REAL_C(1e-4);
    for (int sign = -1; sign <= 1; sign += 2) {
        SHARE(sign * 0.01, origin_away(&origin, 3, (real_t)(0.5 + sign * 0.03), REAL_C(0.2)));
        SHARE(0.0, origin_away(&origin, 3, (real_t)(0.5 + sign * 0.019), REAL_C(0.2)));
        /* no farther than that */
        SHARE(sign * 0.02, origin_away(&origin, 3, (real_t)(0.5 + sign * 0.03), REAL_C(0.01)));
    }
}

static void more_than_half_of_the_limit_is_too_much(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        origin.channel[3].left = (real_t)(sign * 0.125);
        TEST_ASSERT_EQUAL_FLOAT(1.0f, (float)origin_spent(&origin, 3, REAL_C(0.25)));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_first_rest_is_the_operating_point);
    RUN_TEST(what_tests_leave_adds_up);
    RUN_TEST(a_drift_that_was_there_before_is_none_of_it_even_if_it_turns);
    RUN_TEST(a_drift_that_begins_with_the_tests_is);
    RUN_TEST(a_drift_that_turns_between_two_looks_at_the_first_rest_is_known);
    RUN_TEST(the_first_rest_says_how_fast_a_drift_can_be);
    RUN_TEST(a_look_before_it_counts_from_three_deviations_on);
    RUN_TEST(what_the_fastest_drift_and_two_deviations_do_not_explain_is_left);
    RUN_TEST(a_slope_is_a_drift_as_far_as_one_was_seen);
    RUN_TEST(it_is_away_from_where_the_fastest_drift_may_have_carried_it);
    RUN_TEST(more_than_half_of_the_limit_is_too_much);
    return UNITY_END();
}
