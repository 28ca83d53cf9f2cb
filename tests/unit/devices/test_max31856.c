/* MAX31856: traffic byte by byte, types, each fault.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include <stdlib.h>
#include <string.h>

#include "devices/max31856/max31856.h"
#include "scripted_bus.h"
#include "unity.h"

/* Registers 03h to 09h. */
#define THRESHOLDS "55 EC 7F FF 80 00 00"
#define SET_UP     "80 11 03 00 " THRESHOLDS
/* Registers 00h to 09h after a conversion. */
#define SETTINGS "11 03 00 " THRESHOLDS
/* Cold junction 25.25 degC: 064Ch x 2^-6 left-justified, thermocouple 100.5 degC: 12864 x 2^-7 in 19 bits left-justified. */
#define VALUES "19 40 06 48 00"

static struct device d;
static struct device_settings settings;

void setUp(void)
{
    script_clear();
    settings = (struct device_settings){.bus = 1, .select = HAL_PIN('A', 4), .type = 'K'};
}
void tearDown(void) {}

static void begin(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, device_open(&d, &max31856_kind, &settings, 500));
}

static void convert(void)
{
    script("80 51", "");
    script("00", "51"); /* it converts */
}

static void read_pair(const char *registers)
{
    script("00", registers);
    script("00", registers);
}

static struct device_result after_cycle(void)
{
    script_run(&d, 500);
    script_is_done();
    return script_result(&d);
}

static float value_of(const struct device_result *r)
{
    float t = -1000;
    TEST_ASSERT_TRUE(max31856_kind.value(&settings, r->code, &t));
    return t;
}

static void a_reading_is_one_shot_and_one_burst_read_twice(void)
{
    script(SET_UP, "");
    convert();
    read_pair(SETTINGS " " VALUES " 00");
    begin();
    struct device_result r = after_cycle();
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    TEST_ASSERT_EQUAL_FLOAT(100.5f, value_of(&r));
    TEST_ASSERT_EQUAL(25 * 64 + 16, r.code[1]);
    TEST_ASSERT_EQUAL_HEX8(0, r.code[2]);
    TEST_ASSERT_EQUAL(1, script_seen.spi.mode & 1);
    TEST_ASSERT_LESS_OR_EQUAL(5000000, script_seen.spi.hz);
    TEST_ASSERT_EQUAL(script_began_ms(1), r.stamp_ms);
    TEST_ASSERT_GREATER_OR_EQUAL(226, script_began_ms(3) - script_began_ms(1));
}

static void set_up_is_written_once(void)
{
    script(SET_UP, "");
    for (unsigned k = 0; k < 2; k++) {
        convert();
        read_pair(SETTINGS " " VALUES " 00");
    }
    begin();
    script_run(&d, 500);
    TEST_ASSERT_EQUAL(2, after_cycle().number);
}

static void temperatures_below_0_have_a_sign(void)
{
    script(SET_UP, "");
    convert();
    read_pair(SETTINGS " F6 00 FF FF E0 00"); /* -10 and -0.0078125 degC */
    begin();
    struct device_result r = after_cycle();
    TEST_ASSERT_EQUAL_FLOAT(-0.0078125f, value_of(&r));
    TEST_ASSERT_EQUAL(-10 * 64, r.code[1]);
}

static void each_type_has_its_number_and_its_range(void)
{
    static const struct {
        char letter;
        const char *set_up, *settings;
        int lo, hi;
    } rows[] = {
        {'B', "80 11 00 00 " THRESHOLDS, "11 00 00 " THRESHOLDS " " VALUES " 00", 250, 1820},
        {'E', "80 11 01 00 " THRESHOLDS, "11 01 00 " THRESHOLDS " " VALUES " 00", -200, 1000},
        {'J', "80 11 02 00 " THRESHOLDS, "11 02 00 " THRESHOLDS " " VALUES " 00", -210, 1200},
        {'K', "80 11 03 00 " THRESHOLDS, "11 03 00 " THRESHOLDS " " VALUES " 00", -200, 1372},
        {'N', "80 11 04 00 " THRESHOLDS, "11 04 00 " THRESHOLDS " " VALUES " 00", -200, 1300},
        {'R', "80 11 05 00 " THRESHOLDS, "11 05 00 " THRESHOLDS " " VALUES " 00", -50, 1768},
        {'S', "80 11 06 00 " THRESHOLDS, "11 06 00 " THRESHOLDS " " VALUES " 00", -50, 1768},
        {'T', "80 11 07 00 " THRESHOLDS, "11 07 00 " THRESHOLDS " " VALUES " 00", -200, 400},
    };
    for (unsigned k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        setUp();
        settings.type = (uint8_t)rows[k].letter;
        script(rows[k].set_up, "");
        convert();
        read_pair(rows[k].settings);
        begin();
        TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
        float t;
        int32_t code[DEVICE_CODES] = {rows[k].lo * 128};
        TEST_ASSERT_TRUE(max31856_kind.value(&settings, code, &t));
        TEST_ASSERT_EQUAL_FLOAT((float)rows[k].lo, t);
        code[0]--;
        TEST_ASSERT_FALSE(max31856_kind.value(&settings, code, &t));
        code[0] = rows[k].hi * 128;
        TEST_ASSERT_TRUE(max31856_kind.value(&settings, code, &t));
        code[0]++;
        TEST_ASSERT_FALSE(max31856_kind.value(&settings, code, &t));
    }
}

