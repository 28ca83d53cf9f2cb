/* Words as people type them: near misses, capital letters, other names of commands, and an empty board that says what to do next. */
#include "board_bench.h"

#include "console/spelling.h"

void setUp(void)
{
    running();
}
void tearDown(void) {}

static void suggests(const char *command, const char *word)
{
    char wanted[60];
    ask_refused(command, "UNKNOWN");
    snprintf(wanted, sizeof wanted, "; did you mean `%s`?", word);
    TEST_ASSERT_TRUE_MESSAGE(said(wanted), board.said);
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("did you mean"), board.said);
}

static void suggests_nothing(const char *command)
{
    ask_refused(command, "UNKNOWN");
    TEST_ASSERT_FALSE_MESSAGE(said("did you mean"), board.said);
}

/* ---- did you mean ---- */

static void a_letter_more_less_other_or_swapped_is_one_edit(void)
{
    TEST_ASSERT_EQUAL(0, spelling_edits("STATUS", "status"));
    TEST_ASSERT_EQUAL(1, spelling_edits("stattus", "status"));
    TEST_ASSERT_EQUAL(1, spelling_edits("sttus", "status"));
    TEST_ASSERT_EQUAL(1, spelling_edits("stazus", "status"));
    TEST_ASSERT_EQUAL(1, spelling_edits("sattus", "status"));
    TEST_ASSERT_EQUAL(2, spelling_edits("stazzs", "status"));
    TEST_ASSERT_EQUAL(1, spelling_edits("comm", "commission"));
    TEST_ASSERT_EQUAL(0, spelling_edits("", ""));
    TEST_ASSERT_GREATER_THAN(2, spelling_edits("c", "commission"));
    TEST_ASSERT_GREATER_THAN(2, spelling_edits("statusstatus", "status"));
    TEST_ASSERT_EQUAL(1, spelling_edits("sta", "st"));
}

static void a_mistyped_command_is_answered_with_the_nearest(void)
{
    suggests("stauts", "status");
    suggests("ststus", "status");
    suggests("evnts", "events");
    suggests("comm", "commission");
    suggests_nothing("stop"); /* two edits from loop, and another word */
    suggests_nothing("frobnicate");
    suggests_nothing("x");
    suggests_nothing("xyz");
}

static void a_mistyped_parameter_is_answered_with_the_nearest(void)
{
    suggests("set lop1.gain 2", "loop1.gain");
    suggests("get meas1.nmae", "meas1.name");
    suggests("help loop1.actoin", "loop1.action");
    suggests("set loop1.Gain 2", "loop1.gain");
    suggests("set bottom.gian 2", "bottom.gain");
    suggests("get T1.nmae", "T1.name");
    suggests("set bottom.Gain 2", "bottom.gain");
    suggests("set botom.gain 1", "bottom.gain");
    suggests("set Bottom.gain 1", "bottom.gain");
    suggests("get t10.name", "T10.name");
    suggests("help haet.max", "heat.max");
    suggests_nothing("set -.gain 1"); /* is the name of no loop */
    suggests_nothing("set xx.gain 1");
    suggests_nothing("set nobody.gain 1");
    suggests_nothing("get nothing");
    suggests_nothing("get far.away");
    suggests_nothing("set block1.kind gmw"); /* a value: its refusal has no subject */
    suggests_nothing("get loop99.gain");     /* another number is no slip */
}

static void a_mistyped_name_is_answered_with_one_that_fits_there(void)
{
    suggests("mode botom auto", "bottom");
    suggests("sp Bottom 110", "bottom");
    suggests("out heta 1", "heat");
    suggests("loop botom", "bottom");
    suggests_nothing("sp heta 1"); /* heat is no loop */
    suggests_nothing("mode nobody auto");
    suggests("set loop1.pv T11", "T1");
    ask_ok("set alarm1.on T10");
    suggests("alarm ack T10.hj", "T10.hi");
}

static void names_of_an_open_transaction_count(void)
{
    ask_ok("begin");
    ask_ok("set loop2.out haet");
    suggests("apply", "heat");
    ask_ok("abandon");
}

/* ---- capital letters and other names ---- */

static void commands_and_modes_may_have_capital_letters(void)
{
    ask_ok("Status");
    ask_ok("HELP SP");
    TEST_ASSERT_TRUE_MESSAGE(said("sp LOOP VALUE"), board.said);
    ask_ok("Mode bottom AUTO");
    samples(1);
    ask_ok("loop bottom");
    TEST_ASSERT_TRUE_MESSAGE(said("bottom auto"), board.said);
}

static void a_question_mark_is_help(void)
{
    ask_ok("?");
    TEST_ASSERT_TRUE(said("status "));
    ask_ok("? sp");
    TEST_ASSERT_TRUE(said("sp LOOP VALUE"));
}

static void exit_and_quit_say_how_to_leave_and_close_the_engineer_level(void)
{
    ask_ok("exit");
    TEST_ASSERT_TRUE_MESSAGE(said("Nothing to close.\n"), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said("picocom ^A ^X"), board.said);
    ask_ok("key pot_still");
    ask_ok("quit");
    TEST_ASSERT_TRUE_MESSAGE(said("Engineer level locked.\n"), board.said);
    ask_refused("set loop1.gain 2", "LOCKED");
    ask_ok("quit");
    TEST_ASSERT_TRUE_MESSAGE(said("Nothing to close.\n"), board.said);
    ask_ok("unlock pot_still");
    ask_ok("key -");
}

