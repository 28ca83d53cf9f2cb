/* A configuration of 200 lines pasted into the console at 115200 baud, over a line that loses what is not taken in
 * time, while the main loop is at times busy with something else. */
#include "board_bench.h"
#include "uart_model.h"

#define LINES 200

static struct uart_model uart;
static char lines[LINES][60]; /* the `set` lines are 1 .. LINES - 2 */
static char paste[LINES * 60];

static unsigned add(unsigned n, const char *group, unsigned index, const char *field,
                    const char *value)
{
    TEST_ASSERT_TRUE(n < LINES - 1);
    snprintf(lines[n], sizeof lines[n], "set %s%u.%s %s", group, index, field, value);
    return n + 1;
}

/* As many channels as the board has, some loops; every line changes something. */
static void make_paste(const char *end)
{
    static const char *const meas[][2] = {
        {"unit", "degC"}, {"lo", "12.25"}, {"hi", "160.5"}, {"filter", "2.5"}, {"hold", "75"}};
    static const char *const mv[][2] = {
        {"unit", "l/h"}, {"hi", "90.125"}, {"max", "80"}, {"rate", "0.625"}, {"safe", "1.75"}};
    static const char *const loop[][2] = {
        {"gain", "1.625"}, {"ti", "312.5"}, {"td", "40"}, {"tt", "77"}};
    unsigned n = 1;
    char name[16];
    strcpy(lines[0], "begin");
    for (unsigned i = 1; i <= 14; i++) {
        snprintf(name, sizeof name, "tray_%u", i);
        n = add(n, "meas", i, "name", name);
        for (unsigned k = 0; k < 5; k++)
            n = add(n, "meas", i, meas[k][0], meas[k][1]);
        snprintf(name, sizeof name, "valve_%u", i);
        n = add(n, "mv", i, "name", name);
        for (unsigned k = 0; k < 5; k++)
            n = add(n, "mv", i, mv[k][0], mv[k][1]);
    }
    for (unsigned i = 1; i <= 4; i++) {
        snprintf(name, sizeof name, "loop_%u", i);
        n = add(n, "loop", i, "name", name);
        snprintf(name, sizeof name, "tray_%u", i);
        n = add(n, "loop", i, "pv", name);
        snprintf(name, sizeof name, "valve_%u", i);
        n = add(n, "loop", i, "out", name);
        for (unsigned k = 0; k < 4 && n < LINES - 1; k++)
            n = add(n, "loop", i, loop[k][0], loop[k][1]);
    }
    for (unsigned i = 15; n < LINES - 1; i++) {
        snprintf(name, sizeof name, "spare_%u", i);
        n = add(n, "meas", i, "name", name);
    }
    TEST_ASSERT_EQUAL(LINES - 1, n);
    strcpy(lines[n], "apply");
    paste[0] = '\0';
    for (unsigned i = 0; i < LINES; i++) {
        strcat(paste, lines[i]);
        strcat(paste, end);
    }
}

/* The board's own rings; a main loop that is away for 0.3 s in every 20th turn. */
static void start(uint32_t rx)
{
    memory_port_set_console_rings(rx, 4096);
    power_on();
    memset(&uart, 0, sizeof uart);
    uart.honours = true;
    uart.latency = 16;
    uart.turn_ms = 1;
    uart.slow_every = 20;
    uart.slow_ms = 300;
}

static void go(const char *title)
{
    uart_model_paste(&uart, paste, strlen(paste));
    printf("%s: %zu bytes, %u lines, %u dropped; %u ms, %u XOFF, longest stop %u ms\n", title,
           uart.sent, LINES, uart.dropped, uart.ms, uart.xoffs, uart.longest_stop_ms);
    TEST_ASSERT_EQUAL(strlen(paste), uart.sent);
    board.clock_ms = (uart.clock_ms + 49) / 50 * 50;
    memory_port_set_clock(board.clock_ms);
}

