/* The two levels of the console, and the key between them. */
#include "board_bench.h"

static const char *const engineer[] = {"set loop1.gain 2", "begin",     "apply",
                                       "abandon",          "key other", "reboot"};
static const char *const operator[] = {"help",
                                       "version",
                                       "status",
                                       "loop",
                                       "out bottom 1",
                                       "mode bottom auto",
                                       "sp bottom 110",
                                       "list all",
                                       "get loop1.gain",
                                       "diff defaults",
                                       "alarm",
                                       "events",
                                       "stats",
                                       "log on",
                                       "log off",
                                       "mode machine",
                                       "tune bottom simc 100 20 600"};

void setUp(void)
{
    running();
}
void tearDown(void) {}

static void set_key_and_lock(void)
{
    ask_ok("key pot_still");
    samples(1);
    ask_ok("lock");
}

static void without_a_key_everything_is_open_and_said_to_be(void)
{
    ask_ok("version");
    TEST_ASSERT_TRUE(said("engineer level open: no key is set"));
    ask_ok("set loop1.gain 2");
    ask_refused("lock", "STATE");
}

static void operators_look_and_operate_while_the_rest_is_locked(void)
{
    set_key_and_lock();
    for (unsigned i = 0; i < sizeof operator/ sizeof operator[0]; i++) {
        ask_ok(operator[i]);
        samples(1);
    }
    for (unsigned i = 0; i < sizeof engineer / sizeof engineer[0]; i++) {
        ask_refused(engineer[i], "LOCKED");
        TEST_ASSERT_TRUE(said("`unlock KEY`"));
        TEST_ASSERT_EQUAL(1, n_reply);
    }
    ask_ok("get loop1.gain");
    TEST_ASSERT_TRUE(said("= 1 "));
    TEST_ASSERT_EQUAL(0, memory_port_reboots());
    ask_ok("version");
    TEST_ASSERT_TRUE(said("engineer level locked"));
    ask_ok("status");
    TEST_ASSERT_TRUE(said("console locked"));
}

static void the_key_opens_and_a_wrong_one_does_not(void)
{
    set_key_and_lock();
    ask_refused("unlock pot_stil", "LOCKED");
    ask_refused("unlock pot_still", "BUSY"); /* too soon after a wrong one */
    pass(2000);
    ask_ok("unlock pot_still");
    ask_ok("set loop1.gain 2");
    ask_ok("lock");
    ask_refused("set loop1.gain 3", "LOCKED");
}

static void after_each_wrong_key_in_a_row_the_wait_doubles_up_to_a_minute(void)
{
    static const unsigned waits_s[] = {2, 4, 8, 16, 32, 60, 60};
    char told[48];
    set_key_and_lock();
    for (unsigned i = 0; i < sizeof waits_s / sizeof waits_s[0]; i++) {
        ask_refused("unlock wrong", "LOCKED");
        snprintf(told, sizeof told, "wrong key: wait %u s before the next try", waits_s[i]);
        TEST_ASSERT_TRUE_MESSAGE(said(told), told);
        pass(1000u * waits_s[i] - 50);
        ask_refused("unlock pot_still", "BUSY"); /* and makes the wait no longer */
        TEST_ASSERT_TRUE(said("wait 1 s before"));
        pass(50);
    }
    ask_ok("unlock pot_still");
    ask_ok("lock");
    ask_refused("unlock wrong", "LOCKED");
    TEST_ASSERT_TRUE(said("wait 2 s")); /* from the beginning again */
}

/* Else a reset button would be a way around the wait. */
static void the_wait_after_wrong_keys_survives_a_reset(void)
{
    set_key_and_lock();
    for (unsigned wait_s = 2; wait_s <= 8; wait_s *= 2) {
        ask_refused("unlock wrong", "LOCKED");
        pass(1000u * wait_s);
    }
    memory_port_reset(HAL_RESET_PIN);
    board.ready = false;
    board_run();
    type("mode machine\n");
    set_key_and_lock(); /* nothing is stored here */
    ask_refused("unlock pot_still", "BUSY");
    pass(8000);
    ask_refused("unlock wrong", "LOCKED");
    TEST_ASSERT_TRUE(said("wait 16 s")); /* and goes on doubling */
}

/* Whoever wants to hide what was done must not be able to by typing keys. */
static void a_hundred_wrong_keys_push_nothing_out_of_the_history(void)
{
    ask_ok("set loop1.gain 2.5");
    set_key_and_lock();
    for (unsigned i = 0; i < 100; i++) {
        ask_refused("unlock wrong", "LOCKED");
        pass(60000);
    }
    ask_ok("events");
    TEST_ASSERT_TRUE(said("DO_SET loop1.gain 2.5 "));
    TEST_ASSERT_EQUAL(1, times_said("WRONG_KEY"));
    TEST_ASSERT_TRUE(said("WRONG_KEY - 100 "));
    ask_ok("unlock pot_still");
    ask_ok("lock");
    ask_refused("unlock wrong", "LOCKED");
    ask_ok("events"); /* those before and after somebody who knew the key are told apart */
    TEST_ASSERT_TRUE(said("WRONG_KEY - 100 "));
    TEST_ASSERT_TRUE(said("WRONG_KEY - 1 "));
}

static void status_says_that_no_key_is_set(void)
{
    ask_ok("status");
    TEST_ASSERT_TRUE(said("engineer level open: no key is set"));
    set_key_and_lock();
    ask_ok("status");
    TEST_ASSERT_FALSE(said("no key is set"));
}

static void whoever_sets_a_key_is_not_locked_out_by_it(void)
{
    ask_ok("key pot_still");
    ask_ok("set loop1.gain 2");
    ask_ok("key -");
    samples(1);
    ask_ok("version");
    TEST_ASSERT_TRUE(said("no key is set"));
}

