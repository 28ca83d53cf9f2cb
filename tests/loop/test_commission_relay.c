/* `commission relay`: one loop of Wood and Berry's column by a relay test, on the board in memory. The settings, the trial, the
 * next loop with the first one closed, and everything that ends a test: outputs where they were held. */
#include "commission_wood_berry.h"

void setUp(void)
{
    children_failed = 0;
}
void tearDown(void)
{
    TEST_ASSERT_EQUAL_MESSAGE(0, children_failed, "cases of this test, see above");
}

/* xD by R: the relay has been at work for some periods. */
static void relay_at_work(void)
{
    ask_ok("commission relay old_R");
    until("TEST_STEP R", 300);
    plant_steps(12);
    TEST_ASSERT_TRUE(phase_is("relay"));
    TEST_ASSERT_TRUE(fabs(commanded("R") - 1.95) > 0.01);
}

static void relay_done(const char *loop)
{
    char text[60];
    snprintf(text, sizeof text, "commission relay %s", loop);
    ask_ok(text);
    snprintf(text, sizeof text, "RELAY_DONE %s", loop);
    until(text, 1000);
}

static double figure(const char *command, const char *name)
{
    char text[40];
    ask_ok(command);
    snprintf(text, sizeof text, " %s ", name);
    for (unsigned i = 0; i < n_reply; i++) {
        const char *at = strstr(reply[i], text);
        if (at)
            return strtod(at + strlen(text), NULL);
    }
    TEST_FAIL_MESSAGE(name);
    return 0.0;
}

/* ---- what it finds ---- */

/* 12.8 %w/(lb/min) on these spans, 16.7 min, 1 min and half a sample of 1 min: Ku near 10, Pu near 8 samples */
static void it_finds_the_ultimate_point_of_one_loop(void)
{
    relay_done("old_R");
    TEST_ASSERT_TRUE(phase_is("ready"));
    double ku = figure("commission relay", "ultimate"), pu = figure("commission relay", "period");
    TEST_ASSERT_DOUBLE_WITHIN(1.5, 9.8, ku);
    TEST_ASSERT_DOUBLE_WITHIN(90.0, 420.0, pu);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * ku, ku / 3.2, figure("commission relay", "gain"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * pu, 2.2 * pu, figure("commission relay", "ti"));
    plant_step();
    ASSERT_OUTPUT(1.95, "R");
    ASSERT_OUTPUT(1.71, "S");
    TEST_ASSERT_TRUE(settings_are_as_before());
    TEST_ASSERT_TRUE(nothing_was_stored());
}

static void a_process_of_negative_gain_gets_a_direct_loop(void)
{
    relay_done("old_S");
    TEST_ASSERT_TRUE(figure("commission relay", "ultimate") < 0.0);
    ask_ok("commission edit");
    ask_ok("get loop2.action");
    TEST_ASSERT_TRUE(said("direct"));
}

static void only_its_own_settings_change(void)
{
    relay_done("old_R");
    ask_ok("commission edit");
    ask_ok("diff");
    TEST_ASSERT_TRUE(said("loop1.gain"));
    TEST_ASSERT_TRUE(said("loop1.ti"));
    TEST_ASSERT_FALSE(said("loop2"));
    TEST_ASSERT_FALSE(said("name"));
    ask_ok("abandon");
}

static void the_other_listings_say_where_to_look(void)
{
    relay_done("old_R");
    ask_ok("commission pairing");
    TEST_ASSERT_TRUE(said("commission relay"));
    ask_ok("commission gains");
    ask_ok("commission structure");
    ask_ok("commission proposal");
    TEST_ASSERT_TRUE(said("Tyreus"));
    ask_ok("commission model");
    TEST_ASSERT_TRUE(said("ultimate"));
    ask_ok("commission reject");
    plant_step();
    ask_ok("commission relay");
    TEST_ASSERT_TRUE(settings_are_as_before());
}

static void accepted_it_is_tried_and_kept(void)
{
    relay_done("old_R");
    ask_ok("commission accept");
    until("TRIAL_KEPT", 3000);
    ask_ok("loop old_R");
    TEST_ASSERT_TRUE(said(" auto "));
    TEST_ASSERT_TRUE(nothing_was_stored());
}

