/* The console, by script and by hand: grammar of replies, refusals, transactions, telemetry. */
#include "board_bench.h"

static char before[SAID_MAX];

void setUp(void)
{
    running();
}
void tearDown(void) {}

static void remember_settings(void)
{
    ask_ok("list all");
    memcpy(before, board.said, board.n_said + 1);
}

static void settings_are_as_remembered(void)
{
    ask_ok("list all");
    TEST_ASSERT_EQUAL_STRING(before, board.said);
}

/* ---- grammar ---- */

static void every_command_answers_with_exactly_one_ok_or_err(void)
{
    static const char *const arguments[] = {"",
                                            " x",
                                            " x y",
                                            " top",
                                            " bottom auto",
                                            " on",
                                            " off",
                                            " on 5",
                                            " all",
                                            " loop",
                                            " loop1.gain",
                                            " loop1.gain 2",
                                            " loop1.gain abc",
                                            " a b c",
                                            " a b c d e",
                                            " a b c d e f g h i",
                                            " a b c d e f g h i j k",
                                            " defaults",
                                            " top simc 1 20 100",
                                            " bottom 110",
                                            " -",
                                            " ,",
                                            " ! ok",
                                            " ok",
                                            " err X",
                                            "\t\t",
                                            "   "};
    static char names[64][16] = {"nonsense"};
    unsigned n_names = 1;
    ask_ok("help");
    for (unsigned i = 0; i + 1 < n_reply; i++) {
        TEST_ASSERT_EQUAL(1, sscanf(reply[i], "%15s", names[n_names]));
        if (strcmp(names[n_names], "reboot") != 0 && strcmp(names[n_names], "lock") != 0)
            n_names++;
    }
    TEST_ASSERT_TRUE(n_names > 20);
    for (unsigned i = 0; i < n_names; i++)
        for (unsigned k = 0; k < sizeof arguments / sizeof arguments[0]; k++) {
            char line[120];
            snprintf(line, sizeof line, "%.15s%.90s", names[i], arguments[k]);
            if (strcmp(line, "mode human") == 0)
                continue;
            const char *end = ask(line);
            if (strncmp(end, "err ", 4) != 0)
                continue;
            char code[32], rest[8];
            TEST_ASSERT_EQUAL_MESSAGE(2, sscanf(end, "err %31[A-Z_] %7s", code, rest), end);
            TEST_ASSERT_EQUAL_MESSAGE(1, n_reply, line); /* a refusal is one line */
        }
}

static void an_unknown_command_says_where_to_look(void)
{
    ask_refused("frobnicate", "UNKNOWN");
    TEST_ASSERT_TRUE(said("frobnicate"));
    TEST_ASSERT_TRUE(said("help"));
}

static void wrong_counts_of_arguments_are_told_the_usage(void)
{
    ask_refused("sp top", "PARSE");
    TEST_ASSERT_TRUE(said("usage: sp LOOP VALUE"));
    ask_refused("version now", "PARSE");
    ask_refused("set loop1.gain", "PARSE");
    ask_refused("set loop1.gain 1 2", "PARSE");
}

static void an_empty_line_is_no_command(void)
{
    board_forget();
    type("\n\r\n   \n");
    TEST_ASSERT_EQUAL(0, board.n_said);
}

static void every_end_of_line_is_taken_as_one(void)
{
    board_forget();
    type("get loop1.gain\r\nget loop1.gain\nget loop1.gain\r");
    cut_reply();
    TEST_ASSERT_EQUAL(3, n_replies);
}

static void help_knows_every_command_and_parameter_by_name(void)
{
    ask_ok("help sp");
    TEST_ASSERT_TRUE(said("sp LOOP VALUE"));
    ask_ok("help loop1.gain");
    TEST_ASSERT_TRUE(said("allowed: 1e-06 .. 100"));
    TEST_ASSERT_TRUE(said("default: 1"));
    ask_refused("help me", "UNKNOWN");
}

/* ---- line editing ---- */

