/* XGZP6897: traffic byte by byte, units, each fault.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/xgzp6897/xgzp6897.h"
#include "scripted_bus.h"
#include "unity.h"

/* 1234 Pa at 2048 counts to a pascal: 2527232; 25.5 degC. */
#define DATA "26 90 00 19 80"

static struct device d;
static struct device_settings settings;

void setUp(void)
{
    script_clear();
    settings = (struct device_settings){.bus = 2, .address = 0x6D, .reference = 2.5f};
    TEST_ASSERT_EQUAL(ERR_OK, device_open(&d, &xgzp6897_kind, &settings, 500));
}
void tearDown(void) {}

static void set_up(void)
{
    script("A5", "13");
    script("A5 11", "");
}

static void measure(const char *first, const char *second)
{
    script("30 0A", "");
    script("30", "02");
    script("06", first);
    script("06", second);
}

static struct device_result after_cycle(void)
{
    script_run(&d, 500);
    script_is_done();
    return script_result(&d);
}

static void a_reading_is_one_conversion_read_twice(void)
{
    set_up();
    measure(DATA, DATA);
    struct device_result r = after_cycle();
    TEST_ASSERT_EQUAL(1, r.number);
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    TEST_ASSERT_EQUAL(25 * 256 + 128, r.code[1]);
    float value;
    TEST_ASSERT_TRUE(xgzp6897_kind.value(&settings, r.code, &value));
    TEST_ASSERT_EQUAL_FLOAT(1234, value);
    TEST_ASSERT_EQUAL_HEX8(0x6D, script_seen.address);
    TEST_ASSERT_EQUAL(script_began_ms(2), r.stamp_ms);
    TEST_ASSERT_GREATER_OR_EQUAL(20, script_began_ms(3) - script_began_ms(2));
}

static void set_up_is_made_once(void)
{
    set_up();
    measure(DATA, DATA);
    after_cycle();
    measure(DATA, DATA);
    TEST_ASSERT_EQUAL(2, after_cycle().number);
}

static void pressures_below_0_have_a_sign(void)
{
    set_up();
    measure("FF F8 00 19 80", "FF F8 00 19 80");
    struct device_result r = after_cycle();
    float value;
    TEST_ASSERT_TRUE(xgzp6897_kind.value(&settings, r.code, &value));
    TEST_ASSERT_EQUAL_FLOAT(-1, value);
}

/* The maker's table: counts to a pascal by full scale in kPa. */
static void the_unit_follows_from_full_scale(void)
{
    static const struct {
        float full_scale, counts;
    } rows[] = {{0.5f, 8192}, {0.99f, 8192}, {1, 4096},   {1.99f, 4096}, {2, 2048},    {4, 2048},
                {4.1f, 1024}, {8, 1024},     {8.1f, 512}, {16, 512},     {16.1f, 256}, {32, 256},
                {32.1f, 128}, {65, 128},     {65.1f, 64}, {131, 64},     {131.1f, 32}, {260, 32},
                {260.1f, 16}, {500, 16},     {500.1f, 8}, {1000, 8}};
    for (unsigned k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        float value;
        settings.reference = rows[k].full_scale;
        TEST_ASSERT_TRUE(xgzp6897_kind.value(&settings, (const int32_t[3]){81920}, &value));
        TEST_ASSERT_EQUAL_FLOAT(81920 / rows[k].counts, value);
    }
}

static void pressures_a_fifth_beyond_full_scale_are_none(void)
{
    float value;
    TEST_ASSERT_TRUE(xgzp6897_kind.value(&settings, (const int32_t[3]){3000 * 2048}, &value));
    TEST_ASSERT_FALSE(xgzp6897_kind.value(&settings, (const int32_t[3]){3001 * 2048}, &value));
    TEST_ASSERT_FALSE(xgzp6897_kind.value(&settings, (const int32_t[3]){-3001 * 2048}, &value));
}

static void a_slow_conversion_is_waited_for(void)
{
    set_up();
    script("30 0A", "");
    script("30", "0A");
    script("30", "0A");
    script("30", "02");
    script("06", DATA);
    script("06", DATA);
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
}

static void a_conversion_without_an_end_is_a_wrong_chip(void)
{
    set_up();
    script("30 0A", "");
    for (unsigned k = 0; k < 8; k++)
        script("30", "0A");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_WRONG_CHIP, after_cycle().faults);
}

