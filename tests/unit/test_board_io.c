/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* The board's own pins as a source of samples: how old a reading may be, what a bus that fails leaves, and outputs that nobody commands. */
#include <string.h>

#include "buses.h"
#include "io/board_devices.h"
#include "io/board_io.h"
#include "outputs/outputs.h"
#include "settings/parameters.h"
#include "unity.h"

#define TICK_MS 5000u

static struct config config;
static struct event_queue events;
static struct board_io board;
static struct io_port port;
static uint64_t plant_time, now_ms;
static struct io_sample sample; /* the last one */

static void set(const char *name, const char *value)
{
    struct parameter p;
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, parameter_find(name, &p), name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, parameter_set(&p, &config, value), value);
}

static void begin(void)
{
    buses_reset();
    board_io_init(&board, &events, &plant_time);
    port = board_io_port(&board);
    board_io_take(&board, &config);
    now_ms = 0;
    memset(&sample, 0, sizeof sample);
}

/* Time passes, without a command. devices: the board clock turns. */
static void let_pass(uint32_t ms, bool devices)
{
    for (uint64_t end = now_ms + ms; now_ms < end;) {
        now_ms++;
        if (devices)
            (void)board_io_clock(&board, (uint32_t)now_ms);
        if (now_ms % 50u == 0)
            (void)port.poll(port.context, now_ms, &sample);
    }
}

void setUp(void)
{
    event_queue_init(&events);
    parameters_defaults(&config);
    set("io.source", "board");
    config.tick_s = (float)TICK_MS / 1000.0f;
    set("chan1.name", "L");
    set("chan1.device", "level");
    set("chan1.select", "PC1");
    set("out1.name", "Q");
    set("out1.kind", "window");
    set("out1.pin", "PB0");
}

void tearDown(void)
{
    buses_set_world(NULL);
}

/* Its device measures each second here. */
static void a_reading_is_missing_when_it_is_older_than_three_intervals_and_a_tick(void)
{
    begin();
    let_pass(4u * TICK_MS, true);
    let_pass(TICK_MS, false);
    TEST_ASSERT_EQUAL_INT(QUALITY_GOOD, sample.measurement[0].quality);
    let_pass(TICK_MS, false);
    TEST_ASSERT_EQUAL_INT(QUALITY_MISSING, sample.measurement[0].quality);
}

static enum wire_answer shorted(void *context, uint64_t at_ns, unsigned bus)
{
    (void)context;
    (void)at_ns;
    (void)bus;
    return WIRE_SHORTED;
}

/* Nothing was read that could be called bad. */
static void the_reading_of_a_bus_that_fails_is_missing(void)
{
    const struct world world = {.wire_reset = shorted};
    buses_set_world(&world);
    set("chan1.device", "ds18b20");
    set("chan1.bus", "wire1");
    set("chan1.select", "28000005e2fdc3");
    begin();
    let_pass(4u * TICK_MS, true);
    TEST_ASSERT_EQUAL_UINT(1, sample.n_measurements);
    TEST_ASSERT_EQUAL_INT(QUALITY_MISSING, sample.measurement[0].quality);
}

/* 1.2 V at 100 ohm are 12 mA, the middle. A code is 4.096 V / 2^15. */
static void a_current_is_spread_over_the_span_of_its_row(void)
{
    set("chan1.device", "ads1115");
    set("chan1.type", "4-20mA");
    set("chan1.lo", "-100");
    set("chan1.hi", "200");
    const struct device_config *row = &config.pins.device[0];
    const struct device d = {.kind = board_device_kind(row),
                             .settings = board_device_settings(&config.pins, row)};
    const struct device_result result = {.code = {9600}};
    struct current_loop loop = {.failing_s = 0.0f};
    struct io_reading reading;
    TEST_ASSERT_TRUE(board_device_value(row, &d, &result, 1.0f, &loop, &reading));
    TEST_ASSERT_EQUAL_INT(QUALITY_GOOD, reading.quality);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 50.0f, reading.value);
}

/* Polls repeat a command for as long as the next one may take, a tick and half a second. Then the dead man counts. */
static void an_output_is_let_go_a_tick_and_a_dead_man_after_its_last_command(void)
{
    const struct io_command full = {.n_outputs = 1, .output = {{.value = 100.0f, .drive = true}}};
    begin();
    let_pass(TICK_MS, true);
    TEST_ASSERT_EQUAL_INT(ERR_OK, port.command(port.context, &full, now_ms));
    let_pass(TICK_MS + 500u + 1900u, true);
    TEST_ASSERT_EQUAL_INT(OUTPUT_COMMANDED, outputs_rule(0));
    let_pass(150u, true);
    TEST_ASSERT_EQUAL_INT(OUTPUT_DEAD_MAN, outputs_rule(0));
}

/* Its value is that of a tick which only looks on. */
static void an_output_that_nobody_drives_gets_no_command(void)
{
    const struct io_command idle = {.n_outputs = 1, .output = {{.value = 100.0f, .drive = false}}};
    begin();
    let_pass(TICK_MS, true);
    TEST_ASSERT_EQUAL_INT(ERR_OK, port.command(port.context, &idle, now_ms));
    let_pass(500u, true);
    TEST_ASSERT_EQUAL_INT(OUTPUT_NO_DRIVER, outputs_rule(0));
}

/* Nobody reports for the main loop here, so the contactor stays open. */
static void a_heater_without_its_contactor_reads_back_as_off(void)
{
    const struct io_command full = {.n_outputs = 1, .output = {{.value = 100.0f, .drive = true}}};
    set("out1.heater", "on");
    set("out2.name", "K");
    set("out2.kind", "enable");
    set("out2.pin", "PB1");
    set("out2.least_off", "1");
    begin();
    let_pass(TICK_MS, true);
    TEST_ASSERT_EQUAL_INT(ERR_OK, port.command(port.context, &full, now_ms));
    let_pass(TICK_MS, true);
    TEST_ASSERT_EQUAL_INT(OUTPUT_NO_ENABLE, outputs_rule(0));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, sample.readback[0].value);
}

/* A window knows no position. */
static void only_an_output_that_keeps_a_position_announces_one_as_safe(void)
{
    set("out1.safe", "0.5");
    set("out2.name", "V");
    set("out2.kind", "analog");
    set("out2.pin", "PB1");
    set("out2.safe", "0.5");
    begin();
    TEST_ASSERT_EQUAL_UINT8(2, port.count(port.context, true));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, port.channel(port.context, true, 0).safe);
    TEST_ASSERT_EQUAL_FLOAT(50.0f, port.channel(port.context, true, 1).safe);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_reading_is_missing_when_it_is_older_than_three_intervals_and_a_tick);
    RUN_TEST(the_reading_of_a_bus_that_fails_is_missing);
    RUN_TEST(a_current_is_spread_over_the_span_of_its_row);
    RUN_TEST(an_output_is_let_go_a_tick_and_a_dead_man_after_its_last_command);
    RUN_TEST(an_output_that_nobody_drives_gets_no_command);
    RUN_TEST(a_heater_without_its_contactor_reads_back_as_off);
    RUN_TEST(only_an_output_that_keeps_a_position_announces_one_as_safe);
    return UNITY_END();
}
