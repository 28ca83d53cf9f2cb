/* Automatic start-up and people: what they may ask for in the middle of a test, what their hands on the plant do to it, and
 * when it does not begin. Each case begins at the same moment, the second input half-way through its positive half. */
#include "commission_wood_berry.h"

void setUp(void)
{
    children_failed = 0;
}
void tearDown(void)
{
    TEST_ASSERT_EQUAL_MESSAGE(0, children_failed, "cases of this test, see above");
}

static void abort_puts_everything_back(void)
{
    ask_ok("commission abort");
    plant_step();
    ended_with_everything_held("asked for");
    ask_ok("commission begin"); /* and it can be done again */
    until("TEST_STEP R", 300);
}

static void pause_holds_and_resume_tests_the_input_again(void)
{
    ask_ok("commission pause");
    plant_steps(2);
    ASSERT_OUTPUT(1.71, "S");
    TEST_ASSERT_TRUE(phase_is("paused"));
    plant_steps(100);
    ASSERT_OUTPUT(1.71, "S");
    ask_refused("commission pause", "STATE");
    ask_ok("commission resume");
    until("TEST_STEP S", 400);
    until("PROPOSAL", 1500);
}

static void a_paused_test_can_be_aborted(void)
{
    ask_ok("commission pause");
    plant_steps(30);
    ask_ok("commission abort");
    plant_step();
    ended_with_everything_held("asked for");
}

static void a_skipped_input_is_left_out(void)
{
    ask_ok("commission skip");
    until("PROPOSAL", 100);
    ask_ok("commission model");
    TEST_ASSERT_TRUE(said("input S"));
    TEST_ASSERT_TRUE(said("skipped"));
    TEST_ASSERT_FALSE(said("element xB S"));
    ask_ok("commission pairing");
    TEST_ASSERT_EQUAL(1, times_said("pair "));
    ASSERT_OUTPUT(1.71, "S");
}

static void the_input_before_can_be_tested_again(void)
{
    ask_ok("commission repeat");
    until("TEST_STEP R", 400);
    ASSERT_OUTPUT(1.71, "S");
    until("TEST_DONE R", 1500);
    until("TEST_STEP S", 300);
    until("PROPOSAL", 1500);
    ask_ok("commission model");
    TEST_ASSERT_EQUAL(2, times_said("rounds 1 "));
}

static void what_was_asked_and_not_taken_yet_is_not_lost(void)
{
    ask_ok("commission skip");
    ask_refused("commission pause", "BUSY");
    ask_ok("commission abort"); /* but that comes first */
    plant_step();
    ended_with_everything_held("asked for");
}

static void a_beginning_that_has_not_begun_can_be_taken_back(void)
{
    ask_ok("commission abort");
    plant_step();
    ask_ok("commission begin");
    ask_ok("commission abort");
    plant_steps(3);
    TEST_ASSERT_TRUE(phase_is("ended"));
}

static void a_hand_on_a_tested_output_ends_it_and_wins(void)
{
    ask_ok("out old_S 1.9");
    plant_steps(2);
    ended("moved by somebody else");
    ASSERT_OUTPUT(1.9, "S");
    ASSERT_OUTPUT(1.95, "R");
}

static void a_hand_on_another_tested_output_ends_it(void)
{
    ask_ok("out old_R 2.1");
    plant_steps(2);
    ended("moved by somebody else");
    ASSERT_OUTPUT(1.71, "S");
    ASSERT_OUTPUT(2.1, "R");
}

static void a_loop_put_into_automatic_ends_it(void)
{
    ask_ok("mode old_R auto");
    plant_steps(2);
    ended("moved by somebody else");
    ASSERT_OUTPUT(1.71, "S");
    TEST_ASSERT_DOUBLE_WITHIN(0.2, 1.95, commanded("R"));
}

static void another_configuration_ends_it(void)
{
    ask_ok("set test.rounds 2");
    plant_steps(2);
    ended_with_everything_held("another configuration");
}

static void it_does_not_begin_twice(void)
{
    ask_refused("commission begin", "STATE");
    ask_refused("commission resume", "STATE");
    ask_refused("commission accept", "STATE");
    ask_refused("commission edit", "STATE");
    ask_refused("commission reject", "STATE");
}

