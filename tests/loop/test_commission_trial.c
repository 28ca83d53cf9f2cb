/* Automatic start-up with a proposal: rejected, edited, accepted, on trial; and what can come in between. A trial that does
 * not end well leaves the old configuration and the outputs as they were. */
#include "commission_wood_berry.h"

void setUp(void)
{
    children_failed = 0;
}
void tearDown(void)
{
    TEST_ASSERT_EQUAL_MESSAGE(0, children_failed, "cases of this test, see above");
}

static void old_settings_are_back(const char *reason)
{
    char text[120];
    plant_steps(3);
    TEST_ASSERT_TRUE(phase_is("returned"));
    snprintf(text, sizeof text, "%s", reason);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(reply[1], text), reply[1]);
    TEST_ASSERT_TRUE(settings_are_as_before());
    ask_ok("loop");
    TEST_ASSERT_FALSE(said(" auto "));
    TEST_ASSERT_TRUE(nothing_was_stored());
}

static void old_settings_and_outputs_are_back(const char *reason)
{
    old_settings_are_back(reason);
    ASSERT_OUTPUT(1.95, "R");
    ASSERT_OUTPUT(1.71, "S");
}

/* ---- with a proposal ---- */

static void rejected_it_is_gone(void)
{
    ask_ok("commission reject");
    plant_step();
    TEST_ASSERT_TRUE(phase_is("idle"));
    ask_refused("commission accept", "STATE");
    ask_refused("commission edit", "STATE");
    TEST_ASSERT_TRUE(settings_are_as_before());
}

static void edited_it_is_a_transaction(void)
{
    ask_ok("commission edit");
    ask_refused("commission edit", "STATE");
    ask_ok("get loop1.pv");
    TEST_ASSERT_TRUE(said("xD"));
    ask_ok("commission accept");
    until("TRIAL_KEPT", 4000);
}

static void edited_with_a_change_of_ones_own_the_change_is_tried(void)
{
    ask_ok("commission edit");
    ask_ok("set loop1.gain 1.5");
    ask_ok("set loop1.sp_ramp 0.5");
    ask_ok("commission accept");
    until("TRIAL_BEGUN", 5);
    ask_ok("get loop1.gain");
    TEST_ASSERT_TRUE(said(" 1.5 "));
    until("TRIAL_", 4000);
}

static void edited_and_abandoned_it_is_still_there(void)
{
    ask_ok("commission edit");
    ask_ok("abandon");
    TEST_ASSERT_TRUE(settings_are_as_before());
    TEST_ASSERT_TRUE(phase_is("ready"));
    ask_ok("commission accept");
    until("TRIAL_BEGUN", 5);
}

static void edited_and_applied_by_hand_there_is_no_trial(void)
{
    ask_ok("commission edit");
    ask_ok("apply");
    plant_steps(5);
    TEST_ASSERT_TRUE(phase_is("ready"));
    ask_ok("loop");
    TEST_ASSERT_FALSE(said(" auto "));
    ask_ok("commission accept"); /* the same loops, now on trial */
    until("TRIAL_KEPT", 4000);
}

static void a_transaction_without_the_pairs_is_not_accepted(void)
{
    ask_ok("begin");
    ask_refused("commission accept", "STATE");
    ask_ok("abandon");
    ask_ok("commission edit");
    ask_ok("set loop1.name -");
    ask_refused("commission accept", "UNKNOWN");
    ask_ok("abandon");
    plant_steps(2);
    TEST_ASSERT_TRUE(settings_are_as_before());
    TEST_ASSERT_TRUE(phase_is("ready"));
}

static void a_transaction_that_is_refused_changes_nothing(void)
{
    ask_ok("commission edit");
    ask_ok("set loop1.sp_lo 1e6");
    TEST_ASSERT_EQUAL_STRING_LEN("err ", ask("commission accept"), 4);
    TEST_ASSERT_TRUE(phase_is("ready"));
    ask_ok("abandon");
    TEST_ASSERT_TRUE(settings_are_as_before());
}

static void other_channels_get_no_trial(void)
{
    ask_ok("set meas1.hi 130");
    plant_step();
    ask_refused("commission accept", "CONFLICT");
    ask_refused("commission edit", "CONFLICT");
}

static void moved_meanwhile_the_trial_begins_where_it_is(void)
{
    ask_ok("out old_R 2.05");
    plant_steps(400);
    remember_settings();
    ask_ok("commission accept");
    until("SETPOINT", 500);
    plant_steps(10);
    ask_ok("commission abort");
    plant_steps(3);
    TEST_ASSERT_TRUE(settings_are_as_before());
    ASSERT_OUTPUT(2.05, "R");
    ASSERT_OUTPUT(1.71, "S");
}

static void not_accepted_while_the_plant_is_gone_or_safe(void)
{
    board.mute = true;
    pass(3000);
    ask_refused("commission accept", "STATE");
    plant_connect();
    plant_steps(2);
    ask_refused("commission accept", "STATE");
    TEST_ASSERT_TRUE(settings_are_as_before());
}

