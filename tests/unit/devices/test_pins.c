/* Devices without a bus: an analogue input, a flow meter, a level switch; and the table of all kinds.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include <string.h>

#include "devices/devices.h"
#include "devices/pins/analog_input.h"
#include "devices/pins/flow.h"
#include "devices/pins/level.h"
#include "scripted_bus.h"
#include "unity.h"

#define PIN HAL_PIN('C', 0)

static struct device d;
static struct device_settings settings;

void setUp(void)
{
    script_clear();
    settings = (struct device_settings){.select = PIN};
}
void tearDown(void) {}

static void begin(const struct device_kind *kind, uint16_t interval_ms)
{
    TEST_ASSERT_EQUAL(ERR_OK, device_open(&d, kind, &settings, interval_ms));
}

/* ---- analogue input ---- */

static void an_analogue_input_is_a_voltage_of_the_boards_reference(void)
{
    script_board.analog_ready = true;
    script_board.analog_code = 13107; /* a fifth */
    script_board.analog_reference = 3.25f;
    begin(&analog_input_kind, 100);
    script_run(&d, 250);
    struct device_result r = script_result(&d);
    TEST_ASSERT_EQUAL(3, r.number);
    TEST_ASSERT_EQUAL(1200, r.stamp_ms);
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    float volt;
    TEST_ASSERT_TRUE(analog_input_kind.value(&settings, r.code, &volt));
    TEST_ASSERT_EQUAL_FLOAT(0.65f, volt);
}

static void a_board_without_a_reference_takes_the_one_of_the_settings(void)
{
    float volt;
    settings.reference = 3.3f;
    TEST_ASSERT_TRUE(analog_input_kind.value(&settings, (const int32_t[3]){65535}, &volt));
    TEST_ASSERT_EQUAL_FLOAT(3.3f, volt);
    settings.reference = 0;
    TEST_ASSERT_FALSE(analog_input_kind.value(&settings, (const int32_t[3]){65535}, &volt));
}

static void the_first_conversion_is_waited_for(void)
{
    script_board.analog_code = 100;
    begin(&analog_input_kind, 100);
    script_run(&d, 10);
    TEST_ASSERT_EQUAL(0, script_result(&d).number);
    script_board.analog_ready = true;
    script_run(&d, 10);
    TEST_ASSERT_EQUAL(1, script_result(&d).number);
    TEST_ASSERT_EQUAL_HEX16(0, script_result(&d).faults);
}

static void no_conversion_is_a_fault(void)
{
    begin(&analog_input_kind, 100);
    script_run(&d, 50);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_BUS, script_result(&d).faults);
}

static void a_code_at_its_upper_end_is_out_of_range(void)
{
    script_board.analog_ready = true;
    script_board.analog_code = 65535;
    begin(&analog_input_kind, 100);
    script_run(&d, 10);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_RANGE, script_result(&d).faults);
}

/* ---- flow ---- */

static void flow_is_pulses_in_a_second(void)
{
    script_board.pulses = 4000000000u;
    settings.type = 5;
    begin(&flow_kind, 500);
    TEST_ASSERT_EQUAL(5, script_board.dead_ms);
    script_run(&d, 400);
    TEST_ASSERT_EQUAL(0, script_result(&d).number);
    script_board.pulses += 30;
    script_run(&d, 101);
    struct device_result r = script_result(&d);
    TEST_ASSERT_EQUAL(1, r.number);
    float value;
    TEST_ASSERT_TRUE(flow_kind.value(&settings, r.code, &value));
    TEST_ASSERT_EQUAL_FLOAT(60, value);
    TEST_ASSERT_EQUAL(1500, r.stamp_ms);
    script_run(&d, 500);
    r = script_result(&d);
    TEST_ASSERT_EQUAL(2, r.number);
    TEST_ASSERT_TRUE(flow_kind.value(&settings, r.code, &value));
    TEST_ASSERT_EQUAL_FLOAT(0, value);
}

