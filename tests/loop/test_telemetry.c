/* Telemetry rows and their header, events, alarms: what the console says of its own accord. */
#include "board_bench.h"

void setUp(void)
{
    running();
}
void tearDown(void) {}

static unsigned fields(const char *line)
{
    unsigned n = 1;
    for (; *line && *line != '\n'; line++)
        n += *line == ',';
    return n;
}

static void telemetry_has_a_header_and_rows_with_as_many_fields(void)
{
    ask_ok("log on");
    const char *header = strstr(board.said, "H,");
    TEST_ASSERT_NOT_NULL(header);
    unsigned n = fields(header);
    board_forget();
    samples(5);
    TEST_ASSERT_EQUAL(5, times_said("T,"));
    for (const char *row = board.said; (row = strstr(row, "T,")) != NULL; row++)
        TEST_ASSERT_EQUAL(n, fields(row));
    ask_ok("log off");
    board_forget();
    samples(3);
    TEST_ASSERT_EQUAL(0, times_said("T,"));
}

static void telemetry_can_be_thinned_out(void)
{
    ask_ok("log on 4");
    board_forget();
    samples(20);
    TEST_ASSERT_EQUAL(5, times_said("T,"));
    ask_refused("log on 0", "RANGE");
    ask_refused("log maybe", "PARSE");
}

static void a_new_plan_brings_a_new_header_before_its_first_row(void)
{
    ask_ok("log on");
    ask_ok("set meas3.name feed");
    board_forget();
    samples(1);
    const char *header = strstr(board.said, "H,"), *row = strstr(board.said, "T,");
    TEST_ASSERT_NOT_NULL(header);
    TEST_ASSERT_TRUE(header < row);
    TEST_ASSERT_EQUAL(fields(header), fields(row));
}

static void numbers_in_telemetry_read_back_as_the_same_float(void)
{
    ask_ok("log on");
    board.values[1] = 115.123459;
    board_forget();
    samples(1);
    const char *row = strstr(board.said, "T,");
    for (unsigned n = 0; n < 8; n++)
        row = strchr(row, ',') + 1;
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, (float)board.values[1], strtof(row, NULL));
}

static void what_happens_is_told_at_once_and_kept(void)
{
    ask_ok("mode bottom auto");
    board_forget();
    samples(1);
    TEST_ASSERT_TRUE(said("! 6.000 info MODE bottom 1 "));
    ask_ok("events");
    TEST_ASSERT_TRUE(said("  6.000 info MODE bottom 1 "));
}

static void what_is_wrong_now_is_listed(void)
{
    board.values[1] = 500;
    samples(1);
    ask_ok("alarm");
    TEST_ASSERT_EQUAL_STRING("MEASUREMENT_BAD T10 out of range", reply[0]);
    board.values[1] = 115;
    samples(1);
    ask_ok("alarm");
    TEST_ASSERT_EQUAL(1, n_reply);
}

static void asynchronous_lines_are_whole_and_leave_the_reply_whole(void)
{
    ask_ok("list all");
    unsigned lines = n_reply;
    ask_ok("log on");
    board_forget();
    memory_port_give(HAL_UART_CONSOLE, "list all\n", 9);
    for (unsigned n = 0; n < 30; n++) { /* samples and events while it is on its way */
        board.number++;
        board.time_ms += n % 2 ? 1300 : 1000;
        send_sample_again();
    }
    cut_reply(); /* takes the tagged lines out */
    TEST_ASSERT_EQUAL(1, n_replies);
    TEST_ASSERT_EQUAL(lines, n_reply);
    TEST_ASSERT_TRUE(times_said("T,") >= 20);
}

static void rows_that_find_no_room_are_counted_and_told(void)
{
    ask_ok("log on");
    board_forget();
    /* The console's reader stands still: rows pile up, first in the ring, then in the queue. */
    for (unsigned n = 0; n < 400; n++) {
        struct frame f;
        board.number++;
        board.time_ms += 1000;
        pack_present_sample(&f);
        link_give(&f);
        memory_port_run();
        uint8_t byte;
        while (memory_port_take(HAL_UART_LINK, &byte, 1))
            if (frame_decode(&board.decoder, byte, &f))
                plant_answers(&f);
    }
    board_run();
    TEST_ASSERT_EQUAL(1, times_said("TELEMETRY_LOST"));
    unsigned rows = times_said("T,1,");
    const char *lost = strstr(board.said, "TELEMETRY_LOST - ");
    TEST_ASSERT_EQUAL(400, rows + strtoul(lost + 17, NULL, 10));
}

static void the_longest_header_a_configuration_can_ask_for_is_whole(void)
{
    char line[80];
    ask_ok("begin");
    for (unsigned i = 1; i <= 16; i++) {
        snprintf(line, sizeof line, "set meas%u.name measurement__%02u", i, i);
        ask_ok(line);
        snprintf(line, sizeof line, "set meas%u.unit kilogram/s%u", i, i % 10);
        ask_ok(line);
        snprintf(line, sizeof line, "set mv%u.name manipulated__%02u", i, i);
        ask_ok(line);
        snprintf(line, sizeof line, "set mv%u.unit kilogram/s%u", i, i % 10);
        ask_ok(line);
    }
    for (unsigned i = 1; i <= 8; i++) {
        snprintf(line, sizeof line, "set loop%u.name loop_________%02u", i, i);
        ask_ok(line);
        snprintf(line, sizeof line, "set loop%u.pv measurement__%02u", i, i);
        ask_ok(line);
        snprintf(line, sizeof line, "set loop%u.out manipulated__%02u", i, i);
        ask_ok(line);
    }
    ask_ok("apply");
    ask_ok("log on");
    const char *header = strstr(board.said, "H,");
    TEST_ASSERT_NOT_NULL(strstr(header, ",stat.tick\n"));
    board_forget();
    samples(1);
    TEST_ASSERT_EQUAL(6 + 16 * 2 + 8 * 2 + 16 * 2 + 1, fields(strstr(board.said, "T,")));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(telemetry_has_a_header_and_rows_with_as_many_fields);
    RUN_TEST(telemetry_can_be_thinned_out);
    RUN_TEST(a_new_plan_brings_a_new_header_before_its_first_row);
    RUN_TEST(numbers_in_telemetry_read_back_as_the_same_float);
    RUN_TEST(what_happens_is_told_at_once_and_kept);
    RUN_TEST(what_is_wrong_now_is_listed);
    RUN_TEST(asynchronous_lines_are_whole_and_leave_the_reply_whole);
    RUN_TEST(rows_that_find_no_room_are_counted_and_told);
    RUN_TEST(the_longest_header_a_configuration_can_ask_for_is_whole);
    return UNITY_END();
}
