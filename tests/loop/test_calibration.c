/* The calibration of a measurement: a reading is zero + gain times what the plant sends, wherever it is used. */
#include "board_bench.h"

void setUp(void)
{
    running(); /* T10 spans 60 to 160 degC, the plant sends 115 */
    board_forget();
}
void tearDown(void) {}

static void calibrate(const char *gain, const char *zero)
{
    char line[64];
    ask_ok("begin");
    snprintf(line, sizeof line, "set meas2.gain %s", gain);
    ask_ok(line);
    snprintf(line, sizeof line, "set meas2.zero %s", zero);
    ask_ok(line);
    ask_ok("apply");
    samples(1);
}

static void what_a_loop_shows_and_controls_is_calibrated(void)
{
    calibrate("1.02", "-3");
    ask_ok("loop bottom");
    TEST_ASSERT_TRUE_MESSAGE(said("114.3"), board.said);
}

static void limits_of_belief_look_at_the_calibrated_reading(void)
{
    calibrate("1", "-10");
    board.values[1] = 175; /* 165 degC */
    samples(1);
    TEST_ASSERT_EQUAL(0, times_said("MEASUREMENT_BAD T10"));
    board.values[1] = 177;
    samples(1);
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("MEASUREMENT_BAD T10 167"), board.said);
}

static void interlocks_look_at_the_calibrated_reading(void)
{
    ask_ok("begin");
    ask_ok("set lock1.meas T10");
    ask_ok("set lock1.mv heat");
    ask_ok("set lock1.limit 120");
    ask_ok("apply");
    samples(1);
    calibrate("1", "4");
    TEST_ASSERT_EQUAL(0, times_said("INTERLOCK_ON"));
    calibrate("1", "6");
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("INTERLOCK_ON heat 121"), board.said);
}

static void a_new_calibration_is_no_jump_of_the_process(void)
{
    ask_ok("set meas2.rate_limit 0.1");
    ask_ok("set meas2.filter 100");
    samples(1);
    calibrate("1.1", "0");
    samples(1);
    TEST_ASSERT_EQUAL_MESSAGE(0, times_said("MEASUREMENT_BAD T10"), board.said);
    ask_ok("loop bottom");
    TEST_ASSERT_TRUE_MESSAGE(said("126.5"), board.said);
}

static void it_stands_beside_the_offset_of_a_sequence(void)
{
    ask_ok("begin");
    ask_ok("set meas2.offset 2");
    ask_ok("set step1.seq start");
    ask_ok("set step1.do offset_on");
    ask_ok("set step1.what T10");
    ask_ok("apply");
    samples(1);
    calibrate("1", "5");
    ask_ok("seq start");
    samples(2);
    ask_ok("loop bottom");
    TEST_ASSERT_TRUE_MESSAGE(said("118"), board.said);
}

static void it_lasts_over_a_loss_of_power(void)
{
    calibrate("1.02", "-3");
    ask_ok("save");
    power_on();
    connect_plant();
    samples(2);
    ANSWERS("get meas2.gain", "meas2.gain = 1.02 EU/EU");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_a_loop_shows_and_controls_is_calibrated);
    RUN_TEST(limits_of_belief_look_at_the_calibrated_reading);
    RUN_TEST(interlocks_look_at_the_calibrated_reading);
    RUN_TEST(a_new_calibration_is_no_jump_of_the_process);
    RUN_TEST(it_stands_beside_the_offset_of_a_sequence);
    RUN_TEST(it_lasts_over_a_loss_of_power);
    return UNITY_END();
}
