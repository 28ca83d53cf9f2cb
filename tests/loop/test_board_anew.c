/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* A plant at the board's own pins, whose settings come anew while it runs, and whose clock runs over its 32 bits. */
#include "pins_bench.h"

#define CLOCK_WRAP_MS (UINT64_C(1) << 32)

static const char wiring[] = "T ds18b20 wire1 rom=28-000005e2fdc3\n"
                             "A ssr     PB0\n"
                             "B ssr     PB1\n";

static void output(unsigned row, const char *name, const char *pin)
{
    char line[60];
    snprintf(line, sizeof line, "set out%u.name %s", row, name);
    ask_ok(line);
    snprintf(line, sizeof line, "set out%u.kind window", row);
    ask_ok(line);
    snprintf(line, sizeof line, "set out%u.pin %s", row, pin);
    ask_ok(line);
    snprintf(line, sizeof line, "set mv%u.name %s", row, name);
    ask_ok(line);
}

static void begin_at(uint64_t clock_ms)
{
    pins_power_on(wiring);
    board.clock_ms = clock_ms;
    memory_port_jump(clock_ms);
    pins_measure("T", 30);
    PINS_ASK("begin", "set io.source board", "set tick.base 5");
    PINS_ASK("set chan1.name T", "set chan1.unit degC", "set chan1.device ds18b20",
             "set chan1.bus wire1", "set chan1.select 28000005e2fdc3", "set meas1.name T",
             "set meas1.unit degC");
    output(1, "A", "PB0");
    output(2, "B", "PB1");
    ask_ok("apply");
    pass(15000);
}

void setUp(void)
{
    begin_at(0);
}

void tearDown(void)
{
    pins_close();
}

static void an_output_in_the_place_of_another_gets_no_command_of_it(void)
{
    ask_ok("out A 100");
    TEST_ASSERT_TRUE(pins_mean("A", 10000) > 0.4);
    PINS_ASK("begin", "set out1.name -", "set mv1.name -", "apply");
    double before = pins_on_s("B");
    pass(12000); /* the old settings rule until the next tick */
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pins_on_s("B") - before);
}

/* 2^32 ms is no multiple of the base tick, of the window or of the sensor's interval. */
static void the_wrap_of_the_clock_is_not_noticed(void)
{
    begin_at(CLOCK_WRAP_MS - 45000u);
    ask_ok("out A 30");
    pass(5000);
    board_forget();
    TEST_ASSERT_DOUBLE_WITHIN(0.001, 0.3, pins_mean("A", 60000));
    TEST_ASSERT_TRUE(board.clock_ms > CLOCK_WRAP_MS);
    TEST_ASSERT_FALSE_MESSAGE(said("SENSOR_FAULT") || said("MEASUREMENT_BAD"), board.said);
    TEST_ASSERT_FALSE_MESSAGE(said("SAMPLE_"), board.said);
}

static void what_is_opened_anew_behind_the_wrap_reads_on(void)
{
    begin_at(CLOCK_WRAP_MS - 20000u);
    pass(10000);
    pins_measure("T", 40);
    PINS_ASK("set out2.hi 50", "log on"); /* opens the pins anew */
    pass(12000);
    (void)pins_take_rows();
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 40, pins_field("T"));
    TEST_ASSERT_EQUAL_DOUBLE(0, pins_field("T.q"));
    TEST_ASSERT_FALSE_MESSAGE(said("SENSOR_FAULT"), board.said);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_wrap_of_the_clock_is_not_noticed);
    RUN_TEST(what_is_opened_anew_behind_the_wrap_reads_on);
    RUN_TEST(an_output_in_the_place_of_another_gets_no_command_of_it);
    return UNITY_END();
}