static void a_key_is_never_shown(void)
{
    set_key_and_lock();
    static const char *const looks[] = {"list all",      "list console", "get console.key",
                                        "diff defaults", "events",       "help console.key"};
    for (unsigned i = 0; i < sizeof looks / sizeof looks[0]; i++) {
        ask_ok(looks[i]);
        TEST_ASSERT_FALSE_MESSAGE(said("pot_still"), looks[i]);
    }
    ask_ok("get console.key");
    TEST_ASSERT_TRUE(said("console.key = ***"));
}

static void a_key_that_is_refused_is_not_repeated(void)
{
    ask_refused("key p0t!still", "PARSE");
    TEST_ASSERT_FALSE(said("p0t"));
    ask_refused("set console.key p0t!still", "PARSE");
    TEST_ASSERT_FALSE(said("p0t"));
}

/* Whatever the line goes through on its way, a terminal's log among it. */
static void a_key_is_echoed_as_stars(void)
{
    static const char *const lines[] = {"unlock pot_still", " key pot_still",
                                        "set console.key pot_still"};
    type("mode human\r");
    for (unsigned i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        board_forget();
        type(lines[i]);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(board.said, " *********"), board.said);
        type("\x01\x05\033[D\033[D\b\033[3~x"); /* there and back, and edited */
        TEST_ASSERT_NULL_MESSAGE(strstr(board.said, "pot"), board.said);
        TEST_ASSERT_NULL_MESSAGE(strstr(board.said, "still"), board.said);
        type("\x15");
    }
    type("get loop1.gain\x01key \x05");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(board.said, " **************"), board.said);
}

static void what_diff_prints_can_be_pasted_and_leaves_the_key_as_it_is(void)
{
    ask_ok("key pot_still");
    ask_ok("set console.key ***");
    samples(1);
    ask_ok("lock");
    ask_ok("unlock pot_still");
}

static void keys_are_not_kept_in_the_history_of_lines(void)
{
    type("\x11mode human\r");
    type("get loop1.ti\rkey pot_still\rset console.key pot_still\r unlock pot_still\r");
    board_forget();
    type("\033[A");
    TEST_ASSERT_TRUE(said("get loop1.ti"));
    TEST_ASSERT_FALSE(said("pot_still"));
}

static void the_engineer_level_locks_itself_when_nobody_uses_it(void)
{
    ask_ok("set console.relock 60");
    ask_ok("key pot_still");
    samples(1);
    pass(50000);
    ask_ok("get loop1.ti"); /* of the operator level: does not count */
    ask_ok("begin");        /* counts */
    pass(50000);
    ask_ok("version");
    TEST_ASSERT_TRUE(said("locks in 10 s"));
    ask_ok("set loop1.gain 2");
    pass(59000);
    ask_ok("apply");
    samples(1);
    pass(61000);
    ask_refused("set loop1.gain 3", "LOCKED");
    ask_ok("events");
    TEST_ASSERT_TRUE(said("DO_LOCK time"));
}

/* Also where it is refused, with nothing to be told: an engineer has acted. */
static void telling_automatic_start_up_something_counts_as_use(void)
{
    ask_ok("set console.relock 60");
    ask_ok("key pot_still");
    samples(1);
    pass(50000);
    ask_ok("commission"); /* of the operator level: does not count */
    ask_refused("commission accept", "STATE");
    pass(50000);
    ask_ok("version");
    TEST_ASSERT_TRUE(said("locks in 10 s"));
    pass(11000);
    ask_refused("commission accept", "LOCKED");
}

static void with_relock_zero_it_stays_open(void)
{
    ask_ok("set console.relock 0");
    ask_ok("key pot_still");
    samples(1);
    pass(100000);
    ask_ok("set loop1.gain 2");
}

static void a_transaction_outlives_the_lock_but_is_not_applied_without_the_key(void)
{
    ask_ok("key pot_still");
    samples(1);
    ask_ok("begin");
    ask_ok("set loop1.gain 2");
    ask_ok("lock");
    ask_refused("apply", "LOCKED");
    ask_ok("unlock pot_still");
    ask_ok("apply");
    samples(1);
    ask_ok("get loop1.gain");
    TEST_ASSERT_TRUE(said("= 2 "));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_a_key_everything_is_open_and_said_to_be);
    RUN_TEST(operators_look_and_operate_while_the_rest_is_locked);
    RUN_TEST(the_key_opens_and_a_wrong_one_does_not);
    RUN_TEST(after_each_wrong_key_in_a_row_the_wait_doubles_up_to_a_minute);
    RUN_TEST(the_wait_after_wrong_keys_survives_a_reset);
    RUN_TEST(a_hundred_wrong_keys_push_nothing_out_of_the_history);
    RUN_TEST(status_says_that_no_key_is_set);
    RUN_TEST(whoever_sets_a_key_is_not_locked_out_by_it);
    RUN_TEST(a_key_is_never_shown);
    RUN_TEST(a_key_that_is_refused_is_not_repeated);
    RUN_TEST(a_key_is_echoed_as_stars);
    RUN_TEST(what_diff_prints_can_be_pasted_and_leaves_the_key_as_it_is);
    RUN_TEST(keys_are_not_kept_in_the_history_of_lines);
    RUN_TEST(the_engineer_level_locks_itself_when_nobody_uses_it);
    RUN_TEST(telling_automatic_start_up_something_counts_as_use);
    RUN_TEST(with_relock_zero_it_stays_open);
    RUN_TEST(a_transaction_outlives_the_lock_but_is_not_applied_without_the_key);
    return UNITY_END();
}