static void people_get_an_echo_and_a_prompt(void)
{
    type("mode human\n");
    board_forget();
    type("get loop1.ti\r");
    TEST_ASSERT_EQUAL_STRING("get loop1.ti\r\nloop1.ti = 200 s\r\nok\r\n> ", board.said);
}

static void backspace_rubs_out_what_was_typed(void)
{
    type("mode human\n");
    board_forget();
    type("gxt\b\bet loop1.ti\r");
    TEST_ASSERT_EQUAL_STRING("gxt\b \b\b \bet loop1.ti\r\nloop1.ti = 200 s\r\nok\r\n> ",
                             board.said);
    board_forget();
    type("\b\b\x7f");
    TEST_ASSERT_EQUAL_STRING("", board.said); /* nothing to rub out */
}

static void control_u_starts_the_line_again(void)
{
    board_forget();
    type("set loop1.gain 9\x15get loop1.gain\n");
    TEST_ASSERT_TRUE(said("loop1.gain = 1 "));
}

static void machine_mode_echoes_nothing(void)
{
    board_forget();
    type("get loop1.ti\n");
    TEST_ASSERT_EQUAL_STRING("loop1.ti = 200 s\nok\n", board.said);
}

static void a_line_too_long_is_refused_whole(void)
{
    char line[400];
    memset(line, 'x', sizeof line);
    memcpy(line, "set loop1.gain 5", 16);
    line[16] = ' ';
    line[399] = '\0';
    remember_settings();
    ask_refused(line, "FULL");
    settings_are_as_remembered();
}

static void a_line_of_exactly_200_characters_is_taken(void)
{
    char line[201];
    memset(line, ' ', 200);
    line[200] = '\0';
    memcpy(line, "get loop1.ti", 12);
    ask_ok(line);
}

static void a_line_with_characters_from_elsewhere_is_refused_whole(void)
{
    remember_settings();
    ask_refused("set loop1.gain 5\x01", "PARSE");
    ask_refused("set loop1.gain 5\xC3\xA4", "PARSE");
    ask_refused("\x1b[Aset loop1.gain 5", "PARSE");
    settings_are_as_remembered();
}

/* ---- parameters ---- */

static void a_set_outside_a_transaction_takes_effect_with_the_next_tick(void)
{
    ask_ok("set loop1.gain 3.5");
    ask_ok("get loop1.gain");
    TEST_ASSERT_TRUE(said("loop1.gain = 3.5"));
    board_forget();
    samples(1);
    TEST_ASSERT_TRUE(said("CONFIG_APPLIED"));
}

static void a_refused_set_changes_nothing_and_says_what_is_allowed(void)
{
    static const char *const bad[][2] = {
        {"set loop1.gain 101", "RANGE"},      {"set loop1.gain abc", "PARSE"},
        {"set loop1.gain nan", "PARSE"},      {"set loop1.gain 1e99", "RANGE"},
        {"set loop1.action up", "PARSE"},     {"set loop1.name a-b", "PARSE"},
        {"set config.schema 2", "READ_ONLY"}, {"set loop1.pv nothing", "UNKNOWN"},
        {"set loop2.out reflux", "CONFLICT"}, {"set loop1.phase 1", "RANGE"},
        {"set mv1.lo 20", "RANGE"},           {"set loop17.gain 1", "UNKNOWN"},
        {"set loop1.ti 0.001", "RANGE"},      {"set loop1.divisor 0", "RANGE"}};
    remember_settings();
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        ask_refused(bad[i][0], bad[i][1]);
        if (i < 6)
            TEST_ASSERT_TRUE_MESSAGE(said("allowed: "), bad[i][0]);
    }
    samples(2);
    settings_are_as_remembered();
}

static void a_transaction_is_all_or_nothing(void)
{
    remember_settings();
    ask_ok("begin");
    ask_ok("set loop1.gain 7");
    ask_ok("set loop1.pv nothing"); /* only judged as a whole */
    ask_refused("apply", "UNKNOWN");
    TEST_ASSERT_TRUE(said("loop1.pv"));
    samples(1);
    ask_ok("diff");
    TEST_ASSERT_EQUAL(3, n_reply);
    TEST_ASSERT_EQUAL_STRING("set loop1.pv nothing", reply[0]);
    TEST_ASSERT_EQUAL_STRING("set loop1.gain 7", reply[1]);
    ask_ok("abandon");
    settings_are_as_remembered();
}

