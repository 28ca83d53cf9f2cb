/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* A plant in two parts: T1, T2 and the heater Q at the board's own pins; T5, T6, feed, reflux and heat at the link. */
#include "pins_bench.h"

static const char wiring[] = "T1   max31865 spi1 PA4  reference=430 wires=3\n"
                             "T2   max31865 spi1 PB12 reference=430 wires=3\n"
                             "Q    ssr      PB0       hi=3\n";

static void channel(const char *group, unsigned i, const char *name, const char *unit)
{
    char line[80];
    snprintf(line, sizeof line, "set %s%u.name %s", group, i, name);
    ask_ok(line);
    snprintf(line, sizeof line, "set %s%u.unit %s", group, i, unit);
    ask_ok(line);
}

static void measurement(unsigned i, const char *name, const char *unit)
{
    char line[80];
    channel("meas", i, name, unit);
    snprintf(line, sizeof line, "set meas%u.hi 200", i);
    ask_ok(line);
}

static void thermometer(unsigned i, const char *name, const char *select)
{
    char line[80];
    channel("chan", i, name, "degC");
    snprintf(line, sizeof line, "set chan%u.device max31865", i);
    ask_ok(line);
    snprintf(line, sizeof line, "set chan%u.bus spi1", i);
    ask_ok(line);
    snprintf(line, sizeof line, "set chan%u.select %s", i, select);
    ask_ok(line);
}

static void set_up(void)
{
    PINS_ASK("begin", "set io.source both", "set tick.base 1");
    thermometer(1, "T1", "PA4");
    thermometer(2, "T2", "PB12");
    channel("out", 1, "Q", "kW");
    PINS_ASK("set out1.kind window", "set out1.pin PB0", "set out1.hi 3", "set out1.period 2");
    measurement(1, "T1", "degC");
    measurement(2, "T6", "degC");
    measurement(3, "T2", "degC");
    measurement(4, "T5", "degC");
    channel("mv", 1, "reflux", "l/h");
    channel("mv", 2, "Q", "kW");
    PINS_ASK("set mv1.hi 10", "set mv1.max 10", "set mv1.safe 1", "set mv2.hi 3", "set mv2.max 3");
    PINS_ASK("set loop1.name boil", "set loop1.pv T1", "set loop1.out Q", "set loop1.gain 2",
             "set loop1.ti 100", "set loop2.name top", "set loop2.pv T5", "set loop2.out reflux",
             "set loop2.action direct", "set loop2.ti 200", "set meas4.hold 5", "apply", "log on");
}

/* The link's plant, without channels that are at the pins. */
static void name_link(const char *first, const char *second)
{
    board.names[0] = first;
    board.names[1] = second;
}

/* So many seconds, with a sample of the link in each. */
static void seconds(unsigned n)
{
    (void)pins_take_rows();
    board_forget();
    while (n--) {
        pass(500);
        if (board.ready)
            samples(1);
        pass(500);
    }
}

static void put_into_automatic(void)
{
    PINS_ASK("out Q 1.5", "out reflux 4", "mode boil auto", "mode top auto");
    seconds(3);
}

static void loop_is(const char *loop, const char *mode)
{
    char line[40];
    snprintf(line, sizeof line, "loop %s", loop);
    ask_ok(line);
    snprintf(line, sizeof line, "%s %s", loop, mode);
    TEST_ASSERT_TRUE_MESSAGE(said(line), board.said);
}

static void status_begins(const char *words)
{
    ask_ok("status");
    TEST_ASSERT_EQUAL_STRING_LEN(words, reply[0], strlen(words));
}

static void reads(const char *name, double value)
{
    char quality[24];
    snprintf(quality, sizeof quality, "%s.q", name);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.1, value, pins_field(name), name);
    TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(0.0, pins_field(quality), name);
}

static bool is_good(const char *name)
{
    char quality[24];
    snprintf(quality, sizeof quality, "%s.q", name);
    return pins_field(quality) == 0.0;
}

void setUp(void)
{
    pins_power_on(wiring);
    pins_measure("T1", 78.3);
    pins_measure("T2", 60.0);
    name_link("T5", "T6");
    set_up();
    connect_plant();
    seconds(6);
}

void tearDown(void)
{
    pins_close();
}

