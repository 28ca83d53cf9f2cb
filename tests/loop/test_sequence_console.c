/* Sequences at the console: what `seq` shows and refuses, events, telemetry, access, configuration, resets. */
#include "board_bench.h"
#include "hal/identity.h"

static void rows(void)
{
    static const char *const lines[] = {
        "begin",
        "set meas3.name feed",
        "set meas3.unit l/h",
        "set meas3.hi 10",
        "set meas3.hold 5",
        "set meas3.offset 2",
        "set step1.seq start",
        "set step1.do guard",
        "set step1.until above",
        "set step1.meas feed",
        "set step1.limit 1",
        "set step1.hold 10",
        "set step2.seq start",
        "set step2.do out",
        "set step2.what heat",
        "set step2.value 0.9",
        "set step2.until above",
        "set step2.meas T10",
        "set step2.limit 120",
        "set step2.hold 3",
        "set step2.timeout 100",
        "set step3.seq start",
        "set step3.do offset_on",
        "set step3.what feed",
        "set step4.seq start",
        "set step4.until confirm",
        "set step4.timeout 500",
        "set step4.else hold",
        "set step5.seq start",
        "set step5.do auto",
        "set step5.what bottom",
        "set step6.seq start",
        "set step6.do sp",
        "set step6.what bottom",
        "set step6.value 118",
        "set step7.seq stop",
        "set step7.do out",
        "set step7.what heat",
        "set step7.value 0.5",
        "set step8.seq stop",
        "set step8.until time",
        "set step8.hold 30",
        "apply",
    };
    for (unsigned i = 0; i < sizeof lines / sizeof lines[0]; i++)
        ask_ok(lines[i]);
    samples(2);
    board_forget();
}

void setUp(void)
{
    running();
    rows();
}
void tearDown(void) {}

static void at_confirm(void)
{
    ask_ok("seq start");
    samples(3);
    board.values[1] = 125;
    samples(6);
    ask_ok("seq");
    TEST_ASSERT_TRUE(said("start confirm at step 4"));
    board_forget();
}

static void seq_shows_where_it_is_and_how_far(void)
{
    ask_ok("seq");
    TEST_ASSERT_EQUAL_STRING("idle", reply[0]);
    ask_ok("seq start");
    samples(11);
    ask_ok("seq");
    TEST_ASSERT_EQUAL_STRING("start running at step 2", reply[0]);
    TEST_ASSERT_EQUAL_STRING(
        "  step 2: out heat 0.9 kW, until T10 above 120 degC for 3 s; after 100 s abort", reply[1]);
    TEST_ASSERT_EQUAL_STRING(
        "  T10 = 115 degC; has held 0 s of 3 s; in step 10 s, time-out in 90 s", reply[2]);
    TEST_ASSERT_EQUAL_STRING(
        "  step 1: guard feed above 1 l/h; after 10 s without abort; feed = 5 l/h", reply[3]);
    TEST_ASSERT_EQUAL_STRING("ok", reply[4]);
    board.values[1] = 125;
    samples(3);
    ask_ok("seq");
    TEST_ASSERT_TRUE(said("has held 2 s of 3 s"));
    samples(2);
    ask_ok("seq");
    TEST_ASSERT_EQUAL_STRING("  step 4: wait until the operator confirms; after 500 s hold",
                             reply[1]);
    TEST_ASSERT_EQUAL_STRING("  waits for `seq confirm`; in step 1 s, time-out in 499 s", reply[2]);
    ask_ok("seq hold");
    samples(1);
    ask_ok("seq");
    TEST_ASSERT_EQUAL_STRING("start held at step 4: by the operator", reply[0]);
    TEST_ASSERT_TRUE(said("waits for `seq go`"));
    ask_ok("alarm");
    TEST_ASSERT_TRUE(said("SEQUENCE start held at step 4: by the operator"));
}