static void a_key_behind_capital_letters_is_a_secret_too(void)
{
    type("mode human\r");
    board_forget();
    type("Unlock pot_still");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(board.said, "Unlock *********"), board.said);
    type("\x15KEY pot_still");
    TEST_ASSERT_NULL_MESSAGE(strstr(board.said, "pot"), board.said);
    type("\x15mode machine\n");
}

static void control_l_shows_the_line_alone_on_a_clear_screen(void)
{
    type("mode human\r");
    type("get loop1.ti\033[D");
    board_forget();
    type("\x0c");
    TEST_ASSERT_EQUAL_STRING("\033[H\033[2J> get loop1.ti\b", board.said);
    board_forget();
    type("\x05\r");
    TEST_ASSERT_TRUE_MESSAGE(said("loop1.ti = 200 s"), board.said);
    type("mode machine\n");
    ask_refused("get\x0c loop1.ti", "PARSE");
}

/* ---- names in place of numbers ---- */

static void a_parameter_may_begin_with_the_name_of_its_loop_or_channel(void)
{
    ask_ok("set bottom.gain 2");
    ANSWERS("get loop2.gain", "loop2.gain = 2 fraction/fraction");
    ANSWERS("get bottom.gain", "loop2.gain = 2 fraction/fraction");
    ANSWERS("get T10.lo", "meas2.lo = 60 EU");
    ANSWERS("get heat.safe", "mv2.safe = 0.5 EU");
    ask_ok("help bottom.ti");
    TEST_ASSERT_TRUE_MESSAGE(said("loop2.ti = "), board.said);
    ask_refused("get bottom.lo", "UNKNOWN");
    ask_refused("get nobody.gain", "UNKNOWN");
    ask_refused("get .gain", "UNKNOWN");
    ask_refused("get bottom.", "UNKNOWN");
    ask_refused("set bottom.gain 1e9", "RANGE");
    TEST_ASSERT_TRUE_MESSAGE(said("loop2.gain: '1e9' refused"), board.said);
}

static void the_history_has_the_number(void)
{
    ask_ok("set bottom.gain 2");
    ask_ok("events");
    TEST_ASSERT_TRUE_MESSAGE(said("action DO_SET loop2.gain 2 "), board.said);
}

static void a_loop_wins_over_a_measurement_and_that_over_an_output(void)
{
    ask_ok("begin");
    ask_ok("set loop2.name T10");                                  /* also a measurement */
    ask_ok("set mv1.name T1");                                     /* also a measurement */
    ANSWERS("get T10.gain", "loop2.gain = 1.5 fraction/fraction"); /* not of the calibration */
    ANSWERS("get T10.hi", "meas2.hi = 160 EU");                    /* a loop has none */
    ANSWERS("get T1.hi", "meas1.hi = 160 EU");
    ANSWERS("get T1.rate", "mv1.rate = 0 EU/s"); /* a measurement has none */
    ask_ok("abandon");
}

static void a_group_and_its_number_win_over_a_name(void)
{
    ask_ok("begin");
    ask_ok("set loop2.name loop1");
    ask_ok("set loop1.gain 0.25");
    ask_ok("set loop2.gain 0.75");
    ANSWERS("get loop1.gain", "loop1.gain = 0.25 fraction/fraction");
    ask_ok("abandon");
}

/* ---- an empty board ---- */

static void status_of_an_empty_board_says_what_comes_next(void)
{
    power_on();
    type("mode human\r");
    board_forget();
    type("status\r");
    TEST_ASSERT_TRUE_MESSAGE(said("next: connect a plant"), board.said);
    type("mode machine\n");
    connect_plant();
    type("mode human\r");
    board_forget();
    type("status\r");
    TEST_ASSERT_TRUE_MESSAGE(said("next: paste a .conf file"), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said("begin, set meas1.name NAME"), board.said);
    type("mode machine\n");
    ask_ok("status");
    TEST_ASSERT_FALSE_MESSAGE(said("next:"), board.said);
}

static void status_of_a_configured_board_does_not(void)
{
    type("mode human\r");
    board_forget();
    type("status\r");
    TEST_ASSERT_FALSE_MESSAGE(said("next:"), board.said);
    type("mode machine\n");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_letter_more_less_other_or_swapped_is_one_edit);
    RUN_TEST(a_mistyped_command_is_answered_with_the_nearest);
    RUN_TEST(a_mistyped_parameter_is_answered_with_the_nearest);
    RUN_TEST(a_mistyped_name_is_answered_with_one_that_fits_there);
    RUN_TEST(names_of_an_open_transaction_count);
    RUN_TEST(commands_and_modes_may_have_capital_letters);
    RUN_TEST(a_question_mark_is_help);
    RUN_TEST(exit_and_quit_say_how_to_leave_and_close_the_engineer_level);
    RUN_TEST(a_key_behind_capital_letters_is_a_secret_too);
    RUN_TEST(control_l_shows_the_line_alone_on_a_clear_screen);
    RUN_TEST(a_parameter_may_begin_with_the_name_of_its_loop_or_channel);
    RUN_TEST(the_history_has_the_number);
    RUN_TEST(a_loop_wins_over_a_measurement_and_that_over_an_output);
    RUN_TEST(a_group_and_its_number_win_over_a_name);
    RUN_TEST(status_of_an_empty_board_says_what_comes_next);
    RUN_TEST(status_of_a_configured_board_does_not);
    return UNITY_END();
}