static void accepted_and_gone_at_once_it_is_taken_back(void)
{
    ask_ok("commission accept");
    board.mute = true;
    pass(3000);
    plant_connect();
    plant_steps(4);
    TEST_ASSERT_TRUE(phase_is("returned"));
    TEST_ASSERT_TRUE(settings_are_as_before());
    TEST_ASSERT_TRUE(board.command.safe);
}

static void accepted_and_aborted_at_once_it_is_taken_back(void)
{
    ask_ok("commission accept");
    ask_ok("commission abort");
    plant_steps(4);
    TEST_ASSERT_TRUE(settings_are_as_before());
    TEST_ASSERT_TRUE(phase_is("ready"));
    ASSERT_OUTPUT(1.95, "R");
}

static void accepted_and_overtaken_by_another_configuration_there_is_no_trial(void)
{
    ask_ok("commission accept");
    ask_ok("set loop1.gain 0.5");
    plant_steps(4);
    ended("another configuration");
    ask_ok("loop");
    TEST_ASSERT_FALSE(said(" auto "));
    ask_ok("commission begin"); /* nothing is stuck */
}

static void a_bad_reading_at_the_beginning_takes_it_back(void)
{
    ask_ok("commission accept");
    plant_event("xD.quality=3");
    until("TRIAL_FAILED", 20);
    old_settings_and_outputs_are_back("is not valid");
}

/* A new beginning is asked for, and the results are looked at before the tick takes it. */
static void results_about_to_be_overwritten_are_not_listed(void)
{
    ask_ok("commission begin");
    ask_ok("commission gains");
    TEST_ASSERT_TRUE(said("nothing yet"));
    ask_refused("commission edit", "STATE");
    plant_steps(3);
    TEST_ASSERT_TRUE(phase_is("testing"));
}

static void accepted_and_saved_at_once_it_is_not(void)
{
    ask_ok("commission accept");
    ask_refused("save", "STATE");
}

static void everything_that_can_happen_to_a_proposal(void)
{
    wood_berry(NULL);
    proposal();
    remember_settings();
    CASE(rejected_it_is_gone);
    CASE(edited_it_is_a_transaction);
    CASE(edited_with_a_change_of_ones_own_the_change_is_tried);
    CASE(edited_and_abandoned_it_is_still_there);
    CASE(edited_and_applied_by_hand_there_is_no_trial);
    CASE(a_transaction_without_the_pairs_is_not_accepted);
    CASE(a_transaction_that_is_refused_changes_nothing);
    CASE(other_channels_get_no_trial);
    CASE(moved_meanwhile_the_trial_begins_where_it_is);
    CASE(not_accepted_while_the_plant_is_gone_or_safe);
    CASE(accepted_and_saved_at_once_it_is_not);
    CASE(accepted_and_gone_at_once_it_is_taken_back);
    CASE(accepted_and_aborted_at_once_it_is_taken_back);
    CASE(accepted_and_overtaken_by_another_configuration_there_is_no_trial);
    CASE(a_bad_reading_at_the_beginning_takes_it_back);
    CASE(results_about_to_be_overwritten_are_not_listed);
}

/* ---- on trial ---- */

static void a_plant_that_is_another_now_fails_it(void)
{
    plant_event("R.readback=2"); /* nobody sees that the valve hangs */
    plant_event("R.stuck=1.95");
    until("TRIAL_FAILED", 4000);
    plant_event("R.free=1");
    old_settings_and_outputs_are_back("on trial");
}

static void a_sluggish_valve_fails_it(void)
{
    plant_event("S.readback=2");
    plant_event("S.lag=20000");
    until("TRIAL_", 6000);
    TEST_ASSERT_TRUE(said("TRIAL_FAILED"));
    old_settings_and_outputs_are_back("on trial");
}

static void a_disturbance_past_the_limit_fails_it(void)
{
    plant_event("xB.bias=12");
    until("TRIAL_FAILED", 10);
    old_settings_and_outputs_are_back("test limit on trial");
}

static void abort_on_trial_takes_it_back(void)
{
    ask_ok("commission abort");
    plant_step();
    old_settings_and_outputs_are_back("asked for");
}

static void a_hand_on_trial_keeps_what_it_holds(void)
{
    ask_ok("mode xD manual");
    ask_ok("out xD 2.3");
    plant_steps(2);
    old_settings_are_back("moved by somebody else");
    ASSERT_OUTPUT(2.3, "R");
    ASSERT_OUTPUT(1.71, "S");
}

static void a_lost_measurement_on_trial_takes_it_back(void)
{
    plant_event("xB.quality=3");
    plant_steps(6);
    old_settings_and_outputs_are_back("is not valid");
}

static void a_configuration_on_trial_stays(void)
{
    ask_ok("set loop1.gain 0.7");
    plant_steps(3);
    ended("another configuration");
    ask_ok("get loop1.gain");
    TEST_ASSERT_TRUE(said(" 0.7 "));
}

static void a_configuration_and_an_abort_at_once_leave_the_configuration(void)
{
    ask_ok("set loop1.gain 0.7");
    ask_ok("commission abort");
    plant_steps(3);
    ended("another configuration");
    ask_ok("get loop1.gain");
    TEST_ASSERT_TRUE(said(" 0.7 "));
}