static void its_rows_are_listed_in_words(void)
{
    ask_ok("seq list");
    TEST_ASSERT_EQUAL(9, n_reply);
    TEST_ASSERT_EQUAL_STRING("start step 1: guard feed above 1 l/h; after 10 s without abort",
                             reply[0]);
    TEST_ASSERT_EQUAL_STRING("start step 3: offset on feed", reply[2]);
    TEST_ASSERT_EQUAL_STRING("start step 6: sp bottom 118 degC", reply[5]);
    TEST_ASSERT_EQUAL_STRING("stop step 8: wait until 30 s have passed", reply[7]);
}

static void from_start_to_done_everything_is_told(void)
{
    at_confirm();
    ask_ok("seq confirm");
    board_forget();
    samples(1);
    TEST_ASSERT_TRUE(said(" info SEQUENCE_CONFIRMED start 4 "));
    TEST_ASSERT_TRUE(said(" info MODE bottom 1 "));
    TEST_ASSERT_TRUE(said(" info SEQUENCE_DONE start 6 "));
    ask_ok("seq");
    TEST_ASSERT_EQUAL_STRING("start done at step 6", reply[0]);
    ask_ok("seq stop");
    samples(40);
    TEST_ASSERT_TRUE(said(" info SEQUENCE_DONE stop 8 "));
    ask_ok("events");
    TEST_ASSERT_TRUE(said("action DO_SEQUENCE start 0 "));
    TEST_ASSERT_TRUE(said("action DO_SEQUENCE confirm 0 "));
    TEST_ASSERT_TRUE(said("action DO_SEQUENCE stop 0 "));
    TEST_ASSERT_TRUE(said("info SEQUENCE_STEP start 2 "));
    TEST_ASSERT_TRUE(said("info OFFSET feed 2 "));
}

static void an_abort_says_why_and_where(void)
{
    ask_ok("seq start");
    samples(5);
    board_forget();
    board.values[2] = 0.5;
    samples(12);
    TEST_ASSERT_TRUE(said(" alarm SEQUENCE_ABORTED feed 2 sequence aborted into the safe state at "
                          "step: start, guard"));
    TEST_ASSERT_TRUE(said(" alarm SAFE_STATE sequence 0 "));
    TEST_ASSERT_TRUE(board.command.safe);
    ask_ok("seq");
    TEST_ASSERT_EQUAL_STRING("start aborted at step 2: guard, feed", reply[0]);
    ask_ok("alarm");
    TEST_ASSERT_TRUE(said("SEQUENCE start aborted at step 2: guard, feed"));
    ask_ok("out bottom 0.6"); /* somebody acts: no longer an alarm */
    samples(1);
    ask_ok("alarm");
    TEST_ASSERT_FALSE(said("SEQUENCE"));
}

static void what_is_not_possible_is_refused_in_one_line(void)
{
    static const char *const idle[] = {"seq hold", "seq go", "seq confirm", "seq skip",
                                       "seq abort"};
    for (unsigned i = 0; i < 5; i++)
        ask_refused(idle[i], "STATE");
    ask_refused("seq begin", "PARSE");
    ask_refused("seq start now", "PARSE");
    ask_ok("mode bottom auto");
    ask_refused("seq start", "STATE"); /* also before the tick has met the mode */
    TEST_ASSERT_TRUE(said("all loops in manual"));
    ask_ok("mode bottom manual");
    ask_ok("seq start");
    samples(2);
    ask_refused("seq start", "STATE");
    ask_refused("seq confirm", "STATE");
    ask_refused("seq go", "STATE");
    ask_ok("seq hold");
    samples(1);
    ask_refused("seq hold", "STATE");
    ask_ok("seq stop");
    samples(1);
    ask_refused("seq stop", "STATE");
    ask_ok("seq abort");
    samples(1);
    ask_refused("seq abort", "STATE");
}

static void without_rows_or_a_plant_nothing_starts(void)
{
    ask_ok("set step8.seq none");
    samples(1);
    ask_ok("set step7.seq none");
    samples(1);
    ask_refused("seq stop", "STATE");
    TEST_ASSERT_TRUE(said("no row is configured"));
    board.mute = true;
    pass(3000);
    ask_refused("seq start", "STATE");
    TEST_ASSERT_TRUE(said("no plant is connected"));
}

