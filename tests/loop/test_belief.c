/* Limits of belief: what a failed transmitter sends is not valid, and no loop acts for long on a doubtful reading without an alarm. The
 * first is rebuilt from a public report: 3.5 mA, -3.1 % of span, passed as good, and the heater went to 100 %. */
#include "board_bench.h"

void setUp(void)
{
    running(); /* T10 spans 60 to 160 degC and is held for 60 s */
    ask_ok("mode bottom auto");
    samples(2);
    board_forget();
}
void tearDown(void) {}

static void t10_reads(double value)
{
    board.values[1] = value;
    samples(1);
}

static void a_transmitter_that_reports_its_failure_is_not_believed(void)
{
    t10_reads(56.875); /* 3.5 mA */
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("alarm MEASUREMENT_BAD T10"), board.said);
    samples(61);
    TEST_ASSERT_EQUAL(1, times_said("MODE bottom 0"));
    ask_ok("alarm");
    TEST_ASSERT_TRUE(said("MEASUREMENT_BAD T10 out of range"));
    t10_reads(115);
    board_forget();
    t10_reads(167); /* 21.1 mA */
    TEST_ASSERT_EQUAL(1, times_said("alarm MEASUREMENT_BAD T10"));
}

static void what_a_sound_transmitter_can_send_is_valid(void)
{
    t10_reads(58);  /* 3.68 mA */
    t10_reads(166); /* 20.96 mA */
    TEST_ASSERT_EQUAL(0, times_said("MEASUREMENT_BAD"));
}

static void limits_of_its_own_take_the_place_of_those(void)
{
    ask_ok("begin");
    ask_ok("set meas2.valid_lo 100");
    ask_ok("set meas2.valid_hi 170");
    ask_ok("apply");
    t10_reads(169);
    TEST_ASSERT_EQUAL(0, times_said("MEASUREMENT_BAD"));
    t10_reads(99);
    TEST_ASSERT_EQUAL(1, times_said("alarm MEASUREMENT_BAD T10"));
}

static void limits_that_no_reading_could_meet_are_refused(void)
{
    ask_refused("set meas2.valid_lo 10", "RANGE");
    TEST_ASSERT_TRUE_MESSAGE(said("meas2.valid_lo: 'T10' must be below valid_hi"), board.said);
    ask_ok("begin");
    ask_ok("set meas2.valid_lo 170");
    ask_ok("set meas2.valid_hi 180");
    ask_refused("apply", "RANGE");
    TEST_ASSERT_TRUE_MESSAGE(said("meas2.valid_lo: 'T10'"), board.said);
}

static void a_loop_that_acts_on_a_doubtful_reading_is_an_alarm_after_the_hold(void)
{
    t10_reads(59); /* below its span, and not yet a failure */
    samples(58);
    TEST_ASSERT_EQUAL(0, times_said("DOUBTFUL"));
    samples(2);
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("alarm DOUBTFUL T10 59"), board.said);
    ask_ok("alarm");
    TEST_ASSERT_TRUE(said("DOUBTFUL T10 is uncertain and a loop acts on it"));
    t10_reads(115);
    TEST_ASSERT_EQUAL(1, times_said("info DOUBTFUL_OVER T10 115"));
    ask_ok("alarm");
    TEST_ASSERT_FALSE(said("DOUBTFUL"));
}

static void so_is_what_the_plant_itself_calls_uncertain(void)
{
    board.quality[1] = 1;
    samples(61);
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("alarm DOUBTFUL T10 115"), board.said);
}

static void while_no_loop_acts_on_it_there_is_no_such_alarm(void)
{
    ask_ok("mode bottom manual");
    t10_reads(59);
    samples(100);
    TEST_ASSERT_EQUAL(0, times_said("DOUBTFUL"));
}

static void a_reading_that_is_uncertain_now_and_then_is_none(void)
{
    for (unsigned k = 0; k < 200; k++)
        t10_reads(k % 20 ? 59 : 61);
    TEST_ASSERT_EQUAL(0, times_said("DOUBTFUL"));
}

static void what_stands_in_for_a_lost_reading_has_been_told_with_the_loss(void)
{
    ask_ok("set meas2.substitute 115");
    ask_ok("set meas2.fallback substitute");
    board.quality[1] = 2;
    samples(200);
    TEST_ASSERT_EQUAL(0, times_said("DOUBTFUL"));
    ask_ok("alarm");
    TEST_ASSERT_TRUE(said("MEASUREMENT_BAD T10"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_transmitter_that_reports_its_failure_is_not_believed);
    RUN_TEST(what_a_sound_transmitter_can_send_is_valid);
    RUN_TEST(limits_of_its_own_take_the_place_of_those);
    RUN_TEST(limits_that_no_reading_could_meet_are_refused);
    RUN_TEST(a_loop_that_acts_on_a_doubtful_reading_is_an_alarm_after_the_hold);
    RUN_TEST(so_is_what_the_plant_itself_calls_uncertain);
    RUN_TEST(while_no_loop_acts_on_it_there_is_no_such_alarm);
    RUN_TEST(a_reading_that_is_uncertain_now_and_then_is_none);
    RUN_TEST(what_stands_in_for_a_lost_reading_has_been_told_with_the_loss);
    return UNITY_END();
}