static void the_count_of_pulses_wraps_without_a_trace(void)
{
    script_board.pulses = UINT32_MAX - 9;
    begin(&flow_kind, 500);
    script_run(&d, 100);
    script_board.pulses += 30;
    script_run(&d, 401);
    TEST_ASSERT_EQUAL(30, script_result(&d).code[0]);
    TEST_ASSERT_EQUAL(30, script_result(&d).code[2]);
    script_board.pulses += 12;
    script_run(&d, 500);
    TEST_ASSERT_EQUAL(12, script_result(&d).code[0]);
    TEST_ASSERT_EQUAL(42, script_result(&d).code[2]);
}

static void pulses_are_a_number_that_begins_anew_after_65535(void)
{
    float value;
    script_board.pulses = 7;
    begin(&pulses_kind, 500);
    script_run(&d, 100);
    script_board.pulses += 900;
    script_run(&d, 401);
    struct device_result r = script_result(&d);
    TEST_ASSERT_TRUE(pulses_kind.value(&settings, r.code, &value));
    TEST_ASSERT_EQUAL_FLOAT(900, value);
    TEST_ASSERT_TRUE(pulses_kind.value(&settings, (const int32_t[3]){1, 1, 65535}, &value));
    TEST_ASSERT_EQUAL_FLOAT(65535, value);
    TEST_ASSERT_TRUE(pulses_kind.value(&settings, (const int32_t[3]){1, 1, 65536 * 5 + 3}, &value));
    TEST_ASSERT_EQUAL_FLOAT(3, value);
}

static void more_pulses_than_a_pin_can_count_are_out_of_range(void)
{
    begin(&flow_kind, 500);
    script_run(&d, 100);
    script_board.pulses += 1001; /* 2000 a second and one */
    script_run(&d, 401);
    TEST_ASSERT_EQUAL_HEX16(0, script_result(&d).faults);
    script_board.pulses += 1002;
    script_run(&d, 500);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_RANGE, script_result(&d).faults);
}

static void a_flow_without_time_is_none(void)
{
    float value;
    TEST_ASSERT_FALSE(flow_kind.value(&settings, (const int32_t[3]){5, 0, 7}, &value));
}

/* ---- level ---- */

static float level(void)
{
    float value = -1;
    struct device_result r = script_result(&d);
    TEST_ASSERT_TRUE(level_kind.value(&settings, r.code, &value));
    return value;
}

static void a_closed_contact_is_1(void)
{
    begin(&level_kind, 50);
    TEST_ASSERT_EQUAL(PIN, script_board.pulled_up);
    script_run(&d, 10);
    TEST_ASSERT_EQUAL(0, script_result(&d).number);
    script_run(&d, 90);
    TEST_ASSERT_GREATER_THAN(0, script_result(&d).number);
    TEST_ASSERT_EQUAL_FLOAT(1, level());
    script_board.level[PIN] = true;
    script_run(&d, 100);
    TEST_ASSERT_EQUAL_FLOAT(0, level());
}

static void an_open_contact_can_be_1_as_well(void)
{
    settings.type = 1;
    script_board.level[PIN] = true;
    begin(&level_kind, 50);
    script_run(&d, 100);
    TEST_ASSERT_EQUAL_FLOAT(1, level());
}

static void a_bouncing_contact_keeps_its_state(void)
{
    begin(&level_kind, 50);
    script_run(&d, 100);
    for (unsigned k = 0; k < 20; k++) {
        script_board.level[PIN] = !script_board.level[PIN];
        script_run(&d, 10);
        TEST_ASSERT_EQUAL_FLOAT(1, level());
    }
}

