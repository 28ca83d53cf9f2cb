/* MAX31865: its traffic byte by byte, each fault, and what loses it. Thresholds of a PT100 with 400 ohm: 3.90481 x 8192 = 31988 (F9E8h as
 * the register has it) and 0.1852 x 8192 = 1517 (0BDAh).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include <stdio.h>
#include <stdlib.h>

#include "devices/max31865/max31865.h"
#include "scripted_bus.h"
#include "unity.h"

#define THRESHOLDS "F9 E8 0B DA"

static struct device d;
static struct device_settings settings;

void setUp(void)
{
    script_clear();
    settings = (struct device_settings){
        .bus = 1, .select = HAL_PIN('A', 4), .type = 4, .nominal = 100, .reference = 400};
}
void tearDown(void) {}

static void begin(uint16_t interval_ms)
{
    TEST_ASSERT_EQUAL(ERR_OK, device_open(&d, &max31865_kind, &settings, interval_ms));
}

static void write_thresholds(void)
{
    script("83 " THRESHOLDS, "");
}

static void convert(void)
{
    script("80 83", "");
    script("80 85", "");
    script("80 A1", "");
    script("00", "A1"); /* it converts */
}

/* Both reads give the same. */
static void read_pair(const char *registers)
{
    script("00", registers);
    script("00", registers);
}

static void bias_off(void)
{
    script("80 03", "");
}

/* A whole cycle with these bytes of configuration and ratio, and fault register. */
static void cycle(const char *config_and_ratio, const char *fault)
{
    char registers[64];
    snprintf(registers, sizeof registers, "%s " THRESHOLDS " %s", config_and_ratio, fault);
    convert();
    read_pair(registers);
    bias_off();
}

static void expect_faults(uint32_t number, uint16_t faults)
{
    struct device_result r = script_result(&d);
    script_is_done();
    TEST_ASSERT_EQUAL(number, r.number);
    TEST_ASSERT_EQUAL_HEX16(faults, r.faults);
}

static void a_reading_is_one_shot_between_bias_on_and_off(void)
{
    write_thresholds();
    cycle("81 58 A4", "00");
    begin(1000);
    script_run(&d, 200);
    expect_faults(1, 0);
    struct device_result r = script_result(&d);
    TEST_ASSERT_EQUAL(11346, r.code[0]);
    TEST_ASSERT_EQUAL(0, r.code[1]);
    TEST_ASSERT_EQUAL(script_began_ms(3), r.stamp_ms);
    float t;
    TEST_ASSERT_TRUE(max31865_kind.value(&settings, r.code, &t));
    TEST_ASSERT_FLOAT_WITHIN(0.04f, 100, t);
    TEST_ASSERT_EQUAL(HAL_PIN('A', 4), script_seen.spi.select);
    TEST_ASSERT_EQUAL(1, script_seen.spi.mode & 1); /* mode 1 or 3 */
    TEST_ASSERT_LESS_OR_EQUAL(5000000, script_seen.spi.hz);
}

static void the_conversion_has_the_time_that_it_needs(void)
{
    write_thresholds();
    cycle("81 58 A4", "00");
    begin(1000);
    script_run(&d, 200);
    TEST_ASSERT_GREATER_OR_EQUAL(2, script_began_ms(2) - script_began_ms(1)); /* bias settles */
    TEST_ASSERT_GREATER_OR_EQUAL(2, script_began_ms(3) - script_began_ms(2));
    TEST_ASSERT_GREATER_OR_EQUAL(67, script_began_ms(5) - script_began_ms(3));
    TEST_ASSERT_LESS_THAN(100, script_began_ms(7) - script_began_ms(0));
}

static void thresholds_are_written_once(void)
{
    write_thresholds();
    cycle("81 58 A4", "00");
    cycle("81 58 A6", "00");
    begin(500);
    script_run(&d, 700);
    expect_faults(2, 0);
    TEST_ASSERT_EQUAL(11347, script_result(&d).code[0]);
    TEST_ASSERT_EQUAL(500, script_began_ms(8) - script_began_ms(0));
}

