/* View that an operator has of an analyser: T10 of the board in memory, whose plant has samples of 1 s. */
#include "board_bench.h"

void setUp(void)
{
    memory_port_erase_all();
    running(); /* plant time is 5 s */
    board.values[1] = 110;
}
void tearDown(void) {}

static void an_analyser(void)
{
    ask_ok("begin");
    ask_ok("set meas2.every 4");
    ask_ok("set meas2.phase 2");
    ask_ok("set meas2.delay 3");
    ask_ok("set loop2.divisor 4");
    ask_ok("apply");
    samples(1);
}

static const char *line_of(const char *begin)
{
    for (unsigned i = 0; i < n_reply; i++)
        if (strncmp(reply[i], begin, strlen(begin)) == 0)
            return reply[i];
    TEST_FAIL_MESSAGE(begin);
    return "";
}

static void status_says_when_it_was_sampled(void)
{
    an_analyser();
    ask_ok("status");
    TEST_ASSERT_EQUAL_STRING("T10 = 110 degC good, sampled at 3.000 s", line_of("T10 "));
    TEST_ASSERT_EQUAL_STRING("T1 = 85 degC good", line_of("T1 "));
    board.values[1] = 112;
    samples(3); /* 9 s */
    ask_ok("status");
    TEST_ASSERT_EQUAL_STRING("T10 = 110 degC good, sampled at 3.000 s", line_of("T10 "));
    samples(1);
    ask_ok("status");
    TEST_ASSERT_EQUAL_STRING("T10 = 112 degC good, sampled at 7.000 s", line_of("T10 "));
}

static void a_delay_alone_is_shown_too(void)
{
    ask_ok("set meas2.delay 2");
    samples(1); /* 6 s */
    ask_ok("status");
    TEST_ASSERT_EQUAL_STRING("T10 = 110 degC good, sampled at 4.000 s", line_of("T10 "));
}

/* The column of a name in the last header, from 0. */
static int column_of(const char *name)
{
    const char *header = NULL;
    for (const char *at = board.said; (at = strstr(at, "H,")) != NULL; at++)
        header = at;
    TEST_ASSERT_NOT_NULL(header);
    const char *end = strchr(header, '\n'), *there = strstr(header, name);
    if (!there || there > end)
        return -1;
    int n = 0;
    for (const char *c = header; c < there; c++)
        n += *c == ',';
    return n + 1; /* the name begins with the comma before it */
}

static void telemetry_tells_in_which_ticks_a_reading_was_looked_at(void)
{
    ask_ok("log on");
    TEST_ASSERT_EQUAL(-1, column_of(",T10.new"));
    an_analyser();
    int column = column_of(",T10.new");
    TEST_ASSERT_EQUAL(column_of(",T10.q") + 1, column);
    TEST_ASSERT_EQUAL(-1, column_of(",T1.new"));
    board_forget();
    samples(8); /* 7 to 14 s */
    unsigned rows = 0;
    for (const char *row = board.said; (row = strstr(row, "T,")) != NULL; row++, rows++) {
        const char *c = row;
        for (int n = 0; n < column; n++)
            c = strchr(c, ',') + 1;
        TEST_ASSERT_EQUAL((rows + 7) % 4 == 2 ? '1' : '0', *c);
    }
    TEST_ASSERT_EQUAL(8, rows);
}

static void what_is_not_set_is_neither_stored_nor_dumped(void)
{
    ask_ok("dump");
    TEST_ASSERT_FALSE(said("meas2.every"));
    an_analyser();
    ask_ok("dump");
    TEST_ASSERT_TRUE(said("set meas2.every 4"));
    TEST_ASSERT_TRUE(said("set meas2.phase 2"));
    TEST_ASSERT_TRUE(said("set meas2.delay 3"));
    TEST_ASSERT_FALSE(said("meas1.every"));
    ask_ok("save");
    power_on();
    ask_ok("load");
    pass(1100);
    static const char *const kept[] = {"meas2.every = 4 ticks", "meas2.phase = 2 ticks",
                                       "meas2.delay = 3 ticks", "meas1.every = 1 ticks"};
    for (unsigned k = 0; k < 4; k++) {
        char line[40];
        snprintf(line, sizeof line, "get %.11s", kept[k]);
        ask_ok(line);
        TEST_ASSERT_EQUAL_STRING(kept[k], reply[0]);
    }
}

static void settings_that_do_not_go_together_are_refused_in_words(void)
{
    ask_ok("set meas2.every 4");
    ask("set meas2.phase 4");
    TEST_ASSERT_EQUAL_STRING("err RANGE meas2.phase: 'T10' must be below `every`", reply[0]);
}

static void a_loop_that_runs_between_its_samples_is_told_of(void)
{
    board_forget();
    ask_ok("set meas2.every 4");
    samples(1);
    TEST_ASSERT_TRUE(said("warning LOOP_DIVISOR bottom 4 "));
}

static void start_up_does_not_test_it(void)
{
    an_analyser();
    ask_ok("out heat 0.5");
    samples(1);
    ask("commission begin");
    TEST_ASSERT_EQUAL_STRING(
        "err STATE T10: is not sampled in every base tick; set its test to off",
        reply[n_reply - 1]);
    ask("commission relay bottom");
    TEST_ASSERT_EQUAL_STRING(
        "err STATE T10: is not sampled in every base tick; a relay test needs that",
        reply[n_reply - 1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(status_says_when_it_was_sampled);
    RUN_TEST(a_delay_alone_is_shown_too);
    RUN_TEST(telemetry_tells_in_which_ticks_a_reading_was_looked_at);
    RUN_TEST(what_is_not_set_is_neither_stored_nor_dumped);
    RUN_TEST(settings_that_do_not_go_together_are_refused_in_words);
    RUN_TEST(a_loop_that_runs_between_its_samples_is_told_of);
    RUN_TEST(start_up_does_not_test_it);
    return UNITY_END();
}