static void operators_run_sequences_and_engineers_skip(void)
{
    ask_ok("key pot_still");
    samples(1);
    ask_ok("lock");
    ask_ok("seq start");
    samples(3);
    ask_refused("seq skip", "LOCKED");
    ask_ok("seq hold");
    samples(1);
    ask_ok("seq go");
    samples(1);
    ask_ok("seq list");
    ask_ok("unlock pot_still");
    board_forget();
    ask_ok("seq skip");
    samples(1);
    TEST_ASSERT_TRUE(said(" warning SEQUENCE_SKIPPED start 2 "));
    ask_ok("events");
    TEST_ASSERT_TRUE(said("DO_SEQUENCE skip 0 sequence started, stopped or commanded, by "
                          "engineer"));
    ask_ok("lock");
    ask_ok("seq abort");
}

static void rows_do_not_change_while_it_runs_but_settings_do(void)
{
    ask_ok("seq start");
    samples(3);
    ask_refused("set step2.limit 110", "STATE");
    TEST_ASSERT_TRUE(said("`seq abort` ends it"));
    ask_refused("defaults", "STATE");
    ask_ok("set loop2.gain 1.2");
    samples(2);
    ask_ok("seq");
    TEST_ASSERT_TRUE(said("start running at step 2"));
    ask_ok("seq abort");
    samples(1);
    ask_ok("set step2.limit 110");
}

static void an_offset_is_shown_where_its_reading_is(void)
{
    at_confirm();
    ask_ok("status");
    TEST_ASSERT_TRUE(said("feed = 3 l/h good, less its offset 2"));
}

static void telemetry_has_columns_for_what_is_configured(void)
{
    ask_ok("log on");
    TEST_ASSERT_TRUE(said("H,1,number,time[s],state,ev,seq,step,"));
    TEST_ASSERT_TRUE(said(",feed[l/h],feed.q,feed.off[l/h],"));
    TEST_ASSERT_FALSE(said("T10.off"));
    board_forget();
    at_confirm();
    ask_ok("status"); /* what comes now is the last row */
    samples(1);
    const char *row = strstr(board.said, "T,1,");
    TEST_ASSERT_NOT_NULL(row);
    unsigned field = 0;
    const char *at[16] = {0};
    for (const char *c = row; *c && field < 16; c++)
        if (*c == ',')
            at[field++] = c + 1;
    TEST_ASSERT_EQUAL(3, atoi(at[5])); /* seq: waits for confirmation */
    TEST_ASSERT_EQUAL(4, atoi(at[6]));
    TEST_ASSERT_EQUAL(3, atoi(at[11])); /* feed */
    TEST_ASSERT_EQUAL(2, atoi(at[13])); /* feed.off */
}

static void a_plant_that_falls_silent_ends_it(void)
{
    ask_ok("seq start");
    samples(3);
    board_forget();
    board.mute = true;
    pass(3000);
    TEST_ASSERT_TRUE(said(" alarm SEQUENCE_ABORTED link 2 "));
    TEST_ASSERT_TRUE(said("start, safe state taken"));
}

/* ---- resets ---- */

static void reset(enum hal_reset reason)
{
    memory_port_reset(reason);
    board.ready = false;
    board_run();
    type("mode machine\n");
    pass(1000);
    TEST_ASSERT_TRUE(board.ready);
}