/* ---- samples and commands ---- */

static void a_sample_has_readings_of_the_pins_and_of_the_link(void)
{
    reads("T1", 78.3);
    reads("T2", 60.0);
    reads("T5", 85.0);
    reads("T6", 115.0);
    pins_measure("T1", 90.0);
    board.values[0] = 70.0;
    seconds(3);
    reads("T1", 90.0);
    reads("T5", 70.0);
    status_begins("state safe, plant at the board's pins, plant link ready handmade, plant time ");
}

static void the_clock_of_the_board_samples(void)
{
    uint32_t before = tick_count();
    for (unsigned i = 0; i < 100; i++) { /* however fast the link's plant is */
        samples(1);
        pass(100);
    }
    TEST_ASSERT_EQUAL_UINT32(before + 10, tick_count());
    pass(3000); /* and without it */
    TEST_ASSERT_EQUAL_UINT32(before + 13, tick_count());
}

static void each_part_gets_its_own_commands(void)
{
    PINS_ASK("out Q 1.5", "out reflux 4");
    seconds(3);
    TEST_ASSERT_EQUAL_UINT8(2, board.command.n_outputs);
    TEST_ASSERT_EQUAL_FLOAT(4.0f, board.command.output[0].value);
    TEST_ASSERT_TRUE(board.command.output[0].drive);
    TEST_ASSERT_FALSE(board.command.output[1].drive); /* heat is configured nowhere */
    TEST_ASSERT_FALSE(board.command.safe);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.5, pins_mean("Q", 20000));
}

static void a_sample_of_the_link_is_answered_in_the_next_tick_and_once(void)
{
    pass(1000 - board.clock_ms % 1000 + 200);
    unsigned before = board.commands;
    samples(1);
    TEST_ASSERT_EQUAL_UINT(before, board.commands);
    pass(1000);
    TEST_ASSERT_EQUAL_UINT(before + 1, board.commands);
    TEST_ASSERT_EQUAL_UINT32(board.number, board.command.number);
    TEST_ASSERT_EQUAL_UINT64(board.time_ms, board.command.time_ms);
    pass(1000);
    TEST_ASSERT_EQUAL_UINT(before + 1, board.commands);
    send_sample_again(); /* the answer was lost */
    pass(1000);
    TEST_ASSERT_EQUAL_UINT(before + 2, board.commands);
    TEST_ASSERT_EQUAL_UINT32(board.number, board.command.number);
}

static void of_several_samples_of_the_link_the_newest_counts(void)
{
    pass(1000 - board.clock_ms % 1000 + 200);
    unsigned before = board.commands;
    board.values[0] = 70.0;
    samples(1);
    board.values[0] = 71.0;
    samples(1);
    pins_samples(1);
    reads("T5", 71.0);
    TEST_ASSERT_EQUAL_UINT(before + 1, board.commands);
    TEST_ASSERT_EQUAL_UINT32(board.number, board.command.number);
}

/* ---- the link's plant goes and comes ---- */

static void without_its_plant_the_channels_of_the_link_fall_and_the_board_goes_on(void)
{
    put_into_automatic();
    board.mute = true;
    pins_samples(20);
    TEST_ASSERT_TRUE_MESSAGE(said("LINK_DOWN handmade"), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said("CHANNEL_MISSING reflux"), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said("MANUAL_BY_BOARD top"), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said("MEASUREMENT_BAD T6"), board.said);
    TEST_ASSERT_FALSE_MESSAGE(said("SAFE_STATE"), board.said);
    TEST_ASSERT_FALSE(is_good("T5"));
    TEST_ASSERT_FALSE(is_good("T6"));
    reads("T1", 78.3);
    loop_is("boil", "auto");
    loop_is("top", "manual");
    status_begins("state run, plant at the board's pins, plant link down, plant time ");
    ask_ok("alarm");
    TEST_ASSERT_TRUE_MESSAGE(said("LINK_DOWN the board's own pins go on alone"), board.said);
}

static void a_plant_that_comes_back_is_taken_as_it_was_and_its_loops_wait(void)
{
    put_into_automatic();
    board.mute = true;
    pass(60000);
    board.values[0] = 82.0;
    connect_plant();
    seconds(6);
    reads("T5", 82.0);
    reads("T6", 115.0);
    loop_is("boil", "auto");
    loop_is("top", "manual");
    seconds(2);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, board.command.output[0].value); /* mv1.safe */
    PINS_ASK("out reflux 4", "mode top auto");
    seconds(2);
    loop_is("top", "auto");
}