/* Loh and others: the second loop is found with the first one closed, which slows it. */
static void with_the_first_loop_closed_the_second_is_another_process(void)
{
    relay_done("old_S");
    double alone = figure("commission relay", "ultimate");
    ask_ok("commission reject");
    plant_step();
    relay_done("old_R");
    ask_ok("commission edit");
    ask_ok("apply");
    plant_steps(2);
    ask_ok("mode old_R auto");
    plant_steps(5);
    relay_done("old_S");
    double closed = figure("commission relay", "ultimate");
    TEST_ASSERT_TRUE(closed < 0.0 && closed / alone < 0.8 && closed / alone > 0.4);
    ask_ok("loop old_R");
    TEST_ASSERT_TRUE(said(" auto "));
}

static void the_wrong_settings_are_taken_back(void)
{
    relay_done("old_R");
    ask_ok("commission edit");
    ask_ok("set loop1.gain 30"); /* three times the ultimate gain */
    ask_ok("commission accept");
    until("TRIAL_FAILED", 3000);
    plant_steps(3);
    TEST_ASSERT_TRUE(phase_is("returned"));
    TEST_ASSERT_TRUE(settings_are_as_before());
    ASSERT_OUTPUT(1.95, "R");
    ask_ok("loop old_R");
    TEST_ASSERT_FALSE(said(" auto "));
}

static void it_finds_one_loop(void)
{
    wood_berry(NULL);
    remember_settings();
    CASE(it_finds_the_ultimate_point_of_one_loop);
    CASE(a_process_of_negative_gain_gets_a_direct_loop);
    CASE(only_its_own_settings_change);
    CASE(the_other_listings_say_where_to_look);
    CASE(accepted_it_is_tried_and_kept);
    CASE(with_the_first_loop_closed_the_second_is_another_process);
    CASE(the_wrong_settings_are_taken_back);
}

/* ---- what ends it ---- */

static void aborted(void)
{
    ask_ok("commission abort");
    plant_step();
    ended_with_everything_held("asked for");
}

static void paused_and_resumed(void)
{
    ask_ok("commission pause");
    plant_step();
    TEST_ASSERT_TRUE(phase_is("paused"));
    plant_step();
    ASSERT_OUTPUT(1.95, "R");
    ask_refused("commission skip", "STATE");
    ask_refused("commission relay old_S", "STATE");
    ask_ok("commission resume");
    until("RELAY_DONE old_R", 1500);
}

static void its_output_moved_by_hand(void)
{
    ask_ok("out old_R 2.1");
    plant_steps(2);
    ended("moved by somebody else");
    ASSERT_OUTPUT(2.1, "R");
}

static void another_loop_put_into_automatic(void)
{
    ask_ok("mode old_S auto");
    plant_steps(2);
    ended("old_S moved by somebody else");
    plant_step();
    ASSERT_OUTPUT(1.95, "R");
}

static void another_configuration(void)
{
    ask_ok("set loop2.gain 0.7");
    plant_steps(2);
    ended("configuration");
    plant_step();
    ASSERT_OUTPUT(1.95, "R");
}

static void defaults_and_an_abort_at_once(void)
{
    ask_ok("defaults"); /* the output tested is not there any more */
    ask_ok("commission abort");
    plant_steps(2);
    ended("another configuration");
}

static void the_measurement_is_lost(void)
{
    plant_event("xD.quality=3");
    plant_steps(6);
    ended("not valid");
    plant_step();
    ASSERT_OUTPUT(1.95, "R");
}

static void the_link_is_lost(void)
{
    board.mute = true;
    pass(3000);
    plant_connect();
    plant_steps(2);
    ended("safe state");
    TEST_ASSERT_TRUE(board.command.safe);
}

static void reset(void)
{
    nothing_goes_on_after_a_reset();
}