static void a_plant_that_leaves_on_trial_takes_it_back(void)
{
    board.mute = true;
    pass(3000);
    plant_connect();
    plant_steps(2);
    old_settings_are_back("safe state");
    TEST_ASSERT_TRUE(board.command.safe);
}

static void behind_an_open_transaction_the_old_set_waits(void)
{
    ask_ok("begin");
    ask_ok("commission abort");
    plant_steps(5);
    TEST_ASSERT_TRUE(phase_is("returned"));
    ask_refused("commission begin", "STATE");
    TEST_ASSERT_NOT_NULL(strstr(reply[n_reply - 1], "transaction"));
    ASSERT_OUTPUT(1.95, "R"); /* in manual meanwhile, where they were */
    ask_ok("abandon");
    plant_steps(2);
    old_settings_and_outputs_are_back("asked for");
    ask_ok("commission begin");
}

static void what_is_on_trial_is_not_saved(void)
{
    ask_refused("save", "STATE");
    until("TRIAL_KEPT", 6000);
    TEST_ASSERT_NULL(strstr(ask("save"), "trial"));
}

static void a_sequence_does_not_begin_on_trial(void)
{
    ask_refused("seq stop", "STATE");
}

static void everything_that_can_happen_on_trial(void)
{
    wood_berry(NULL);
    proposal();
    remember_settings();
    ask_ok("commission accept");
    until("SETPOINT", 500);
    plant_steps(15);
    TEST_ASSERT_TRUE(phase_is("trial"));
    CASE(a_plant_that_is_another_now_fails_it);
    CASE(a_sluggish_valve_fails_it);
    CASE(a_disturbance_past_the_limit_fails_it);
    CASE(abort_on_trial_takes_it_back);
    CASE(a_hand_on_trial_keeps_what_it_holds);
    CASE(a_lost_measurement_on_trial_takes_it_back);
    CASE(a_configuration_on_trial_stays);
    CASE(a_configuration_and_an_abort_at_once_leave_the_configuration);
    CASE(a_plant_that_leaves_on_trial_takes_it_back);
    CASE(behind_an_open_transaction_the_old_set_waits);
    CASE(what_is_on_trial_is_not_saved);
    CASE(a_sequence_does_not_begin_on_trial);
    CASE(nothing_goes_on_after_a_reset);
    CASE(nothing_goes_on_after_power_was_lost);
    CASE(a_reboot_is_a_reset);
}

static void accepted_it_is_tried_and_kept(void)
{
    ask_ok("commission accept");
    until("TRIAL_KEPT", 4000);
    TEST_ASSERT_TRUE(phase_is("kept"));
    ask_ok("loop");
    TEST_ASSERT_EQUAL(2, times_said(" auto "));
    TEST_ASSERT_FALSE(settings_are_as_before());
    TEST_ASSERT_TRUE(nothing_was_stored());
    ask_ok("get loop1.pv");
    ask_refused("commission begin", "STATE"); /* they act */
}

static void kept_it_is_watched_for_as_long_as_was_asked_for(void)
{
    ask_ok("commission accept");
    until("TRIAL_KEPT", 4000);
    TEST_ASSERT_TRUE(said("`commission watch`"));
    ask_refused("commission watch 0", "RANGE");
    ask_ok("commission watch 5");
    until("WATCH_BEGUN", 2);
    ask_ok("commission status");
    TEST_ASSERT_TRUE(said("phase watching"));
    TEST_ASSERT_TRUE(said("left"));
    ask_refused("commission begin", "STATE");
    until("WATCH_ENDED", 400);
    TEST_ASSERT_TRUE(said("WATCH_LOOP xD"));
    TEST_ASSERT_TRUE(said("WATCH_LOOP xB"));
    TEST_ASSERT_TRUE(phase_is("kept"));
    ask_ok("commission watched");
    TEST_ASSERT_TRUE(said("watched xD largest"));
    TEST_ASSERT_FALSE(settings_are_as_before());
}

static void a_hand_ends_the_watch_and_keeps_the_settings(void)
{
    ask_ok("commission accept");
    until("TRIAL_KEPT", 4000);
    ask_ok("commission watch");
    until("WATCH_BEGUN", 2);
    ask_ok("mode xD manual");
    until("WATCH_ENDED", 3);
    TEST_ASSERT_TRUE(said("moved by somebody else"));
    TEST_ASSERT_FALSE(settings_are_as_before());
}

static void left_alone_it_is_tested_tried_and_kept(void)
{
    wood_berry(NULL);
    proposal();
    remember_settings();
    CASE(accepted_it_is_tried_and_kept);
    CASE(kept_it_is_watched_for_as_long_as_was_asked_for);
    CASE(a_hand_ends_the_watch_and_keeps_the_settings);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(left_alone_it_is_tested_tried_and_kept);
    RUN_TEST(everything_that_can_happen_to_a_proposal);
    RUN_TEST(everything_that_can_happen_on_trial);
    int failed = UNITY_END();
    plant_power_off();
    plant_library_free();
    return failed;
}