static void a_plant_with_another_table_is_bound_anew_beside_the_board(void)
{
    put_into_automatic();
    name_link("other", "T5");
    board.session++;
    plant_hello();
    board.values[0] = 44.0;
    board.values[1] = 83.0;
    seconds(8);
    reads("T5", 83.0);
    reads("T1", 78.3);
    TEST_ASSERT_TRUE_MESSAGE(said("CHANNEL_MISSING T6"), board.said);
    TEST_ASSERT_FALSE_MESSAGE(said("SAFE_STATE"), board.said);
    loop_is("boil", "auto");
    loop_is("top", "manual"); /* its output was at its safe value meanwhile */
}

static void settings_that_come_while_the_plant_is_away_leave_the_board_alone(void)
{
    put_into_automatic();
    board.mute = true;
    pass(10000);
    PINS_ASK("begin", "set loop1.gain 3", "apply");
    seconds(3);
    loop_is("boil", "auto");
    connect_plant();
    seconds(4);
    reads("T5", 85.0);
    loop_is("boil", "auto");
}

static void a_board_begins_without_its_link(void)
{
    board.mute = true;
    PINS_ASK("save");
    memory_port_reset(HAL_RESET_POWER_ON);
    board_run();
    type("mode machine\n");
    pass(3000);
    PINS_ASK("out Q 1.5", "log on");
    pins_header[0] = pins_row[0] = '\0';
    pins_samples(4);
    reads("T1", 78.3);
    TEST_ASSERT_FALSE(is_good("T5"));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.5, pins_mean("Q", 20000));
    PINS_ASK("mode boil auto");
    ask_refused("out reflux 4", "UNKNOWN");
    connect_plant();
    seconds(6);
    reads("T5", 85.0);
    loop_is("boil", "auto");
    PINS_ASK("out reflux 4");
    seconds(2);
    TEST_ASSERT_EQUAL_FLOAT(4.0f, board.command.output[0].value);
}

/* ---- samples that do not come ---- */

static void readings_of_the_link_are_missing_three_intervals_and_a_tick_after_the_last_sample(void)
{
    seconds(2);
    for (unsigned i = 0; i < 3; i++) {
        pins_samples(1);
        TEST_ASSERT_TRUE(is_good("T5"));
        TEST_ASSERT_TRUE(is_good("T6"));
    }
    pins_samples(2); /* 4.5 s after it */
    TEST_ASSERT_FALSE(is_good("T6"));
    TEST_ASSERT_EQUAL_UINT(1, times_said("SAMPLE_OVERDUE handmade"));
    pins_samples(5);
    TEST_ASSERT_EQUAL_UINT(0, times_said("SAMPLE_OVERDUE"));
    reads("T1", 78.3);
    seconds(3);
    reads("T6", 115.0);
}

/* As a silent link is down after 2 s, and not before. */
static void readings_of_a_fast_link_last_two_seconds(void)
{
    pins_power_on(wiring);
    name_link("T5", "T6");
    set_up();
    board.tick_ms = 100;
    connect_plant();
    PINS_ASK("set tick.base 0.1", "log on");
    for (unsigned n = 0; n < 60; n++) {
        samples(1);
        pass(100);
    }
    (void)pins_take_rows();
    pass(1700);
    TEST_ASSERT_TRUE(is_good("T5"));
    pass(500);
    TEST_ASSERT_FALSE(is_good("T5"));
}

static void a_sample_whose_time_stands_still_is_not_new(void)
{
    for (unsigned i = 0; i < 20; i++) {
        pass(300);
        sample_after(0);
    }
    pins_samples(1);
    TEST_ASSERT_FALSE(is_good("T6"));
    TEST_ASSERT_EQUAL_UINT32(board.number, board.command.number); /* but it has its answer */
}

/* ---- conflicts ---- */

