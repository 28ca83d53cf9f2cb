/* The worked family's observer as fall-back: its point is what xD will be a minute later, and the estimate of the tick before,
 * a minute old, is what xD is now. By itself it says of a point that it is bad when its measurement is; frozen, for as long as
 * somebody works at the instrument, it goes on with what was sent alone, and calls that uncertain. */
#include "worked_family/worked_family_bench.h"

void setUp(void) {}
void tearDown(void)
{
    plant_power_off();
}

/* PIDs in auto, the observer frozen; xD is lost, and whoever stands in for it does. */
static void without_its_measurement(const char *stands_in)
{
    char line[40];
    column_at_rest(1);
    in_auto();
    ask_ok("block state_feedback off");
    snprintf(line, sizeof line, "set meas1.infer %s", stands_in);
    ask_ok(line);
    plant_steps(30);
    ask_ok("block observer freeze 19200");
    plant_event("xD.quality=2");
    plant_step();
}

static void a_loop_follows_its_setpoint_for_hours_without_its_measurement(void)
{
    without_its_measurement("xD_ahead");
    TEST_ASSERT_TRUE(reads_as("xD", "uncertain"));
    setpoint("top", 97);
    plant_steps(300);
    TEST_ASSERT_TRUE(reads_as("xD", "uncertain"));
    TEST_ASSERT_DOUBLE_WITHIN(0.15, 97, truly("xD"));
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 97, reads("xD"));
    TEST_ASSERT_DOUBLE_WITHIN(0.15, 0.5, truly("xB"));
    ask_ok("loop top");
    TEST_ASSERT_TRUE(said("auto"));
    /* And back, without a bump worth the name. */
    double reflux = commanded("R");
    plant_event("xD.quality=0");
    plant_steps(3);
    TEST_ASSERT_TRUE(reads_as("xD", "good"));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, reflux, commanded("R"));
}

static void without_the_estimate_the_loop_goes_to_manual_after_the_hold(void)
{
    without_its_measurement("-");
    plant_steps(25);
    ask_ok("loop top");
    TEST_ASSERT_TRUE(said("manual"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_loop_follows_its_setpoint_for_hours_without_its_measurement);
    RUN_TEST(without_the_estimate_the_loop_goes_to_manual_after_the_hold);
    return UNITY_END();
}