static void three_wires_and_60_hz_are_bits_of_the_configuration(void)
{
    settings.type = 3;
    settings.mains_60 = true;
    write_thresholds();
    script("80 92", "");
    script("80 94", "");
    script("80 B0", "");
    script("00", "B0");
    read_pair("90 40 00 " THRESHOLDS " 00");
    script("80 12", "");
    begin(1000);
    script_run(&d, 200);
    expect_faults(1, 0);
    TEST_ASSERT_EQUAL(8192, script_result(&d).code[0]);
}

static void two_wires_are_four_to_the_chip(void)
{
    settings.type = 2;
    write_thresholds();
    cycle("81 58 A4", "00");
    begin(1000);
    script_run(&d, 200);
    expect_faults(1, 0);
}

static void thresholds_follow_the_reference_resistor(void)
{
    settings.nominal = 1000;
    settings.reference = 4300; /* 3.90481 x 7620.47 = 29756, 0.1852 x 7620.47 = 1411 */
    script("83 E8 78 0B 06", "");
    script_fails("80 83", 0, TRANSFER_FAILED);
    begin(1000);
    script_run(&d, 100);
    expect_faults(1, DEVICE_BUS);
}

static void each_bit_of_the_fault_register_is_told(void)
{
    static const struct {
        const char *config_and_ratio, *fault;
        uint16_t faults;
    } rows[] = {
        {"81 FF FF", "80", DEVICE_OPEN},    {"81 FF FF", "A0", DEVICE_OPEN},
        {"81 58 A5", "20", DEVICE_OPEN},    {"81 FF FF", "A8", DEVICE_OPEN},
        {"81 00 03", "40", DEVICE_SHORT},   {"81 00 03", "48", DEVICE_SHORT},
        {"81 58 A5", "10", DEVICE_VOLTAGE}, {"81 58 A5", "08", DEVICE_VOLTAGE},
        {"81 58 A5", "04", DEVICE_VOLTAGE}, {"81 FF FF", "84", DEVICE_OPEN | DEVICE_VOLTAGE},
    };
    unsigned n = sizeof rows / sizeof rows[0];
    write_thresholds();
    for (unsigned k = 0; k < n; k++)
        cycle(rows[k].config_and_ratio, rows[k].fault);
    begin(100);
    for (unsigned k = 0; k < n; k++) {
        script_run(&d, 100);
        struct device_result r = script_result(&d);
        TEST_ASSERT_EQUAL(k + 1, r.number);
        TEST_ASSERT_EQUAL_HEX16_MESSAGE(rows[k].faults, r.faults, rows[k].fault);
        TEST_ASSERT_EQUAL_HEX8(strtoul(rows[k].fault, NULL, 16), r.code[1]);
    }
}

static void a_chip_that_lost_its_settings_is_told_and_set_up_again(void)
{
    write_thresholds();
    cycle("81 58 A4", "00");
    convert(); /* power is gone here and comes back: registers of power-on */
    read_pair("00 00 00 FF FF 00 00 00");
    bias_off();
    write_thresholds();
    cycle("81 58 A4", "00");
    begin(200);
    script_run(&d, 200);
    TEST_ASSERT_EQUAL_HEX16(0, script_result(&d).faults);
    script_run(&d, 200);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_POWER_ON, script_result(&d).faults);
    script_run(&d, 200);
    expect_faults(3, 0);
}

static void another_chip_is_told(void)
{
    write_thresholds();
    convert();
    read_pair("81 58 A4 12 34 56 78 00");
    bias_off();
    write_thresholds();
    convert();
    read_pair("C1 58 A4 " THRESHOLDS " 00"); /* converts by itself, which nobody has set */
    bias_off();
    begin(200);
    script_run(&d, 200);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_WRONG_CHIP, script_result(&d).faults);
    script_run(&d, 200);
    expect_faults(2, DEVICE_WRONG_CHIP);
}

