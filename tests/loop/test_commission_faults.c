/* Automatic start-up and faults: instruments, valves, the plant, the line, resets, in the middle of a test and while a fit or
 * the analysis is being worked out. Each case begins at the same moment of one run. Table for people:
 * docs/use/commission.md. */
#include "commission_wood_berry.h"

void setUp(void)
{
    children_failed = 0;
}
void tearDown(void)
{
    TEST_ASSERT_EQUAL_MESSAGE(0, children_failed, "cases of this test, see above");
}

static void loses(const char *event)
{
    plant_event(event);
    plant_steps(7);
    ended_with_everything_held("is not valid");
}

static void goes_on_to_the_end(void)
{
    until("PROPOSAL", 2000);
    ask_ok("commission pairing");
    TEST_ASSERT_TRUE(said("pair xD R"));
    TEST_ASSERT_TRUE(said("pair xB S"));
    ASSERT_OUTPUT(1.95, "R");
    ASSERT_OUTPUT(1.71, "S");
}

static void a_missing_measurement_ends_it(void)
{
    loses("xD.quality=3");
}

static void a_flagged_measurement_ends_it(void)
{
    loses("xB.quality=2");
}

static void a_measurement_that_is_no_number_ends_it(void)
{
    loses("xD.nan=1");
}

static void a_dead_measurement_reads_an_end_of_its_span(void)
{
    plant_event("xD.dead=1"); /* the lower end of its span, and calls it good */
    plant_steps(4);
    ended_with_everything_held("reads an end of its span");
}

static void single_readings_that_are_lost_are_outlived(void)
{
    plant_event("xD.dropout=0.05");
    goes_on_to_the_end();
}

static void samples_that_are_lost_are_outlived(void)
{
    for (unsigned n = 0; n < 60; n++) {
        board.time_ms += n % 10 ? 0 : TICK_MS;
        plant_step();
    }
    TEST_ASSERT_TRUE(phase_is("testing"));
    goes_on_to_the_end();
}

static void too_many_samples_lost_end_in_the_safe_state(void)
{
    board.time_ms += 20 * TICK_MS;
    plant_steps(2);
    ended("safe state");
    TEST_ASSERT_TRUE(board.command.safe);
}

static void a_spike_is_outlived(void)
{
    plant_event("xD.spike=3");
    plant_event("xD.spike_rate=0.3"); /* an hour of the plant's: one in 200 samples */
    goes_on_to_the_end();
}

static void a_small_disturbance_is_outlived(void)
{
    plant_event("xB.bias=0.3");
    until("PROPOSAL", 4000);
}

static void a_large_disturbance_ends_it_at_the_limit(void)
{
    plant_event("xB.bias=10");
    plant_steps(4);
    ended_with_everything_held("went past its test limit");
}

static void a_valve_that_does_not_follow_ends_it(void)
{
    plant_event("S.stuck=1.71");
    plant_steps(12);
    ended_with_everything_held("does not follow");
}

static void a_valve_on_its_way_is_no_fault(void)
{
    plant_event("S.slew=0.001"); /* 0.06 lb/min a sample */
    until("PROPOSAL", 3000);
}

static void a_plant_that_leaves_ends_in_the_safe_state(void)
{
    board.mute = true;
    pass(3000);
    TEST_ASSERT_TRUE(said("SAFE_STATE"));
    plant_connect();
    plant_steps(2);
    ended("safe state");
    TEST_ASSERT_TRUE(board.command.safe);
    ASSERT_OUTPUT(kind->channels[plant_channel_of("S")].safe, "S");
}

/* The hand is there before the first sample that could tell. */
static void a_hand_right_after_the_line_is_back_does_not_revive_it(void)
{
    board.mute = true;
    pass(3000);
    plant_connect();
    ask_ok("out old_R 1.95");
    ask_ok("out old_S 1.71"); /* as if nothing had been */
    plant_steps(2);
    ended("safe state");
}

static void everything_that_can_fail_in_a_test(void)
{
    wood_berry(NULL);
    second_step();
    CASE(a_missing_measurement_ends_it);
    CASE(a_flagged_measurement_ends_it);
    CASE(a_measurement_that_is_no_number_ends_it);
    CASE(a_dead_measurement_reads_an_end_of_its_span);
    CASE(single_readings_that_are_lost_are_outlived);
    CASE(samples_that_are_lost_are_outlived);
    CASE(too_many_samples_lost_end_in_the_safe_state);
    CASE(a_spike_is_outlived);
    CASE(a_small_disturbance_is_outlived);
    CASE(a_large_disturbance_ends_it_at_the_limit);
    CASE(a_valve_that_does_not_follow_ends_it);
    CASE(a_valve_on_its_way_is_no_fault);
    CASE(a_plant_that_leaves_ends_in_the_safe_state);
    CASE(a_hand_right_after_the_line_is_back_does_not_revive_it);
    CASE(nothing_goes_on_after_a_reset);
    CASE(nothing_goes_on_after_power_was_lost);
    CASE(a_reboot_is_a_reset);
}

/* ---- resets with a policy ---- */

/* Configuration from storage, outputs back where they were: less the test. */
static void with_policy(const char *policy)
{
    char line[40];
    const char *more[] = {line, "set restart.limit 3600", NULL};
    snprintf(line, sizeof line, "set restart.policy %s", policy);
    memory_port_erase_all();
    wood_berry(more);
    ask_ok("save");
    pass(500);
    TEST_ASSERT_FALSE(nothing_was_stored());
    memcpy(flash_before, memory_port_flash(), memory_port_flash_size());
    second_step();
    board_resets(HAL_RESET_WATCHDOG);
    plant_steps(4);
    TEST_ASSERT_TRUE(phase_is("ended"));
    TEST_ASSERT_FALSE(board.command.safe);
    ASSERT_OUTPUT(1.95, "R");
    ASSERT_OUTPUT(1.71, "S");
    TEST_ASSERT_TRUE(nothing_was_stored());
    memory_port_erase_all();
}

