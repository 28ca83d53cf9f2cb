/* Two thermometers that report one number, and a first reading that is the default of a chip, as people have reported both. */
#include "board_bench.h"

void setUp(void) {}
void tearDown(void) {}

static void both_read(double t1, double t10)
{
    board.values[0] = t1;
    board.values[1] = t10;
    samples(1);
}

static void two_that_change_to_the_same_number_ten_times_are_told_once(void)
{
    running();
    for (unsigned k = 0; k < 9; k++)
        both_read(90 + 0.1 * k, 90 + 0.1 * k);
    TEST_ASSERT_EQUAL(0, times_said("SAME_READING"));
    for (unsigned k = 0; k < 20; k++)
        both_read(80 + 0.1 * k, 80 + 0.1 * k);
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("warning SAME_READING T10 1 "), board.said);
    both_read(85, 86);
    for (unsigned k = 0; k < 10; k++)
        both_read(90 + 0.1 * k, 90 + 0.1 * k);
    TEST_ASSERT_EQUAL(2, times_said("warning SAME_READING T10 1 "));
}

static void so_are_two_with_other_calibrations(void)
{
    running();
    ask_ok("set meas2.zero 3");
    for (unsigned k = 0; k < 10; k++)
        both_read(90 + 0.1 * k, 90 + 0.1 * k);
    TEST_ASSERT_EQUAL(1, times_said("warning SAME_READING T10 1 "));
}

static void two_at_rest_at_one_temperature_are_not(void)
{
    running();
    for (unsigned k = 0; k < 100;
         k++) /* a resolution of 0.5: now the one steps, now the other, seldom both */
        both_read(k / 2 % 2 ? 90 : 90.5, (k + 1) / 2 % 2 ? 90 : 90.5);
    TEST_ASSERT_EQUAL(0, times_said("SAME_READING"));
}

static void nor_two_of_other_units(void)
{
    running();
    ask_ok("begin");
    ask_ok("set meas3.name feed");
    ask_ok("set meas3.unit l/h");
    ask_ok("apply");
    for (unsigned k = 0; k < 20; k++) {
        board.values[2] = 70 + k;
        both_read(70 + k, 100);
    }
    TEST_ASSERT_EQUAL(0, times_said("SAME_READING"));
}

/* The plant comes, and T10 sends these. */
static void starts_with(double first, double second, double then)
{
    power_on();
    board.values[1] = first;
    connect_plant();
    configure();
    ask_ok("set meas2.rate_limit 0.5");
    samples(1);
    board.values[1] = second;
    samples(1);
    board_forget();
    board.values[1] = then;
    samples(1);
}

static void a_first_reading_that_the_next_two_contradict_does_not_count(void)
{
    starts_with(85, 111, 111.2);
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("warning FIRST_READING T10 85"), board.said);
    TEST_ASSERT_EQUAL(1, times_said("info MEASUREMENT_GOOD T10 111.2"));
    samples(5);
    ask_ok("loop bottom");
    TEST_ASSERT_TRUE(said("111.2"));
    TEST_ASSERT_EQUAL(0, times_said("FIRST_READING"));
}

static void a_spike_after_the_first_reading_is_still_none(void)
{
    starts_with(111, 85, 111.2);
    TEST_ASSERT_EQUAL(0, times_said("FIRST_READING"));
    ask_ok("loop bottom");
    TEST_ASSERT_TRUE(said("111.2"));
}

static void without_a_rate_limit_it_is_told_as_well(void)
{
    power_on();
    board.values[1] = 85;
    connect_plant();
    configure();
    samples(1);
    board.values[1] = 111;
    samples(1);
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("warning FIRST_READING T10 85"), board.said);
}

static void later_a_jump_is_judged_as_ever(void)
{
    running();
    ask_ok("set meas2.rate_limit 0.5");
    samples(20);
    board_forget();
    board.values[1] = 100;
    samples(5);
    TEST_ASSERT_EQUAL(0, times_said("FIRST_READING"));
    TEST_ASSERT_EQUAL(1, times_said("alarm MEASUREMENT_BAD T10 100"));
    TEST_ASSERT_EQUAL(0, times_said("MEASUREMENT_GOOD"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(two_that_change_to_the_same_number_ten_times_are_told_once);
    RUN_TEST(so_are_two_with_other_calibrations);
    RUN_TEST(two_at_rest_at_one_temperature_are_not);
    RUN_TEST(nor_two_of_other_units);
    RUN_TEST(a_first_reading_that_the_next_two_contradict_does_not_count);
    RUN_TEST(a_spike_after_the_first_reading_is_still_none);
    RUN_TEST(without_a_rate_limit_it_is_told_as_well);
    RUN_TEST(later_a_jump_is_judged_as_ever);
    return UNITY_END();
}