static void a_chip_that_is_not_there_is_told_and_waited_for(void)
{
    write_thresholds();
    convert();
    read_pair("FF FF FF FF FF FF FF FF");
    bias_off();
    write_thresholds();
    convert();
    read_pair("00 00 00 00 00 00 00 00");
    bias_off();
    write_thresholds();
    cycle("81 58 A4", "00");
    begin(200);
    script_run(&d, 200);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_NO_CHIP, script_result(&d).faults);
    script_run(&d, 200);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_NO_CHIP, script_result(&d).faults);
    script_run(&d, 200);
    expect_faults(3, 0);
}

static void two_reads_that_differ_are_read_again(void)
{
    write_thresholds();
    convert();
    script("00", "81 58 A4 " THRESHOLDS " 00");
    script("00", "81 18 A4 " THRESHOLDS " 00");
    read_pair("81 58 A4 " THRESHOLDS " 00");
    bias_off();
    begin(200);
    script_run(&d, 150);
    expect_faults(1, 0);
    TEST_ASSERT_EQUAL(11346, script_result(&d).code[0]);
}

static void reads_that_never_agree_are_a_checksum_fault(void)
{
    write_thresholds();
    convert();
    for (unsigned k = 0; k < 4; k++) {
        script("00", "81 58 A4 " THRESHOLDS " 00");
        script("00", "81 18 A4 " THRESHOLDS " 00");
    }
    bias_off();
    begin(200);
    script_run(&d, 150);
    expect_faults(1, DEVICE_CHECKSUM);
}

static void a_slow_conversion_is_waited_for(void)
{
    write_thresholds();
    convert();
    read_pair("A1 12 34 " THRESHOLDS " 00");
    read_pair("81 58 A4 " THRESHOLDS " 00");
    bias_off();
    begin(200);
    script_run(&d, 150);
    expect_faults(1, 0);
    TEST_ASSERT_EQUAL(11346, script_result(&d).code[0]);
}

/* The chip waits with its conversion until the voltage is gone. */
static void a_voltage_that_holds_the_conversion_up_is_told_as_such(void)
{
    write_thresholds();
    convert();
    read_pair("A1 12 35 " THRESHOLDS " 04");
    bias_off();
    begin(200);
    script_run(&d, 150);
    expect_faults(1, DEVICE_VOLTAGE);
}

static void a_conversion_without_an_end_is_a_wrong_chip(void)
{
    write_thresholds();
    convert();
    for (unsigned k = 0; k < 4; k++)
        read_pair("A1 12 34 " THRESHOLDS " 00");
    bias_off();
    begin(200);
    script_run(&d, 150);
    expect_faults(1, DEVICE_WRONG_CHIP);
}

/* In each place of the cycle. */
static void a_transfer_that_does_not_end_is_stopped(void)
{
    static const struct {
        const char *out, *in;
        unsigned n_in;
    } sent[] = {{"83 " THRESHOLDS, "", 0},
                {"80 83", "", 0},
                {"80 85", "", 0},
                {"80 A1", "", 0},
                {"00", "A1", 1},
                {"00", "81 58 A4 " THRESHOLDS " 00", 8},
                {"00", "81 58 A4 " THRESHOLDS " 00", 8},
                {"80 03", "", 0}};
    for (unsigned k = 0; k < sizeof sent / sizeof sent[0]; k++) {
        script_clear();
        for (unsigned i = 0; i < k; i++)
            script(sent[i].out, sent[i].in);
        script_fails(sent[k].out, sent[k].n_in, SCRIPT_NEVER_ENDS);
        begin(200);
        script_run(&d, 190);
        expect_faults(1, DEVICE_BUS);
        TEST_ASSERT_EQUAL(1, script_seen.stops);
        TEST_ASSERT_EQUAL(0, script_result(&d).code[0]);
        TEST_ASSERT_EQUAL(script_began_ms(k > 2 ? 3 : 0), script_result(&d).stamp_ms);
    }
}

