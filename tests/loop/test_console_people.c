/* The console with a person at it: completion by what the board knows, output held by XOFF, and the history of events
 * and actions over a reset. */
#include "board_bench.h"

void setUp(void)
{
    running();
}
void tearDown(void) {}

/* Types keys into an empty line in human mode; returns what stands on the screen from the last prompt on. */
static const char *keys(const char *text)
{
    type("mode human\r");
    board_forget();
    type(text);
    const char *at = board.said, *next;
    while ((next = strstr(at, "\n> ")) != NULL)
        at = next + 3;
    return at;
}

static void completes(const char *text, const char *wanted)
{
    TEST_ASSERT_EQUAL_STRING(wanted, keys(text));
    type("\x15mode machine\n");
    board_forget();
}

static void offers(const char *text, const char *wanted)
{
    (void)keys(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(board.said, wanted), board.said);
    type("\x15mode machine\n");
    board_forget();
}

/* ---- completion ---- */

static void commands_complete(void)
{
    completes("aba\t", "abandon ");
    completes("help unl\t", "help unlock ");
    offers("st\t\t", "status  stats  ");
}

static void parameters_complete_by_their_parts(void)
{
    completes("get loop2\t", "get loop2.");
    completes("get loop2.inh\t", "get loop2.inhibit ");
    completes("set dec\t8\t", "set decouple8.");
    completes("list tick\t", "list tick.");
    completes("set bott\t", "set bottom.");
    completes("get bottom.inh\t", "get bottom.inhibit ");
    offers("get T10.test_l\t\t", "T10.test_limit");
    offers("set loop1.sp_\t\t", "loop1.sp_lo  loop1.sp_hi  loop1.sp_ramp  loop1.sp_filter  ");
}

static void values_complete_where_they_are_words_or_names(void)
{
    completes("set loop1.action d\t", "set loop1.action direct ");
    completes("set loop1.pv T1\t0", "set loop1.pv T10");
    offers("set loop1.pv T1\t", "T1  T10  ");
    completes("set loop1.gain 1\t", "set loop1.gain 1");
    completes("set console.key \t", "set console.key ");
}

static void loops_channels_and_mode_words_complete(void)
{
    completes("sp bo\t", "sp bottom ");
    completes("out h\t", "out heat ");
    completes("mode top c\t", "mode top cascade ");
    completes("mode ma\t", "mode machine ");
    completes("loop t\t", "loop top ");
    completes("log o\tn", "log on");
    offers("mode top \t", "manual  auto  cascade  ");
}

static void nothing_is_offered_where_nothing_is_known(void)
{
    completes("frob x\t", "frob x");
    completes("sp top 8\t", "sp top 8");
    completes("version \t", "version ");
}

static void a_past_line_comes_back_below_an_event(void)
{
    completes("get loop1.ti\r\033[A", "get loop1.ti");
}

/* ---- telemetry ---- */

static void log_on_answers_like_any_other_command(void)
{
    const char *screen = keys("log on\r");
    TEST_ASSERT_EQUAL_STRING("", screen); /* the prompt is the last thing there */
    TEST_ASSERT_FALSE_MESSAGE(said("> ok"), board.said);
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("\nok\r\n> "), board.said);
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("> "), board.said);
    type("log off\rmode machine\n");
    board_forget();
}