static void a_change_counts_after_20_ms(void)
{
    begin(&level_kind, 50);
    script_run(&d, 200);
    script_board.level[PIN] = true;
    script_run(&d, 15);
    script_board.level[PIN] = false;
    script_run(&d, 200);
    TEST_ASSERT_EQUAL_FLOAT(1, level());
    TEST_ASSERT_EQUAL_HEX16(0, script_result(&d).faults);
    script_board.level[PIN] = true;
    script_run(&d, LEVEL_STEADY_MS + 2 + 50);
    TEST_ASSERT_EQUAL_FLOAT(0, level());
}

static void results_come_in_the_interval(void)
{
    begin(&level_kind, 200);
    script_run(&d, 1100);
    TEST_ASSERT_EQUAL(6, script_result(&d).number);
}

/* ---- all ---- */

static void pins_that_are_not_free_are_refused(void)
{
    script_board.pin_used = true;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &analog_input_kind, &settings, 0));
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &flow_kind, &settings, 0));
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &level_kind, &settings, 0));
    script_board.pin_used = false;
    settings.type = 2;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &level_kind, &settings, 0));
}

static void every_kind_is_found_by_its_name(void)
{
    const char *before = "";
    for (unsigned k = 0; k < DEVICE_KINDS; k++) {
        const struct device_kind *kind = device_kind_at(k);
        TEST_ASSERT_EQUAL_PTR(kind, device_kind_find(kind->name));
        TEST_ASSERT_LESS_THAN(0, strcmp(before, kind->name));
        TEST_ASSERT_LESS_THAN(CHANNEL_UNIT_SIZE, strlen(kind->unit));
        TEST_ASSERT_NOT_NULL(kind->open);
        TEST_ASSERT_NOT_NULL(kind->step);
        TEST_ASSERT_NOT_NULL(kind->value);
        TEST_ASSERT_GREATER_THAN(0, kind->interval_ms);
        before = kind->name;
    }
    TEST_ASSERT_NULL(device_kind_at(DEVICE_KINDS));
    TEST_ASSERT_NULL(device_kind_find("max3186"));
    TEST_ASSERT_NULL(device_kind_find(""));
}

static void every_fault_has_words_of_its_own(void)
{
    TEST_ASSERT_EQUAL_STRING("", device_fault_text(0));
    for (unsigned bit = 0; 1u << bit < DEVICE_BUS; bit++) {
        uint16_t fault = (uint16_t)(1u << bit);
        TEST_ASSERT_NOT_EQUAL('\0', device_fault_text(fault)[0]);
        TEST_ASSERT_NOT_EQUAL(
            0, strcmp(device_fault_text(fault), device_fault_text((uint16_t)(fault << 1))));
    }
    TEST_ASSERT_EQUAL_STRING("sensor or wire open", device_fault_text(DEVICE_OPEN));
    TEST_ASSERT_EQUAL_STRING("bus failed", device_fault_text(DEVICE_BUS));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_analogue_input_is_a_voltage_of_the_boards_reference);
    RUN_TEST(a_board_without_a_reference_takes_the_one_of_the_settings);
    RUN_TEST(the_first_conversion_is_waited_for);
    RUN_TEST(no_conversion_is_a_fault);
    RUN_TEST(a_code_at_its_upper_end_is_out_of_range);
    RUN_TEST(flow_is_pulses_in_a_second);
    RUN_TEST(the_count_of_pulses_wraps_without_a_trace);
    RUN_TEST(pulses_are_a_number_that_begins_anew_after_65535);
    RUN_TEST(more_pulses_than_a_pin_can_count_are_out_of_range);
    RUN_TEST(a_flow_without_time_is_none);
    RUN_TEST(a_closed_contact_is_1);
    RUN_TEST(an_open_contact_can_be_1_as_well);
    RUN_TEST(a_bouncing_contact_keeps_its_state);
    RUN_TEST(a_change_counts_after_20_ms);
    RUN_TEST(results_come_in_the_interval);
    RUN_TEST(pins_that_are_not_free_are_refused);
    RUN_TEST(every_kind_is_found_by_its_name);
    RUN_TEST(every_fault_has_words_of_its_own);
    return UNITY_END();
}