static void registers_of_zeros_are_those_of_power_on(void)
{
    set_up();
    measure(DATA, DATA);
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
    measure("00 00 00 00 00", "00 00 00 00 00");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_POWER_ON, after_cycle().faults);
    set_up();
    measure(DATA, DATA);
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
}

static void ones_alone_are_a_failure_of_the_bus(void)
{
    set_up();
    measure("FF FF FF FF FF", "FF FF FF FF FF");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_BUS, after_cycle().faults);
}

static void what_the_chip_cannot_have_is_out_of_range(void)
{
    static const char *const rows[] = {"7F FF FF 19 80", "80 00 00 19 80", "26 90 00 7E 00",
                                       "26 90 00 D2 00"};
    set_up();
    for (unsigned k = 0; k < 4; k++) {
        measure(rows[k], rows[k]);
        TEST_ASSERT_EQUAL_HEX16_MESSAGE(DEVICE_RANGE, after_cycle().faults, rows[k]);
    }
}

static void temperatures_at_the_ends_are_good(void)
{
    static const struct {
        const char *data;
        uint16_t faults;
    } rows[] = {{"26 90 00 7D 00", 0},
                {"26 90 00 7D 01", DEVICE_RANGE},
                {"26 90 00 D3 00", 0},
                {"26 90 00 D2 FF", DEVICE_RANGE}};
    set_up();
    for (unsigned k = 0; k < 4; k++) {
        measure(rows[k].data, rows[k].data);
        TEST_ASSERT_EQUAL_HEX16_MESSAGE(rows[k].faults, after_cycle().faults, rows[k].data);
    }
}

static void reads_that_differ_are_read_again(void)
{
    set_up();
    measure(DATA, "27 90 00 19 80");
    script("06", DATA);
    script("06", DATA);
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
}

static void reads_that_never_agree_are_a_checksum_fault(void)
{
    set_up();
    measure(DATA, "27 90 00 19 80");
    for (unsigned k = 0; k < 3; k++) {
        script("06", DATA);
        script("06", "27 90 00 19 80");
    }
    TEST_ASSERT_EQUAL_HEX16(DEVICE_CHECKSUM, after_cycle().faults);
}

static void a_chip_that_is_not_there_is_told(void)
{
    script_fails("A5", 1, TRANSFER_NO_ANSWER);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_NO_CHIP, after_cycle().faults);
}

static void a_transfer_that_does_not_end_is_stopped(void)
{
    set_up();
    script_fails("30 0A", 0, SCRIPT_NEVER_ENDS);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_BUS, after_cycle().faults);
    TEST_ASSERT_EQUAL(1, script_seen.stops);
}

static void settings_that_the_chip_cannot_have_are_refused(void)
{
    settings.address = 0x6C;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &xgzp6897_kind, &settings, 0));
    settings.address = 0x6D;
    settings.reference = 0;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &xgzp6897_kind, &settings, 0));
    settings.reference = 1001;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &xgzp6897_kind, &settings, 0));
    settings.reference = 1;
    script_board.no_bus = true;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &xgzp6897_kind, &settings, 0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_reading_is_one_conversion_read_twice);
    RUN_TEST(set_up_is_made_once);
    RUN_TEST(pressures_below_0_have_a_sign);
    RUN_TEST(the_unit_follows_from_full_scale);
    RUN_TEST(pressures_a_fifth_beyond_full_scale_are_none);
    RUN_TEST(a_slow_conversion_is_waited_for);
    RUN_TEST(a_conversion_without_an_end_is_a_wrong_chip);
    RUN_TEST(registers_of_zeros_are_those_of_power_on);
    RUN_TEST(ones_alone_are_a_failure_of_the_bus);
    RUN_TEST(what_the_chip_cannot_have_is_out_of_range);
    RUN_TEST(temperatures_at_the_ends_are_good);
    RUN_TEST(reads_that_differ_are_read_again);
    RUN_TEST(reads_that_never_agree_are_a_checksum_fault);
    RUN_TEST(a_chip_that_is_not_there_is_told);
    RUN_TEST(a_transfer_that_does_not_end_is_stopped);
    RUN_TEST(settings_that_the_chip_cannot_have_are_refused);
    return UNITY_END();
}