static void lines_of_a_transaction_set_the_same_when_they_are_pasted(void)
{
    ask_ok("begin");
    ask_ok("set mv5.hi 200");
    ask_ok("set mv5.max 100");
    ask_ok("diff");
    TEST_ASSERT_TRUE(said("set mv5.hi 200"));
    TEST_ASSERT_TRUE(said("set mv5.max 100"));
    ask_ok("abandon");
}

static void transactions_do_not_nest_or_close_twice(void)
{
    ask_refused("apply", "STATE");
    ask_refused("abandon", "STATE");
    ask_ok("begin");
    ask_refused("begin", "STATE");
    ask_ok("apply");
    ask_refused("apply", "STATE");
}

static void diff_defaults_can_be_pasted_back_and_restores_the_settings(void)
{
    static char lines[20000];
    ask_ok("set meas1.filter 2.5");
    ask_ok("set mv5.hi 40");
    ask_ok("set mv6.hi 200"); /* whose max moves along, and then gets the value that it had */
    ask_ok("set mv6.max 100");
    ask_ok("diff defaults");
    TEST_ASSERT_TRUE(said("set mv6.max 100"));
    TEST_ASSERT_FALSE(said("mv5.max"));
    ask_ok("dump");
    TEST_ASSERT_TRUE(said("set mv6.max 100"));
    ask_ok("diff defaults");
    lines[0] = '\0';
    for (unsigned i = 0; i + 1 < n_reply; i++) {
        strcat(lines, reply[i]);
        strcat(lines, "\n");
    }
    remember_settings();
    power_on();
    ask_ok("begin");
    type(lines);
    ask_ok("apply");
    settings_are_as_remembered();
}

static void three_hundred_lines_pasted_at_once_are_all_answered(void)
{
    static char paste[20000];
    char line[60];
    strcpy(paste, "begin\n");
    for (unsigned n = 0; n < 298; n++) {
        snprintf(line, sizeof line, "set loop%u.ti %u\n", n % 8 + 1, n + 10);
        strcat(paste, line);
    }
    strcat(paste, "apply\n");
    board_forget();
    size_t size = strlen(paste);
    TEST_ASSERT_EQUAL(size, memory_port_give(HAL_UART_CONSOLE, paste, size));
    board_run();
    cut_reply();
    TEST_ASSERT_EQUAL(300, n_replies);
    TEST_ASSERT_EQUAL(300, n_reply);
    ask_ok("get loop2.ti");
    TEST_ASSERT_TRUE(said("loop2.ti = 307 s")); /* the last one wins */
}

static void a_full_queue_of_requests_says_busy_and_loses_nothing(void)
{
    ask_ok("mode bottom auto");
    unsigned taken = 0;
    char line[40], last[40] = "";
    for (unsigned n = 0; n < 60; n++) {
        snprintf(line, sizeof line, "sp bottom %u", 100 + n % 40);
        const char *end = ask(line);
        if (strcmp(end, "ok") == 0) {
            taken++;
            snprintf(last, sizeof last, "%u", 100 + n % 40);
        } else {
            TEST_ASSERT_EQUAL_STRING_LEN("err BUSY ", end, 9);
        }
    }
    TEST_ASSERT_EQUAL(31, taken);
    ask_refused("set loop1.gain 2", "BUSY");
    samples(1);
    ask_ok("loop bottom");
    char want[60];
    snprintf(want, sizeof want, "sp %s degC", last);
    TEST_ASSERT_TRUE_MESSAGE(said(want), board.said);
    ask_ok("set loop1.gain 2");
}