static void a_plant_with_a_channel_of_the_pins_is_refused_until_either_changes(void)
{
    put_into_automatic();
    name_link("T5", "T2");
    board.session++;
    board_forget();
    plant_hello();
    pass(5000);
    TEST_ASSERT_EQUAL_UINT_MESSAGE(1, times_said(" PLANT_REFUSED handmade "), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said("channel with the name of one at the board's own pins"),
                             board.said);
    loop_is("boil", "auto");
    status_begins("state run, plant at the board's pins, plant link down, plant time ");
    ask_ok("alarm");
    TEST_ASSERT_TRUE_MESSAGE(said("PLANT_REFUSED handmade channel with the name"), board.said);
    PINS_ASK("begin", "set chan2.name T3", "apply");
    pass(3000);
    TEST_ASSERT_TRUE(board.ready);
    seconds(6);
    reads("T2", 115.0); /* it is the link's now */
    PINS_ASK("begin", "set chan2.name T2", "apply");
    pass(3000);
    ask_ok("alarm");
    TEST_ASSERT_TRUE_MESSAGE(said("PLANT_REFUSED handmade channel with the name"), board.said);
    name_link("T5", "T6");
    board.session++;
    seconds(6);
    TEST_ASSERT_TRUE(board.ready);
}

static void one_of_fifteen(uint8_t index, struct link_page *page)
{
    snprintf(page->name, sizeof page->name, "m%u", index);
    snprintf(page->unit, sizeof page->unit, "degC");
    page->manipulated = index >= 15;
}

static void a_plant_with_too_many_channels_beside_the_pins_is_refused(void)
{
    board.n_measurements = 15;
    board.n_outputs = 1;
    board.announce = one_of_fifteen;
    board.session++;
    board_forget();
    plant_hello();
    pass(3000);
    TEST_ASSERT_TRUE_MESSAGE(said(" PLANT_REFUSED handmade "), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said("more channels of a kind than this board takes"), board.said);
    reads("T1", 78.3);
}

/* ---- the sources alone ---- */

static void each_source_works_alone_before_and_after(void)
{
    PINS_ASK("out Q 3");
    PINS_ASK("begin", "set io.source link", "apply");
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pins_mean("Q", 10000));
    seconds(4);
    reads("T5", 85.0);
    TEST_ASSERT_FALSE(is_good("T1"));
    status_begins("state safe, plant link ready handmade, plant time ");
    PINS_ASK("begin", "set io.source board", "apply");
    samples(1); /* the tick that takes them */
    unsigned commands = board.commands;
    pins_samples(6);
    reads("T1", 78.3);
    TEST_ASSERT_FALSE(is_good("T5"));
    status_begins("state safe, plant at the board's pins, plant time ");
    ask_ok("alarm");
    TEST_ASSERT_FALSE_MESSAGE(said("LINK_DOWN"), board.said);
    TEST_ASSERT_EQUAL_UINT(commands, board.commands);
    PINS_ASK("begin", "set io.source both", "apply");
    pass(3000);
    seconds(6);
    reads("T1", 78.3);
    reads("T5", 85.0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_sample_has_readings_of_the_pins_and_of_the_link);
    RUN_TEST(the_clock_of_the_board_samples);
    RUN_TEST(each_part_gets_its_own_commands);
    RUN_TEST(a_sample_of_the_link_is_answered_in_the_next_tick_and_once);
    RUN_TEST(of_several_samples_of_the_link_the_newest_counts);
    RUN_TEST(without_its_plant_the_channels_of_the_link_fall_and_the_board_goes_on);
    RUN_TEST(a_plant_that_comes_back_is_taken_as_it_was_and_its_loops_wait);
    RUN_TEST(a_plant_with_another_table_is_bound_anew_beside_the_board);
    RUN_TEST(settings_that_come_while_the_plant_is_away_leave_the_board_alone);
    RUN_TEST(a_board_begins_without_its_link);
    RUN_TEST(readings_of_the_link_are_missing_three_intervals_and_a_tick_after_the_last_sample);
    RUN_TEST(readings_of_a_fast_link_last_two_seconds);
    RUN_TEST(a_sample_whose_time_stands_still_is_not_new);
    RUN_TEST(a_plant_with_a_channel_of_the_pins_is_refused_until_either_changes);
    RUN_TEST(a_plant_with_too_many_channels_beside_the_pins_is_refused);
    RUN_TEST(each_source_works_alone_before_and_after);
    return UNITY_END();
}