/* The bit that starts was lost on its way: the ratio would be that of the conversion before. */
static void a_conversion_that_has_not_begun_is_begun_again(void)
{
    write_thresholds();
    cycle("81 58 A4", "00");
    script("80 83", "");
    script("80 85", "");
    script("80 A1", "");
    script("00", "81");
    script("80 A1", "");
    script("00", "A1");
    read_pair("81 58 A6 " THRESHOLDS " 00");
    bias_off();
    begin(200);
    script_run(&d, 390);
    expect_faults(2, 0);
    TEST_ASSERT_EQUAL(11347, script_result(&d).code[0]);
}

static void conversions_that_begin_no_more_are_a_wrong_chip(void)
{
    write_thresholds();
    cycle("81 58 A4", "00");
    script("80 83", "");
    script("80 85", "");
    for (unsigned k = 0; k < 4; k++) {
        script("80 A1", "");
        script("00", "81");
    }
    bias_off();
    begin(200);
    script_run(&d, 290);
    expect_faults(2, DEVICE_WRONG_CHIP);
}

/* The data sheet does not say when the bit clears itself. */
static void a_chip_that_never_shows_that_it_converts_is_believed(void)
{
    write_thresholds();
    for (unsigned k = 0; k < 2; k++) {
        script("80 83", "");
        script("80 85", "");
        script("80 A1", "");
        script("00", "81");
        read_pair("81 58 A4 " THRESHOLDS " 00");
        bias_off();
    }
    begin(200);
    script_run(&d, 390);
    expect_faults(2, 0);
}

static void settings_that_the_chip_cannot_have_are_refused(void)
{
    const struct device_settings good = settings;
    settings.type = 1;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &max31865_kind, &settings, 0));
    settings = good;
    settings.type = 5;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &max31865_kind, &settings, 0));
    settings = good;
    settings.reference = 390;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &max31865_kind, &settings, 0));
    settings.reference = 4000;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &max31865_kind, &settings, 0));
    settings = good;
    settings.nominal = 0;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &max31865_kind, &settings, 0));
    settings = good;
    settings.select = HAL_PIN_NONE;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &max31865_kind, &settings, 0));
    settings = good;
    script_board.no_bus = true;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &max31865_kind, &settings, 0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_reading_is_one_shot_between_bias_on_and_off);
    RUN_TEST(the_conversion_has_the_time_that_it_needs);
    RUN_TEST(thresholds_are_written_once);
    RUN_TEST(three_wires_and_60_hz_are_bits_of_the_configuration);
    RUN_TEST(two_wires_are_four_to_the_chip);
    RUN_TEST(thresholds_follow_the_reference_resistor);
    RUN_TEST(each_bit_of_the_fault_register_is_told);
    RUN_TEST(a_chip_that_lost_its_settings_is_told_and_set_up_again);
    RUN_TEST(another_chip_is_told);
    RUN_TEST(a_chip_that_is_not_there_is_told_and_waited_for);
    RUN_TEST(two_reads_that_differ_are_read_again);
    RUN_TEST(reads_that_never_agree_are_a_checksum_fault);
    RUN_TEST(a_slow_conversion_is_waited_for);
    RUN_TEST(a_voltage_that_holds_the_conversion_up_is_told_as_such);
    RUN_TEST(a_conversion_without_an_end_is_a_wrong_chip);
    RUN_TEST(a_transfer_that_does_not_end_is_stopped);
    RUN_TEST(a_conversion_that_has_not_begun_is_begun_again);
    RUN_TEST(conversions_that_begin_no_more_are_a_wrong_chip);
    RUN_TEST(a_chip_that_never_shows_that_it_converts_is_believed);
    RUN_TEST(settings_that_the_chip_cannot_have_are_refused);
    return UNITY_END();
}