/* The second change needs the buffer in which the first one waits for its sample. */
static void what_was_asked_before_a_change_is_done_before_the_next_one_is_edited(void)
{
    board_forget();
    ask_ok("mode bottom auto");
    ask_ok("sp bottom 117");
    ask_ok("set loop1.name sump");
    ask_ok("mode sump manual");
    ask_ok("out sump 4");
    ask_ok("set loop1.name foot");
    ask_ok("begin");
    ask_ok("set loop1.gain 7");
    TEST_ASSERT_EQUAL(0, times_said("CONFIG_APPLIED")); /* while all of that is edited */
    board_forget();
    samples(1);
    TEST_ASSERT_EQUAL(1, times_said("CONFIG_APPLIED"));
    ask_ok("loop foot");
    TEST_ASSERT_TRUE_MESSAGE(said("manual"), board.said);
    ask_ok("abandon");
    ask_ok("get loop1.gain");
    TEST_ASSERT_FALSE(said("= 7 "));
    ask_ok("events");
    TEST_ASSERT_TRUE_MESSAGE(said("SETPOINT bottom 117"), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said("OUTPUT sump 4"), board.said);
}

static void a_refused_change_leaves_the_one_before_it_in_force(void)
{
    ask_ok("set loop1.gain 3");
    ask_refused("set loop1.pv nothing", "UNKNOWN");
    ask_refused("set loop1.gain nan", "PARSE");
    samples(1);
    ask_ok("get loop1.gain");
    TEST_ASSERT_TRUE(said("loop1.gain = 3 "));
}

static void a_remark_is_answered_and_does_nothing(void)
{
    ask_ok("# a line of a pasted file");
}

static void a_line_that_lost_bytes_is_refused_whole(void)
{
    static char flood[40000];
    memset(flood, 'x', sizeof flood - 1);
    (void)memory_port_give(HAL_UART_CONSOLE, flood,
                           sizeof flood - 1); /* more than the ring holds */
    board_run();
    board_forget();
    type("\n");
    ask_ok("get loop2.ti");
    (void)memory_port_give(HAL_UART_CONSOLE, "set loop2.ti 1", 14);
    board_run();
    memory_port_damage(HAL_UART_CONSOLE); /* the "5" of 15 */
    board_forget();
    type("00\n");
    TEST_ASSERT_TRUE_MESSAGE(said("err IO"), board.said);
    ask_ok("get loop2.ti");
    TEST_ASSERT_TRUE_MESSAGE(said("= 300 s"), board.said);
}

static void many_settings_between_two_ticks_are_one_plan(void)
{
    char line[60];
    for (unsigned n = 1; n < 100; n++) {
        snprintf(line, sizeof line, "set loop1.ti %u", n);
        ask_ok(line);
    }
    board_forget();
    samples(1);
    TEST_ASSERT_EQUAL(1, times_said("CONFIG_APPLIED"));
    ask_ok("get loop1.ti");
    TEST_ASSERT_TRUE(said("= 99 s"));
}

static void a_plan_and_a_mode_in_it_can_be_asked_for_between_two_samples(void)
{
    ask_ok("begin");
    ask_ok("set meas3.name feed"); /* no sample has been seen through it */
    ask_ok("set meas3.unit l/h");
    ask_ok("set meas3.hi 10");
    ask_ok("set loop2.pv feed");
    ask_ok("apply");
    ask_ok("mode bottom auto");
    samples(1);
    ask_ok("loop bottom");
    TEST_ASSERT_TRUE_MESSAGE(said("bottom auto"), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said("sp 5 l/h"), board.said);
}

static void a_request_does_not_reach_a_loop_that_took_the_others_place(void)
{
    ask_ok("mode bottom auto");
    ask_ok("set loop2.name sump"); /* the same index, another loop */
    samples(1);
    ask_ok("loop sump");
    TEST_ASSERT_TRUE(said("sump manual"));
}

/* ---- operation ---- */

static void loops_are_operated_by_mode_sp_and_out(void)
{
    ask_ok("out bottom 1.25");
    samples(1);
    TEST_ASSERT_EQUAL_FLOAT(1.25f, board.command.output[1].value);
    ask_ok("mode bottom auto");
    ask_ok("sp bottom 120");
    samples(1);
    TEST_ASSERT_TRUE(board.command.output[1].value > 1.3f);
    ask_refused("out bottom 1", "STATE");
    ask_ok("mode bottom manual");
    ask_ok("out heat 0.75"); /* by the name of the variable */
    samples(1);
    TEST_ASSERT_EQUAL_FLOAT(0.75f, board.command.output[1].value);
}