static void what_is_being_typed_stands_below_every_row(void)
{
    type("mode human\rlog on\r");
    samples(1);
    board_forget();
    type("get loop1.");
    samples(1);
    const char *row = strstr(board.said, "\r\033[KT,");
    TEST_ASSERT_NOT_NULL_MESSAGE(row, board.said);
    const char *end = strstr(row, "\r\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(end, board.said);
    TEST_ASSERT_EQUAL_STRING("\r\n> get loop1.", end);
    type("\x15log off\rmode machine\n");
    board_forget();
}

/* ---- XON, XOFF ---- */

static void after_xoff_nothing_is_said_until_xon_and_then_all_of_it(void)
{
    board_forget();
    type("\x13get loop1.ti\nget loop1.gain\n");
    TEST_ASSERT_EQUAL_STRING("", board.said);
    type("\x11");
    TEST_ASSERT_EQUAL_STRING("loop1.ti = 200 s\nok\nloop1.gain = 1 fraction/fraction\nok\n",
                             board.said);
}

static void control_c_frees_a_console_whose_xon_was_lost(void)
{
    board_forget();
    type("\x13get loop1.ti\n");
    TEST_ASSERT_EQUAL_STRING("", board.said);
    type("\x03");
    TEST_ASSERT_TRUE(said("loop1.ti = 200 s\nok\n"));
}

static void telemetry_waits_while_held_and_counts_what_finds_no_room(void)
{
    memory_port_set_console_rings(1024, 4096);
    running();
    ask_ok("log on");
    board_forget();
    type("\x13");
    samples(200);
    TEST_ASSERT_EQUAL_STRING("", board.said);
    type("\x11");
    TEST_ASSERT_EQUAL('\n', board.said[board.n_said - 1]);
    TEST_ASSERT_TRUE(said("TELEMETRY_LOST"));
    unsigned rows = times_said("\nT,") + (strncmp(board.said, "T,", 2) == 0);
    ask_ok("stats");
    const char *at = strstr(board.said, "telemetry_lost ");
    TEST_ASSERT_NOT_NULL(at);
    TEST_ASSERT_EQUAL(200, rows + strtoul(at + 15, NULL, 10));
    memory_port_set_console_rings(16384, 16384);
}

static void events_are_kept_while_held(void)
{
    type("\x13");
    type("out top 3\n");
    samples(1);
    TEST_ASSERT_FALSE(said("OUTPUT"));
    type("\x11");
    TEST_ASSERT_EQUAL(1, times_said("info OUTPUT top 3"));
    ask_ok("events");
    TEST_ASSERT_EQUAL(1, times_said("info OUTPUT top 3"));
}

/* ---- the history of events and actions ---- */

static void what_is_done_at_the_console_is_kept_with_who_did_it(void)
{
    ask_ok("key pot_still");
    ask_ok("lock");
    ask_ok("mode bottom auto");
    ask_ok("sp bottom 112.5");
    ask_ok("out top 2");
    ask_refused("set loop1.gain 2", "LOCKED");
    ask_ok("unlock pot_still");
    ask_ok("set loop1.gain 2");
    ask_ok("begin");
    ask_ok("set loop1.ti 100");
    ask_ok("set loop2.ti 100");
    ask_ok("set loop2.td 10");
    ask_ok("apply");
    board_forget();
    samples(1);
    TEST_ASSERT_FALSE(said("DO_")); /* kept, not announced */
    ask_ok("events");
    static const char *const wanted[] = {
        "5.000 action DO_KEY - 0 key changed, by engineer",
        "5.000 action DO_LOCK - 0 ",
        "5.000 action DO_MODE bottom 1 mode requested: auto, by operator",
        "5.000 action DO_SETPOINT bottom 112.5 setpoint requested, by operator",
        "5.000 action DO_OUTPUT top 2 ",
        "5.000 action DO_UNLOCK - 0 ",
        "5.000 action DO_SET loop1.gain 2 parameter set; 0 for a word, by engineer",
        "5.000 action DO_APPLY - 3 "};
    const char *at = board.said;
    for (unsigned i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        at = strstr(at, wanted[i]);
        TEST_ASSERT_NOT_NULL_MESSAGE(at, wanted[i]);
    }
    TEST_ASSERT_EQUAL(1, times_said("DO_SET ")); /* those of the transaction are its apply */
    TEST_ASSERT_EQUAL(1, times_said("DO_MODE "));
}

static void events_before_a_reset_are_shown_after_it_marked_by_their_boot(void)
{
    ask_ok("version");
    unsigned long boot = strtoul(strstr(board.said, "boot ") + 5, NULL, 10);
    ask_ok("out top 2.5");
    samples(1);
    type("reboot\n");
    type("mode machine\n");
    ask_ok("events");
    char want[80];
    snprintf(want, sizeof want, "  boot %lu 6.000 info OUTPUT top 2.5", boot);
    TEST_ASSERT_TRUE_MESSAGE(said(want), board.said);
    snprintf(want, sizeof want, "  boot %lu 6.000 action DO_REBOOT", boot);
    TEST_ASSERT_TRUE_MESSAGE(said(want), board.said);
    TEST_ASSERT_TRUE(said("\n  0.000 info STARTED"));
    type("reboot\n");
    type("mode machine\n");
    ask_ok("events");
    TEST_ASSERT_TRUE(said("info OUTPUT top 2.5"));
    TEST_ASSERT_EQUAL(0, times_said("! "));
}

static void a_loss_of_power_forgets_them(void)
{
    ask_ok("out top 2.5");
    samples(1);
    power_on();
    ask_ok("events");
    TEST_ASSERT_FALSE(said("OUTPUT"));
    TEST_ASSERT_TRUE(said("STARTED"));
}

/* ---- numbers ---- */

static void people_read_four_digits_and_scripts_all(void)
{
    board.values[1] = 110.12346;
    samples(1);
    type("mode human\rstatus\r");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(board.said, "T10 = 110.1 degC good"), board.said);
    board_forget();
    type("loop bottom\r");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(board.said, "pv T10 = 110.1 degC"), board.said);
    type("mode machine\n");
    board_forget();
    ask_ok("status");
    TEST_ASSERT_TRUE(said("T10 = 110.12346 degC good"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(commands_complete);
    RUN_TEST(parameters_complete_by_their_parts);
    RUN_TEST(values_complete_where_they_are_words_or_names);
    RUN_TEST(loops_channels_and_mode_words_complete);
    RUN_TEST(nothing_is_offered_where_nothing_is_known);
    RUN_TEST(a_past_line_comes_back_below_an_event);
    RUN_TEST(log_on_answers_like_any_other_command);
    RUN_TEST(what_is_being_typed_stands_below_every_row);
    RUN_TEST(after_xoff_nothing_is_said_until_xon_and_then_all_of_it);
    RUN_TEST(control_c_frees_a_console_whose_xon_was_lost);
    RUN_TEST(telemetry_waits_while_held_and_counts_what_finds_no_room);
    RUN_TEST(events_are_kept_while_held);
    RUN_TEST(what_is_done_at_the_console_is_kept_with_who_did_it);
    RUN_TEST(events_before_a_reset_are_shown_after_it_marked_by_their_boot);
    RUN_TEST(a_loss_of_power_forgets_them);
    RUN_TEST(people_read_four_digits_and_scripts_all);
    return UNITY_END();
}