static void after_a_reset_it_is_aborted_whatever_the_policy(void)
{
    static const char *const policies[] = {"safe", "hold", "resume"};
    for (unsigned k = 0; k < 3; k++) {
        char line[60];
        memory_port_erase_all();
        setUp();
        snprintf(line, sizeof line, "set restart.policy %s", policies[k]);
        ask_ok(line);
        samples(1);
        ask_ok("save");
        pass(500);
        ask_ok("seq start");
        samples(5);
        TEST_ASSERT_EQUAL_FLOAT(0.9f, board.command.output[1].value);
        board_forget();
        reset(HAL_RESET_WATCHDOG);
        samples(1);
        pass(500);
        samples(10);
        TEST_ASSERT_TRUE(said(" alarm SEQUENCE_ABORTED - 2 "));
        TEST_ASSERT_TRUE(said("start, board was reset"));
        TEST_ASSERT_EQUAL(k != 0, said("RESTART_REFUSED sequence"));
        TEST_ASSERT_TRUE(board.command.safe);
        ask_ok("seq");
        TEST_ASSERT_EQUAL_STRING("start aborted at step 2: board was reset", reply[0]);
        ask_ok("seq start");
        samples(2);
        ask_ok("seq");
        TEST_ASSERT_TRUE(said("start running at step 2"));
    }
    memory_port_erase_all();
}

static void also_when_it_had_not_moved_anything_yet(void)
{
    static const char *const lines[] = {"begin", "set step2.do nothing", "apply"};
    for (unsigned i = 0; i < 3; i++)
        ask_ok(lines[i]);
    samples(2);
    ask_ok("seq start");
    samples(3);
    TEST_ASSERT_TRUE(board.command.safe);
    board_forget();
    reset(HAL_RESET_WATCHDOG);
    samples(3);
    TEST_ASSERT_TRUE(said(" alarm SEQUENCE_ABORTED - 2 "));
}

static void an_offset_comes_back_with_the_outputs_or_says_that_it_is_off(void)
{
    static const char *const policies[] = {"safe", "hold", "resume"};
    for (unsigned k = 0; k < 3; k++) {
        char line[60];
        memory_port_erase_all();
        setUp();
        snprintf(line, sizeof line, "set restart.policy %s", policies[k]);
        ask_ok(line);
        samples(1);
        ask_ok("save");
        pass(500);
        at_confirm();
        ask_ok("seq confirm");
        samples(2);
        board_forget();
        reset(HAL_RESET_WATCHDOG);
        samples(1);
        pass(500);
        samples(3);
        TEST_ASSERT_EQUAL(k == 0, said("info OFFSET feed 0 "));
        TEST_ASSERT_EQUAL(k != 0, said("info OFFSET feed 2 "));
        ask_ok("status");
        TEST_ASSERT_TRUE(
            said(k == 0 ? "feed = 5 l/h good\n" : "feed = 3 l/h good, less its offset 2"));
    }
    memory_port_erase_all();
}

static void after_a_loss_of_power_it_is_idle_and_safe(void)
{
    ask_ok("seq start");
    samples(5);
    running();
    rows();
    ask_ok("seq");
    TEST_ASSERT_EQUAL_STRING("idle", reply[0]);
    samples(1);
    TEST_ASSERT_TRUE(board.command.safe);
    ask_ok("status");
    TEST_ASSERT_FALSE(said("less its offset"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(seq_shows_where_it_is_and_how_far);
    RUN_TEST(its_rows_are_listed_in_words);
    RUN_TEST(from_start_to_done_everything_is_told);
    RUN_TEST(an_abort_says_why_and_where);
    RUN_TEST(what_is_not_possible_is_refused_in_one_line);
    RUN_TEST(without_rows_or_a_plant_nothing_starts);
    RUN_TEST(operators_run_sequences_and_engineers_skip);
    RUN_TEST(rows_do_not_change_while_it_runs_but_settings_do);
    RUN_TEST(an_offset_is_shown_where_its_reading_is);
    RUN_TEST(telemetry_has_columns_for_what_is_configured);
    RUN_TEST(a_plant_that_falls_silent_ends_it);
    RUN_TEST(after_a_reset_it_is_aborted_whatever_the_policy);
    RUN_TEST(also_when_it_had_not_moved_anything_yet);
    RUN_TEST(an_offset_comes_back_with_the_outputs_or_says_that_it_is_off);
    RUN_TEST(after_a_loss_of_power_it_is_idle_and_safe);
    return UNITY_END();
}
