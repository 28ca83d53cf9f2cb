/* ADS1115: traffic byte by byte, four inputs of one chip, each fault.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/ads1115/ads1115.h"
#include "scripted_bus.h"
#include "unity.h"

static struct device d;
static struct device_settings settings;

void setUp(void)
{
    script_clear();
    settings = (struct device_settings){.bus = 1, .address = 0x48, .input = 0, .type = 2};
}
void tearDown(void) {}

static void begin(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, device_open(&d, &ads1115_kind, &settings, 500));
}

/* The write, and the configuration that says that a conversion runs. */
static void start(void)
{
    script("01 C5 23", "");
    script("01", "45 23");
}

/* Input 0, 2.048 V, 16 samples a second, one conversion: C523h. */
static void reading(const char *code, const char *config)
{
    start();
    script("00", code);
    script("00", code);
    script("01", config);
}

static struct device_result after_cycle(void)
{
    script_run(&d, 500);
    script_is_done();
    return script_result(&d);
}

static void a_reading_is_one_conversion_read_twice_and_checked(void)
{
    reading("19 00", "C5 23");
    begin();
    struct device_result r = after_cycle();
    TEST_ASSERT_EQUAL(1, r.number);
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    TEST_ASSERT_EQUAL(6400, r.code[0]); /* 4 mA over 100 ohm */
    float volt;
    TEST_ASSERT_TRUE(ads1115_kind.value(&settings, r.code, &volt));
    TEST_ASSERT_EQUAL_FLOAT(0.4f, volt);
    TEST_ASSERT_EQUAL_HEX8(0x48, script_seen.address);
    TEST_ASSERT_EQUAL(DEVICE_I2C, script_seen.line);
    TEST_ASSERT_GREATER_OR_EQUAL(69, script_began_ms(2) - script_began_ms(0));
    TEST_ASSERT_EQUAL(script_began_ms(0), r.stamp_ms);
}

static void input_and_range_are_bits_of_the_configuration(void)
{
    settings.input = 3;
    settings.type = 0;
    settings.address = 0x4B;
    script("01 F1 23", "");
    script("01", "71 23");
    script("00", "40 00");
    script("00", "40 00");
    script("01", "F1 23");
    begin();
    struct device_result r = after_cycle();
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    float volt;
    TEST_ASSERT_TRUE(ads1115_kind.value(&settings, r.code, &volt));
    TEST_ASSERT_EQUAL_FLOAT(3.072f, volt);
}

static void each_range_has_its_voltage(void)
{
    static const float range[] = {6.144f, 4.096f, 2.048f, 1.024f, 0.512f, 0.256f};
    float volt;
    for (settings.type = 0; settings.type < 6; settings.type++) {
        TEST_ASSERT_TRUE(ads1115_kind.value(&settings, (const int32_t[3]){-16384}, &volt));
        TEST_ASSERT_EQUAL_FLOAT(-range[settings.type] / 2, volt);
    }
    TEST_ASSERT_FALSE(ads1115_kind.value(&settings, (const int32_t[3]){0}, &volt));
}

static void voltages_below_ground_have_a_sign(void)
{
    reading("FF 9C", "C5 23");
    begin();
    float volt;
    struct device_result r = after_cycle();
    TEST_ASSERT_TRUE(ads1115_kind.value(&settings, r.code, &volt));
    TEST_ASSERT_EQUAL_FLOAT(-0.00625f, volt);
}

static void codes_at_an_end_are_out_of_range(void)
{
    reading("7F FF", "C5 23");
    begin();
    TEST_ASSERT_EQUAL_HEX16(DEVICE_RANGE, after_cycle().faults);
    reading("80 00", "C5 23");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_RANGE, after_cycle().faults);
}

static void a_chip_that_lost_power_during_the_conversion_is_told(void)
{
    reading("19 00", "C5 23");
    begin();
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
    reading("00 00", "85 83");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_POWER_ON, after_cycle().faults);
    reading("19 00", "C5 23");
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
}

