/* An MV pushed against a limit while its own loop needs it the other way: for a while that may serve both loops, not for
 * long. REACH and the others are made up; given up after 4 * REACH + 32 steps (gmv_monitors.c). */
#include "kinds/gmv/gmv_supervise_state.h"
#include "unity.h"

#define REACH 5u
#define LONG  (4u * REACH + 32u)

static struct gmv_supervise s;
static struct gmv_observation seen;

void setUp(void)
{
    const struct gmv_supervise_config config = {.on = true,
                                                .loops = 1,
                                                .tune_steps = 2,
                                                .check_steps = 10,
                                                .day_steps = 1000,
                                                .reach = REACH,
                                                .gain_least = 0.001f,
                                                .quiet = 0.2f,
                                                .burst = 25};
    seen = (struct gmv_observation){
        .acting = 1, .good = 1, .control_error = {-0.1f}, .shortfall = {0.001f}};
    gmv_supervise_init(&s, &config);
    s.status.state = GMV_SELF_TUNING;
    s.tested_loops = 1;
}

void tearDown(void) {}

/* Returns whether it is given up within n steps. */
static bool given_up_within(unsigned n)
{
    const struct gmv_result result = {.complete = 1,
                                      .error = {0.0001f},
                                      .standstill = {0.02f},
                                      .information = {0.1f},
                                      .forgetting = {0.99f},
                                      .parameters = {3},
                                      .gain = {0.1f},
                                      .estimated = {0.1f},
                                      .trial_done = true,
                                      .outcome = {.decay = 0.9f}};
    for (unsigned k = 0; k < n; k++) {
        (void)gmv_supervise_look(&s, &seen);
        if (gmv_supervise_judge(&s, &seen, &result) & GMV_WISH_PI)
            return true;
    }
    return false;
}

static void pushed_the_wrong_way_for_long_it_is_given_up_with_how_far_the_pv_is_away(void)
{
    TEST_ASSERT_FALSE(given_up_within(LONG));
    TEST_ASSERT_TRUE(given_up_within(1));
    TEST_ASSERT_EQUAL(GMV_ALARM_WORSE, s.status.alarms);
    TEST_ASSERT_EQUAL_FLOAT(0.1f, s.status.alarm_value);
}

static void pushed_the_way_its_loop_needs_it_it_goes_on(void)
{
    seen.shortfall[0] = -0.001f;
    TEST_ASSERT_FALSE(given_up_within(4 * LONG));
}

static void near_its_setpoint_or_moving_it_goes_on(void)
{
    seen.control_error[0] = -0.009f;
    TEST_ASSERT_FALSE(given_up_within(4 * LONG));
    setUp();
    seen.move[0] = 0.001f;
    TEST_ASSERT_FALSE(given_up_within(4 * LONG));
}

/* A law that asks for as little beyond the limit as a rounding would is not pushing. */
static void it_is_pushed_by_more_than_four_parts_in_ten_thousand_of_the_span(void)
{
    seen.shortfall[0] = 0.00039f;
    TEST_ASSERT_FALSE(given_up_within(4 * LONG));
    seen.shortfall[0] = 0.00041f;
    TEST_ASSERT_TRUE(given_up_within(LONG + 1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(pushed_the_wrong_way_for_long_it_is_given_up_with_how_far_the_pv_is_away);
    RUN_TEST(pushed_the_way_its_loop_needs_it_it_goes_on);
    RUN_TEST(near_its_setpoint_or_moving_it_goes_on);
    RUN_TEST(it_is_pushed_by_more_than_four_parts_in_ten_thousand_of_the_span);
    return UNITY_END();
}