static void mains_of_60_hz_are_a_bit_and_less_time(void)
{
    settings.mains_60 = true;
    script("80 10 03 00 " THRESHOLDS, "");
    script("80 50", "");
    script("00", "50");
    read_pair("10 03 00 " THRESHOLDS " " VALUES " 00");
    begin();
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
    TEST_ASSERT_GREATER_OR_EQUAL(196, script_began_ms(3) - script_began_ms(1));
}

static void each_bit_of_the_fault_register_is_told(void)
{
    static const struct {
        const char *registers;
        uint16_t faults;
    } rows[] = {
        {SETTINGS " " VALUES " 01", DEVICE_OPEN},
        {SETTINGS " " VALUES " 02", DEVICE_VOLTAGE},
        {SETTINGS " " VALUES " 04", DEVICE_RANGE},
        {SETTINGS " " VALUES " 08", DEVICE_RANGE},
        {SETTINGS " " VALUES " 10", DEVICE_COLD_JUNCTION},
        {SETTINGS " " VALUES " 20", DEVICE_COLD_JUNCTION},
        {SETTINGS " " VALUES " 40", DEVICE_RANGE},
        {SETTINGS " " VALUES " 80", DEVICE_COLD_JUNCTION},
        {SETTINGS " " VALUES " 41", DEVICE_OPEN},
        {SETTINGS " " VALUES " 42", DEVICE_VOLTAGE},
        {SETTINGS " " VALUES " 81", DEVICE_OPEN | DEVICE_COLD_JUNCTION},
    };
    script(SET_UP, "");
    begin();
    for (unsigned k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        convert();
        read_pair(rows[k].registers);
        struct device_result r = after_cycle();
        TEST_ASSERT_EQUAL_HEX16_MESSAGE(rows[k].faults, r.faults, rows[k].registers);
        TEST_ASSERT_EQUAL_HEX8(strtoul(strrchr(rows[k].registers, ' '), NULL, 16), r.code[2]);
    }
}

static void a_chip_that_lost_its_settings_is_told_and_set_up_again(void)
{
    script(SET_UP, "");
    convert();
    read_pair(SETTINGS " " VALUES " 00");
    begin();
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
    /* Power was gone before the conversion. Its type is K again by chance. */
    convert();
    read_pair("11 03 FF 7F C0 7F FF 80 00 00 " VALUES " 00");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_POWER_ON, after_cycle().faults);
    script(SET_UP, "");
    convert();
    read_pair(SETTINGS " " VALUES " 00");
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
}

static void another_type_or_offset_is_a_wrong_chip(void)
{
    begin();
    script(SET_UP, "");
    convert();
    read_pair("11 02 00 " THRESHOLDS " " VALUES " 00");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_WRONG_CHIP, after_cycle().faults);
    script(SET_UP, "");
    convert();
    read_pair("11 03 00 55 EC 7F FF 80 00 10 " VALUES " 00");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_WRONG_CHIP, after_cycle().faults);
}

/* The upper bits of the mask have no meaning, and may be either. */
static void upper_bits_of_the_mask_do_not_count(void)
{
    begin();
    script(SET_UP, "");
    convert();
    read_pair("11 03 C0 " THRESHOLDS " " VALUES " 00");
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
}

static void a_chip_that_is_not_there_is_told(void)
{
    begin();
    script(SET_UP, "");
    convert();
    read_pair("00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_NO_CHIP, after_cycle().faults);
    script(SET_UP, "");
    convert();
    read_pair("FF FF FF FF FF FF FF FF FF FF FF FF FF FF FF FF");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_NO_CHIP, after_cycle().faults);
}

static void reads_that_differ_are_read_again(void)
{
    begin();
    script(SET_UP, "");
    convert();
    script("00", SETTINGS " " VALUES " 00");
    script("00", SETTINGS " 19 40 26 48 00 00");
    read_pair(SETTINGS " " VALUES " 00");
    struct device_result r = after_cycle();
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    TEST_ASSERT_EQUAL_FLOAT(100.5f, value_of(&r));
}