/* The bit that starts was lost on its way: the conversion register may hold another input's voltage. */
static void a_conversion_that_has_not_begun_is_begun_again(void)
{
    script("01 C5 23", "");
    script("01", "C5 23");
    reading("19 00", "C5 23");
    begin();
    struct device_result r = after_cycle();
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    TEST_ASSERT_EQUAL(script_began_ms(2), r.stamp_ms);
}

static void a_conversion_that_never_begins_is_a_wrong_chip(void)
{
    for (unsigned k = 0; k < 4; k++) {
        script("01 C5 23", "");
        script("01", "C5 23");
    }
    begin();
    TEST_ASSERT_EQUAL_HEX16(DEVICE_WRONG_CHIP, after_cycle().faults);
    for (unsigned k = 0; k < 4; k++) {
        script("01 C5 23", "");
        script("01", "85 83");
    }
    TEST_ASSERT_EQUAL_HEX16(DEVICE_POWER_ON, after_cycle().faults);
}

static void another_configuration_is_a_wrong_chip(void)
{
    reading("19 00", "D5 23"); /* another input */
    begin();
    TEST_ASSERT_EQUAL_HEX16(DEVICE_WRONG_CHIP, after_cycle().faults);
}

static void a_chip_that_is_not_there_is_told(void)
{
    script_fails("01 C5 23", 0, TRANSFER_NO_ANSWER);
    begin();
    TEST_ASSERT_EQUAL_HEX16(DEVICE_NO_CHIP, after_cycle().faults);
}

static void a_transfer_that_does_not_end_is_stopped(void)
{
    start();
    script_fails("00", 2, SCRIPT_NEVER_ENDS);
    begin();
    TEST_ASSERT_EQUAL_HEX16(DEVICE_BUS, after_cycle().faults);
    TEST_ASSERT_EQUAL(1, script_seen.stops);
}

static void reads_that_differ_are_read_again(void)
{
    start();
    script("00", "19 00");
    script("00", "59 00");
    script("01", "C5 23");
    script("00", "19 00");
    script("00", "19 00");
    script("01", "C5 23");
    begin();
    struct device_result r = after_cycle();
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    TEST_ASSERT_EQUAL(6400, r.code[0]);
}

static void reads_that_never_agree_are_a_checksum_fault(void)
{
    start();
    for (unsigned k = 0; k < 4; k++) {
        script("00", "19 00");
        script("00", "59 00");
        script("01", "C5 23");
    }
    begin();
    TEST_ASSERT_EQUAL_HEX16(DEVICE_CHECKSUM, after_cycle().faults);
}

static void a_slow_conversion_is_waited_for(void)
{
    start();
    script("00", "11 11"); /* of the conversion before */
    script("00", "11 11");
    script("01", "45 23");
    script("00", "19 00");
    script("00", "19 00");
    script("01", "C5 23");
    begin();
    struct device_result r = after_cycle();
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    TEST_ASSERT_EQUAL(6400, r.code[0]);
}

static void a_conversion_without_an_end_is_a_wrong_chip(void)
{
    start();
    for (unsigned k = 0; k < 4; k++) {
        script("00", "11 11");
        script("00", "11 11");
        script("01", "45 23");
    }
    begin();
    TEST_ASSERT_EQUAL_HEX16(DEVICE_WRONG_CHIP, after_cycle().faults);
}

static void two_inputs_of_a_chip_are_measured_one_after_the_other(void)
{
    static struct device e;
    struct device *both[] = {&d, &e};
    struct device_settings second = settings;
    second.input = 1;
    begin();
    TEST_ASSERT_EQUAL(ERR_OK, device_open(&e, &ads1115_kind, &second, 500));
    for (unsigned k = 0; k < 2; k++) {
        reading("19 00", "C5 23");
        script("01 D5 23", "");
        script("01", "55 23");
        script("00", "32 00");
        script("00", "32 00");
        script("01", "D5 23");
    }
    script_run_several(both, 2, 1000);
    script_is_done();
    TEST_ASSERT_EQUAL(2, script_result(&d).number);
    TEST_ASSERT_EQUAL(2, script_result(&e).number);
    TEST_ASSERT_EQUAL(6400, script_result(&d).code[0]);
    TEST_ASSERT_EQUAL(12800, script_result(&e).code[0]);
    TEST_ASSERT_EQUAL_HEX16(0, script_result(&e).faults);
}