static void everything_that_ends_it_leaves_the_output_where_it_was(void)
{
    wood_berry(NULL);
    remember_settings();
    relay_at_work();
    CASE(aborted);
    CASE(paused_and_resumed);
    CASE(its_output_moved_by_hand);
    CASE(another_loop_put_into_automatic);
    CASE(another_configuration);
    CASE(defaults_and_an_abort_at_once);
    CASE(the_measurement_is_lost);
    CASE(the_link_is_lost);
    CASE(reset);
}

static void a_measurement_past_its_limit_ends_it(void)
{
    static const char *const narrow[] = {"set meas2.test_limit 0.05", "set mv1.test_step 0.4",
                                         NULL};
    wood_berry(narrow);
    ask_ok("commission relay old_R");
    until("COMMISSION_ENDED xB", 1000);
    ended_with_everything_held("went past its test limit");
}

static void an_output_that_does_nothing_ends_it(void)
{
    static const char *const deaf[] = {"set mv1.test_step 0.0001", "set test.longest 9000", NULL};
    wood_berry(deaf);
    ask_ok("commission relay old_R");
    until("COMMISSION_ENDED old_R", 1500);
    ended_with_everything_held("does not answer");
}

static void a_loop_of_the_wrong_action_ends_it(void)
{
    static const char *const wrong[] = {"set loop1.action direct", "set test.longest 12000", NULL};
    wood_berry(wrong);
    ask_ok("commission relay old_R");
    until("COMMISSION_ENDED old_R", 1500);
    double worst = strtod(strstr(board.said, "COMMISSION_ENDED old_R") + 22, NULL);
    TEST_ASSERT_TRUE(worst < 0.3); /* of a test limit */
    ended_with_everything_held("its action is wrong, the measurement went the other way");
}

/* ---- what is refused ---- */

static void what_cannot_be_is_refused(void)
{
    static const char *const cascade[] = {"set loop3.name top", "set loop3.pv xB",
                                          "set loop3.out old_R", "set loop3.ti 3000", NULL};
    wood_berry(cascade);
    ask_refused("commission relay nobody", "UNKNOWN");
    ask_refused("commission relay top", "STATE");
    ask_refused("commission begin old_R", "PARSE");
    ask_ok("mode old_R auto");
    plant_steps(2);
    ask_refused("commission relay old_R", "STATE");
    ask_ok("mode old_R manual");
    plant_steps(2);
    ask_ok("out old_R 4");
    plant_steps(2);
    ask_refused("commission relay old_R", "STATE"); /* no room */
    ask_ok("out old_R 1.95");
    plant_steps(2);
    ask_ok("commission relay");
    TEST_ASSERT_TRUE(said("no relay test has been done"));
    ask_ok("commission relay old_R");
    plant_step();
    ask_refused("commission relay old_S", "STATE");
    ask_refused("commission begin", "STATE");
    ask_ok("commission abort");
    plant_step();
    board.mute = true;
    pass(3000);
    plant_connect();
    plant_step();
    ask_refused("commission relay old_R", "STATE"); /* safe state */
}

/* The loops change places between the question and the tick. */
static void what_was_applied_first_counts_and_what_comes_after_spoils_it(void)
{
    wood_berry(NULL);
    ask_ok("set loop2.name bottom");
    ask_refused("commission relay old_S", "UNKNOWN");
    ask_ok("commission relay bottom");
    ask_ok("begin");
    ask_ok("set loop1.name old_S");
    ask_ok("set loop2.name old_R");
    ask_ok("apply");
    plant_steps(2);
    TEST_ASSERT_TRUE(phase_is("idle"));
    ask_ok("commission relay old_S");
    plant_step();
    TEST_ASSERT_TRUE(phase_is("relay"));
    ask_ok("commission");
    TEST_ASSERT_TRUE(said("loop old_S"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_finds_one_loop);
    RUN_TEST(everything_that_ends_it_leaves_the_output_where_it_was);
    RUN_TEST(a_measurement_past_its_limit_ends_it);
    RUN_TEST(an_output_that_does_nothing_ends_it);
    RUN_TEST(a_loop_of_the_wrong_action_ends_it);
    RUN_TEST(what_cannot_be_is_refused);
    RUN_TEST(what_was_applied_first_counts_and_what_comes_after_spoils_it);
    return UNITY_END();
}