static void reads_that_never_agree_are_a_checksum_fault(void)
{
    begin();
    script(SET_UP, "");
    convert();
    for (unsigned k = 0; k < 4; k++) {
        script("00", SETTINGS " " VALUES " 00");
        script("00", SETTINGS " 19 40 26 48 00 00");
    }
    TEST_ASSERT_EQUAL_HEX16(DEVICE_CHECKSUM, after_cycle().faults);
}

static void a_slow_conversion_is_waited_for(void)
{
    begin();
    script(SET_UP, "");
    convert();
    read_pair("51 03 00 " THRESHOLDS " 19 40 01 00 00 00");
    read_pair(SETTINGS " " VALUES " 00");
    struct device_result r = after_cycle();
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    TEST_ASSERT_EQUAL_FLOAT(100.5f, value_of(&r));
}

/* The chip waits with its conversion until the voltage is gone. */
static void a_voltage_that_holds_the_conversion_up_is_told_as_such(void)
{
    begin();
    script(SET_UP, "");
    convert();
    read_pair("51 03 00 " THRESHOLDS " " VALUES " 02");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_VOLTAGE, after_cycle().faults);
}

static void a_conversion_without_an_end_is_a_wrong_chip(void)
{
    begin();
    script(SET_UP, "");
    convert();
    for (unsigned k = 0; k < 4; k++)
        read_pair("51 03 00 " THRESHOLDS " " VALUES " 00");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_WRONG_CHIP, after_cycle().faults);
}

static void a_transfer_that_does_not_end_is_stopped(void)
{
    begin();
    script(SET_UP, "");
    script_fails("80 51", 0, SCRIPT_NEVER_ENDS);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_BUS, after_cycle().faults);
    TEST_ASSERT_EQUAL(1, script_seen.stops);
    script(SET_UP, "");
    convert();
    script_fails("00", 16, SCRIPT_NEVER_ENDS);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_BUS, after_cycle().faults);
    TEST_ASSERT_EQUAL(2, script_seen.stops);
}

/* The bit that starts was lost on its way: the temperature would be that of the conversion before. */
static void a_conversion_that_has_not_begun_is_begun_again(void)
{
    begin();
    script(SET_UP, "");
    convert();
    read_pair(SETTINGS " " VALUES " 00");
    after_cycle();
    script("80 51", "");
    script("00", "11");
    convert();
    read_pair(SETTINGS " " VALUES " 00");
    struct device_result r = after_cycle();
    TEST_ASSERT_EQUAL(2, r.number);
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
}

static void conversions_that_begin_no_more_are_a_wrong_chip(void)
{
    begin();
    script(SET_UP, "");
    convert();
    read_pair(SETTINGS " " VALUES " 00");
    after_cycle();
    for (unsigned k = 0; k < 4; k++) {
        script("80 51", "");
        script("00", "11");
    }
    TEST_ASSERT_EQUAL_HEX16(DEVICE_WRONG_CHIP, after_cycle().faults);
}

/* The data sheet does not say when the bit clears itself. */
static void a_chip_that_never_shows_that_it_converts_is_believed(void)
{
    begin();
    script(SET_UP, "");
    for (unsigned k = 0; k < 2; k++) {
        script("80 51", "");
        script("00", "11");
        read_pair(SETTINGS " " VALUES " 00");
        TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
    }
}

static void settings_that_the_chip_cannot_have_are_refused(void)
{
    settings.type = 'A';
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &max31856_kind, &settings, 0));
    settings.type = 0;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &max31856_kind, &settings, 0));
    settings.type = 'T';
    settings.select = HAL_PIN_NONE;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &max31856_kind, &settings, 0));
    settings.select = HAL_PIN('A', 4);
    script_board.no_bus = true;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &max31856_kind, &settings, 0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_reading_is_one_shot_and_one_burst_read_twice);
    RUN_TEST(set_up_is_written_once);
    RUN_TEST(temperatures_below_0_have_a_sign);
    RUN_TEST(each_type_has_its_number_and_its_range);
    RUN_TEST(mains_of_60_hz_are_a_bit_and_less_time);
    RUN_TEST(each_bit_of_the_fault_register_is_told);
    RUN_TEST(a_chip_that_lost_its_settings_is_told_and_set_up_again);
    RUN_TEST(another_type_or_offset_is_a_wrong_chip);
    RUN_TEST(upper_bits_of_the_mask_do_not_count);
    RUN_TEST(a_chip_that_is_not_there_is_told);
    RUN_TEST(reads_that_differ_are_read_again);
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