/* An input of a chip that does not answer must not keep the others off. */
static void a_failed_reading_gives_the_chip_free(void)
{
    static struct device e;
    struct device *both[] = {&d, &e};
    begin();
    TEST_ASSERT_EQUAL(ERR_OK, device_open(&e, &ads1115_kind, &settings, 500));
    script_fails("01 C5 23", 0, TRANSFER_NO_ANSWER);
    reading("19 00", "C5 23");
    script_run_several(both, 2, 200);
    script_is_done();
    TEST_ASSERT_EQUAL_HEX16(DEVICE_NO_CHIP, script_result(&d).faults);
    TEST_ASSERT_EQUAL(6400, script_result(&e).code[0]);
}

/* A chip that converts takes another input's configuration, and goes on with the input that it had. */
static void a_conversion_that_is_given_up_keeps_the_chip_until_it_must_be_over(void)
{
    static struct device e;
    struct device *both[] = {&d, &e};
    begin();
    TEST_ASSERT_EQUAL(ERR_OK, device_open(&e, &ads1115_kind, &settings, 500));
    script("01 C5 23", "");
    script_fails("01", 2, TRANSFER_NO_ANSWER);
    reading("19 00", "C5 23");
    script_run_several(both, 2, 300);
    script_is_done();
    TEST_ASSERT_EQUAL_HEX16(DEVICE_NO_CHIP, script_result(&d).faults);
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(69, script_began_ms(2) - script_began_ms(0));
    TEST_ASSERT_EQUAL(6400, script_result(&e).code[0]);
}

static void one_that_began_with_another_configuration_is_over_before_the_next(void)
{
    script("01 C5 23", "");
    script("01", "55 23"); /* input 1: a bit was disturbed */
    reading("19 00", "C5 23");
    begin();
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(69, script_began_ms(2) - script_began_ms(0));
}

static void settings_that_the_chip_cannot_have_are_refused(void)
{
    settings.address = 0x47;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &ads1115_kind, &settings, 0));
    settings.address = 0x4C;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &ads1115_kind, &settings, 0));
    settings.address = 0x48;
    settings.input = 4;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &ads1115_kind, &settings, 0));
    settings.input = 0;
    settings.type = 6;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &ads1115_kind, &settings, 0));
    settings.type = 5;
    TEST_ASSERT_EQUAL(ERR_OK, device_open(&d, &ads1115_kind, &settings, 0));
    script_board.no_bus = true;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &ads1115_kind, &settings, 0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_reading_is_one_conversion_read_twice_and_checked);
    RUN_TEST(input_and_range_are_bits_of_the_configuration);
    RUN_TEST(each_range_has_its_voltage);
    RUN_TEST(voltages_below_ground_have_a_sign);
    RUN_TEST(codes_at_an_end_are_out_of_range);
    RUN_TEST(a_chip_that_lost_power_during_the_conversion_is_told);
    RUN_TEST(a_conversion_that_has_not_begun_is_begun_again);
    RUN_TEST(a_conversion_that_never_begins_is_a_wrong_chip);
    RUN_TEST(another_configuration_is_a_wrong_chip);
    RUN_TEST(a_chip_that_is_not_there_is_told);
    RUN_TEST(a_transfer_that_does_not_end_is_stopped);
    RUN_TEST(reads_that_differ_are_read_again);
    RUN_TEST(reads_that_never_agree_are_a_checksum_fault);
    RUN_TEST(a_slow_conversion_is_waited_for);
    RUN_TEST(a_conversion_without_an_end_is_a_wrong_chip);
    RUN_TEST(two_inputs_of_a_chip_are_measured_one_after_the_other);
    RUN_TEST(a_failed_reading_gives_the_chip_free);
    RUN_TEST(a_conversion_that_is_given_up_keeps_the_chip_until_it_must_be_over);
    RUN_TEST(one_that_began_with_another_configuration_is_over_before_the_next);
    RUN_TEST(settings_that_the_chip_cannot_have_are_refused);
    return UNITY_END();
}