static void a_warm_restart_does_not_bring_the_test_signal_back(void)
{
    with_policy("hold");
    with_policy("resume");
}

/* ---- what is configured against faults ---- */

static void an_interlock_forces_its_output_and_the_others_are_held(void)
{
    plant_event("xB.bias=8");
    plant_steps(3);
    ended("an interlock holds the output");
    ASSERT_OUTPUT(1.0, "S");
    ASSERT_OUTPUT(1.95, "R");
}

static void a_measurement_that_must_not_be_lost_takes_the_safe_state(void)
{
    plant_event("xB.quality=2");
    plant_steps(5);
    ended("safe state");
    TEST_ASSERT_TRUE(board.command.safe);
}

static void a_sequence_does_not_begin_meanwhile(void)
{
    ask_refused("seq stop", "STATE");
    TEST_ASSERT_NOT_NULL(strstr(reply[n_reply - 1], "commission abort"));
    plant_steps(3);
    TEST_ASSERT_TRUE(phase_is("testing"));
}

static void what_is_configured_against_faults_acts_in_a_test_too(void)
{
    static const char *const more[] = {
        "set lock1.meas xB",   "set lock1.mv S",          "set lock1.limit 6",
        "set lock1.value 1",   "set meas2.fallback safe", "set meas2.hold 60",
        "set step1.seq stop",  "set step1.do out",        "set step1.what R",
        "set step1.value 1.5", "set step1.until confirm", NULL};
    wood_berry(more);
    second_step();
    CASE(an_interlock_forces_its_output_and_the_others_are_held);
    CASE(a_measurement_that_must_not_be_lost_takes_the_safe_state);
    CASE(a_sequence_does_not_begin_meanwhile);
    ask_ok("commission abort");
    plant_step();
    ask_ok("seq stop");
    plant_step();
    ask_refused("commission begin", "STATE");
    TEST_ASSERT_NOT_NULL(strstr(reply[n_reply - 1], "sequence"));
}

static void a_frozen_measurement_ends_it(void)
{
    static const char *const more[] = {"set meas1.frozen 300", NULL};
    commission_plant("wood-berry", TICK_MS, 1.0, more); /* what is noiseless looks frozen at rest */
    ask_ok("commission begin");
    until("TEST_STEP R", 1500);
    plant_steps(10);
    plant_event("xD.frozen=1");
    plant_steps(12);
    ended_with_everything_held("is not valid");
}

static void samples_that_are_missing_longer_than_a_test_can_bear_end_it(void)
{
    static const char *const more[] = {"set tick.miss_limit 1000", NULL};
    wood_berry(more);
    second_step();
    board.time_ms += 20 * TICK_MS;
    plant_steps(2);
    ended_with_everything_held("samples were missing");
}

/* ---- in the midst of the background's work ---- */

static void an_abort_ends_it_there(void)
{
    ask_ok("commission abort");
    plant_step();
    ended("asked for");
    ask_ok("commission begin");
    until("TEST_STEP u1", 300);
}

static void a_hand_ends_it_there(void)
{
    ask_ok("out u2 51");
    plant_steps(2);
    ended("moved by somebody else");
    ASSERT_OUTPUT(51, "u2");
    ASSERT_OUTPUT(50, "u1");
}

static void a_lost_measurement_ends_it_there(void)
{
    plant_event("y1.nan=1");
    plant_steps(10);
    ended("is not valid");
    ASSERT_OUTPUT(50, "u2");
    ASSERT_OUTPUT(50, "u1");
}

static void phase_ends_in_safe_state(void)
{
    board.mute = true;
    pass(3000);
    plant_connect();
    plant_steps(2);
    TEST_ASSERT_TRUE(phase_is("ended"));
    TEST_ASSERT_TRUE(board.command.safe);
}

static void everything_that_can_happen_while_it_works_something_out(void)
{
    static const char *const phases[] = {"fitting", "analysing"};
    commission_plant("air-compressor", 100, 0.0, NULL);
    ask_ok("commission begin");
    for (unsigned k = 0; k < 2; k++) {
        for (unsigned n = 0; !phase_is(phases[k]); n++) {
            TEST_ASSERT_TRUE(n < 4000);
            plant_step();
        }
        plant_steps(5);
        TEST_ASSERT_TRUE(phase_is(phases[k]));
        CASE(an_abort_ends_it_there);
        CASE(a_hand_ends_it_there);
        CASE(a_lost_measurement_ends_it_there);
        CASE(phase_ends_in_safe_state);
        CASE(nothing_goes_on_after_a_reset);
        CASE(nothing_goes_on_after_power_was_lost);
        CASE(a_reboot_is_a_reset);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(everything_that_can_fail_in_a_test);
    RUN_TEST(a_warm_restart_does_not_bring_the_test_signal_back);
    RUN_TEST(what_is_configured_against_faults_acts_in_a_test_too);
    RUN_TEST(a_frozen_measurement_ends_it);
    RUN_TEST(samples_that_are_missing_longer_than_a_test_can_bear_end_it);
    RUN_TEST(everything_that_can_happen_while_it_works_something_out);
    int failed = UNITY_END();
    plant_power_off();
    plant_library_free();
    return failed;
}