static unsigned replies(const char *end)
{
    unsigned n = 0;
    for (const char *at = uart.heard; (at = strstr(at, end)) != NULL; at++)
        n++;
    return n;
}

/* Every line that was pasted is in force, and nothing else. */
static void all_is_there(void)
{
    TEST_ASSERT_EQUAL(0, uart.dropped);
    ask_ok("mode machine");
    ask_ok("diff defaults");
    TEST_ASSERT_EQUAL(LINES - 2 + 1, n_reply);
    for (unsigned i = 1; i < LINES - 1; i++) {
        bool found = false;
        for (unsigned k = 0; k < n_reply && !found; k++)
            found = strcmp(lines[i], reply[k]) == 0;
        TEST_ASSERT_TRUE_MESSAGE(found, lines[i]);
    }
}

void setUp(void)
{
    make_paste("\n");
}
void tearDown(void)
{
    memory_port_set_console_rings(16384, 16384);
}

static void two_hundred_lines_arrive_whole_while_the_main_loop_is_slow(void)
{
    start(1024);
    go("slow main loop");
    TEST_ASSERT_TRUE(uart.xoffs > 0);
    TEST_ASSERT_EQUAL(uart.xoffs, uart.xons);
    TEST_ASSERT_EQUAL(LINES, replies("ok\n"));
    all_is_there();
}

static void and_into_the_receive_ring_of_a_small_board(void)
{
    start(256);
    go("ring of 256 bytes");
    TEST_ASSERT_EQUAL(LINES, replies("ok\n"));
    all_is_there();
}

/* A terminal that goes on for longer after an XOFF needs a larger ring: 64 bytes leave it 15. */
static void and_into_one_of_64_bytes_if_the_terminal_stops_within_fifteen(void)
{
    start(64);
    uart.latency = 15;
    go("ring of 64 bytes");
    TEST_ASSERT_EQUAL(LINES, replies("ok\n"));
    all_is_there();
    start(64);
    uart.latency = 16;
    go("ring of 64 bytes, a byte too slow");
    TEST_ASSERT_TRUE(uart.dropped > 0);
}

static void and_with_an_echo_that_asks_for_more_than_the_line_back_can_carry(void)
{
    make_paste("\r");
    start(1024);
    type("mode human\n");
    go("with echo");
    TEST_ASSERT_EQUAL(LINES, replies("ok\r\n"));
    for (unsigned i = 0; i < LINES; i++)
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(uart.heard, lines[i]), lines[i]);
    all_is_there();
}

static void and_without_flow_control_where_the_main_loop_keeps_up(void)
{
    start(1024);
    uart.honours = false;
    uart.slow_every = 0;
    go("no flow control, main loop keeps up");
    TEST_ASSERT_EQUAL(0, uart.xoffs);
    all_is_there();
}

/* The model does lose bytes, and then the console says that the lines it got are not what was meant. */
static void without_flow_control_a_slow_main_loop_loses_bytes_counts_them_and_refuses(void)
{
    start(1024);
    uart.honours = false;
    go("no flow control, slow main loop");
    TEST_ASSERT_TRUE(uart.xoffs > 0);
    TEST_ASSERT_TRUE(uart.dropped > 0);
    TEST_ASSERT_TRUE(replies("err ") > 0);
    ask_ok("stats");
    char want[40];
    snprintf(want, sizeof want, " dropped %u ", uart.dropped);
    TEST_ASSERT_TRUE_MESSAGE(said(want), board.said);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(two_hundred_lines_arrive_whole_while_the_main_loop_is_slow);
    RUN_TEST(and_into_the_receive_ring_of_a_small_board);
    RUN_TEST(and_into_one_of_64_bytes_if_the_terminal_stops_within_fifteen);
    RUN_TEST(and_with_an_echo_that_asks_for_more_than_the_line_back_can_carry);
    RUN_TEST(and_without_flow_control_where_the_main_loop_keeps_up);
    RUN_TEST(without_flow_control_a_slow_main_loop_loses_bytes_counts_them_and_refuses);
    return UNITY_END();
}