static void numbers_for_a_loop_are_refused_outside_their_range(void)
{
    ask_ok("mode bottom auto");
    ask_refused("sp bottom 161", "RANGE");
    TEST_ASSERT_TRUE(said("60 .. 160 degC"));
    ask_refused("sp bottom warm", "PARSE");
    ask_refused("out top 11", "RANGE");
    ask_refused("sp top 90", "STATE"); /* manual, follows the measurement */
    ask_refused("mode bottom cascade", "CONFLICT");
    ask_refused("mode bottom fast", "PARSE");
    ask_refused("mode nobody auto", "UNKNOWN");
    ask_refused("out nobody 1", "UNKNOWN");
}

static void settings_from_a_model_come_as_lines_to_paste(void)
{
    ask_ok("tune bottom simc 100 20 600 40");
    TEST_ASSERT_EQUAL(5, n_reply);
    TEST_ASSERT_EQUAL_STRING_LEN("set loop2.gain ", reply[0], 15);
    for (unsigned i = 0; i < 4; i++) {
        char line[100];
        snprintf(line, sizeof line, "%s", reply[i]);
        ask_ok(line);
        ask_ok("tune bottom simc 100 20 600 40");
    }
    ask_refused("tune bottom magic 1 1 1", "PARSE");
    ask_refused("tune bottom simc 0 20 600", "RANGE");
    ask_refused("tune bottom simc 1 x 600", "PARSE");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_command_answers_with_exactly_one_ok_or_err);
    RUN_TEST(an_unknown_command_says_where_to_look);
    RUN_TEST(wrong_counts_of_arguments_are_told_the_usage);
    RUN_TEST(an_empty_line_is_no_command);
    RUN_TEST(every_end_of_line_is_taken_as_one);
    RUN_TEST(help_knows_every_command_and_parameter_by_name);
    RUN_TEST(people_get_an_echo_and_a_prompt);
    RUN_TEST(backspace_rubs_out_what_was_typed);
    RUN_TEST(control_u_starts_the_line_again);
    RUN_TEST(machine_mode_echoes_nothing);
    RUN_TEST(a_line_too_long_is_refused_whole);
    RUN_TEST(a_line_of_exactly_200_characters_is_taken);
    RUN_TEST(a_line_with_characters_from_elsewhere_is_refused_whole);
    RUN_TEST(a_set_outside_a_transaction_takes_effect_with_the_next_tick);
    RUN_TEST(a_refused_set_changes_nothing_and_says_what_is_allowed);
    RUN_TEST(a_transaction_is_all_or_nothing);
    RUN_TEST(transactions_do_not_nest_or_close_twice);
    RUN_TEST(lines_of_a_transaction_set_the_same_when_they_are_pasted);
    RUN_TEST(diff_defaults_can_be_pasted_back_and_restores_the_settings);
    RUN_TEST(three_hundred_lines_pasted_at_once_are_all_answered);
    RUN_TEST(a_full_queue_of_requests_says_busy_and_loses_nothing);
    RUN_TEST(what_was_asked_before_a_change_is_done_before_the_next_one_is_edited);
    RUN_TEST(a_refused_change_leaves_the_one_before_it_in_force);
    RUN_TEST(a_remark_is_answered_and_does_nothing);
    RUN_TEST(a_line_that_lost_bytes_is_refused_whole);
    RUN_TEST(many_settings_between_two_ticks_are_one_plan);
    RUN_TEST(a_plan_and_a_mode_in_it_can_be_asked_for_between_two_samples);
    RUN_TEST(a_request_does_not_reach_a_loop_that_took_the_others_place);
    RUN_TEST(loops_are_operated_by_mode_sp_and_out);
    RUN_TEST(numbers_for_a_loop_are_refused_outside_their_range);
    RUN_TEST(settings_from_a_model_come_as_lines_to_paste);
    return UNITY_END();
}