static void every_listing_says_something_at_any_time(void)
{
    static const char *const words[] = {"",         " plant",     " model",    " gains",
                                        " pairing", " structure", " proposal", " trial"};
    char line[40];
    for (unsigned n = 0; n < 600; n++) {
        if (n == 30)
            ask_ok("commission pause");
        if (n == 60)
            ask_ok("commission resume");
        for (unsigned k = 0; k < 8; k++) {
            snprintf(line, sizeof line, "commission%s", words[k]);
            ask_ok(line);
        }
        plant_step();
    }
}

static void everything_people_can_do_in_a_test(void)
{
    wood_berry(NULL);
    second_step();
    CASE(abort_puts_everything_back);
    CASE(pause_holds_and_resume_tests_the_input_again);
    CASE(a_paused_test_can_be_aborted);
    CASE(a_skipped_input_is_left_out);
    CASE(the_input_before_can_be_tested_again);
    CASE(what_was_asked_and_not_taken_yet_is_not_lost);
    CASE(a_beginning_that_has_not_begun_can_be_taken_back);
    CASE(a_hand_on_a_tested_output_ends_it_and_wins);
    CASE(a_hand_on_another_tested_output_ends_it);
    CASE(a_loop_put_into_automatic_ends_it);
    CASE(another_configuration_ends_it);
    CASE(it_does_not_begin_twice);
    CASE(every_listing_says_something_at_any_time);
}

static void operators_pause_and_abort_it_and_the_rest_is_for_engineers(void)
{
    static const char *const rest[] = {"begin",  "resume", "skip",   "repeat",
                                       "accept", "edit",   "reject", "discard"};
    char line[40];
    wood_berry(NULL);
    ask_ok("key pot_still");
    plant_step();
    ask_ok("commission begin");
    until("TEST_STEP R", 300);
    ask_ok("lock");
    ask_ok("commission pause");
    plant_steps(2);
    TEST_ASSERT_TRUE(phase_is("paused"));
    for (unsigned k = 0; k < sizeof rest / sizeof rest[0]; k++) {
        snprintf(line, sizeof line, "commission %s", rest[k]);
        ask_refused(line, "LOCKED");
    }
    ask_ok("commission abort");
    plant_step();
    TEST_ASSERT_TRUE(phase_is("ended"));
}

static void nothing_skipped_twice_over_is_analysed(void)
{
    wood_berry(NULL);
    ask_ok("commission begin");
    until("TEST_STEP R", 300);
    ask_ok("commission skip");
    plant_steps(2);
    ask_ok("commission skip");
    plant_steps(3);
    ended_with_everything_held("every input was skipped");
}

/* ---- when it may not begin ---- */

static void refused_because(const char *text)
{
    ask_refused("commission begin", "STATE");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(reply[n_reply - 1], text), reply[n_reply - 1]);
}

static void a_loop_acts(void)
{
    ask_ok("mode old_R auto");
    plant_step();
    refused_because("old_R");
}

static void no_room(void)
{
    ask_ok("out old_R 0");
    plant_step();
    refused_because("no room");
}

static void a_bad_reading(void)
{
    plant_event("xB.quality=2");
    plant_steps(3);
    refused_because("xB");
}

static void no_outputs(void)
{
    ask_ok("set mv1.test off");
    ask_ok("set mv2.test off");
    plant_step();
    refused_because("no manipulated variable");
}

static void no_measurements(void)
{
    ask_ok("set meas1.test off");
    ask_ok("set meas2.test off");
    plant_step();
    refused_because("no measurement");
}

static void safe_already(void)
{
    board.time_ms += 20 * TICK_MS;
    plant_steps(2);
    refused_because("safe state");
}

static void one_of_each_is_enough(void)
{
    ask_ok("set mv2.test off");
    ask_ok("set meas2.test off");
    plant_step();
    ask_ok("commission begin");
    until("PROPOSAL", 2000);
    ask_ok("commission pairing");
    TEST_ASSERT_TRUE(said("pair xD R lambda 1 "));
}

static void it_says_why_it_does_not_begin(void)
{
    wood_berry(NULL);
    CASE(a_loop_acts);
    CASE(no_room);
    CASE(a_bad_reading);
    CASE(no_outputs);
    CASE(no_measurements);
    CASE(safe_already);
    CASE(one_of_each_is_enough);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(everything_people_can_do_in_a_test);
    RUN_TEST(operators_pause_and_abort_it_and_the_rest_is_for_engineers);
    RUN_TEST(nothing_skipped_twice_over_is_analysed);
    RUN_TEST(it_says_why_it_does_not_begin);
    int failed = UNITY_END();
    plant_power_off();
    plant_library_free();
    return failed;
}
