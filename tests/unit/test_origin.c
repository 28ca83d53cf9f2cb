/* commission/origin.[ch]: where limits count from, through all tests.
 *
 * Contract
 *   what a drift as fast as the one before the first test carries, either way, is not left; all else is, and adds up
 */
#include "commission/origin.h"
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

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_first_rest_is_the_operating_point);
    RUN_TEST(what_tests_leave_adds_up);
    RUN_TEST(a_drift_that_was_there_before_is_none_of_it_even_if_it_turns);
    RUN_TEST(a_drift_that_begins_with_the_tests_is);
    RUN_TEST(a_drift_that_turns_between_two_looks_at_the_first_rest_is_known);
    return UNITY_END();
}
