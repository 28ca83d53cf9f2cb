/* BME280 and BMP280: compensation against the formulas of the data sheet in double (BME280, 8.1), traffic byte by byte, each fault.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "devices/bme280/bme280.h"
#include "devices/bme280/compensation.h"
#include "random_source.h"
#include "scripted_bus.h"
#include "unity.h"

/* The example of the BMP280's data sheet: T1 27504, T2 26435, T3 -1000, P1 36477, P2 -10685, P3 3024, P4 2855, P5 140, P6 -7, P7 15500, P8
 * -14600, P9 6000; raw temperature 519888, raw pressure 415148; 25.08 degC and 100653.27 Pa. */
#define CALIBRATION "70 6B 43 67 18 FC 7D 8E 43 D6 D0 0B 27 0B 8C 00 F9 FF 8C 3C F8 C6 70 17"
#define RAW         "65 5A C0 7E ED 00"
#define READING     "00 54 00 00 " RAW

static const int example[12] = {27504, 26435, -1000, 36477, -10685, 3024,
                                2855,  140,   -7,    15500, -14600, 6000};

static struct device d, e;
static struct device_settings settings;

void setUp(void)
{
    script_clear();
    settings = (struct device_settings){.bus = 1, .address = 0x76};
    TEST_ASSERT_EQUAL(ERR_OK, device_open(&d, &bme280_kind, &settings, 500));
}
void tearDown(void) {}

static void pack(const int words[12], uint8_t bytes[BME280_CALIBRATION])
{
    for (size_t k = 0; k < 12; k++) {
        bytes[2 * k] = (uint8_t)words[k];
        bytes[2 * k + 1] = (uint8_t)(words[k] >> 8);
    }
}

/* ---- compensation ---- */

static void in_double(const int w[12], double raw_t, double raw_p, double *t, double *p)
{
    const int *dig_p = w + 2; /* dig_p[1] is P1 */
    double x = (raw_t / 16384 - w[0] / 1024.0) * w[1];
    double y = raw_t / 131072 - w[0] / 8192.0;
    double fine = x + y * y * w[2];
    *t = fine / 5120;
    double v = fine / 2 - 64000;
    double offset = (v * v * dig_p[6] / 32768 + v * dig_p[5] * 2) / 4 + dig_p[4] * 65536.0;
    double slope = (dig_p[3] * v * v / 524288 + dig_p[2] * v) / 524288;
    slope = (1 + slope / 32768) * dig_p[1];
    double q = (1048576 - raw_p - offset / 4096) * 6250 / slope;
    *p = q + (dig_p[9] * q * q / 2147483648.0 + q * dig_p[8] / 32768 + dig_p[7]) / 16;
}

static void the_example_of_the_data_sheet_comes_out(void)
{
    uint8_t calibration[BME280_CALIBRATION];
    int32_t t, p;
    pack(example, calibration);
    TEST_ASSERT_TRUE(bme280_compensate(calibration, 519888, 415148, &t, &p));
    TEST_ASSERT_EQUAL(2508, t);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 100653.27, p / 256.0);
}

/* The data sheet's whole numbers leave out the last 3 and 4 bits of the raw temperature, 0.003 degC. Without these bits the rest is rounding: half
 * of 0.01 degC, and two units of 1/5120 degC of the fine temperature, which move the pressure by less than 0.1 Pa. */
static void whole_numbers_agree_with_double(void)
{
    uint8_t calibration[BME280_CALIBRATION];
    double worst_t = 0, worst_p = 0;
    unsigned n = 0;
    pack(example, calibration);
    for (int raw_t = 380000; raw_t <= 680000; raw_t += 1504)
        for (int raw_p = 250000; raw_p <= 850000; raw_p += 4999) {
            double t_wanted, p_wanted;
            int32_t t, p;
            in_double(example, raw_t, raw_p, &t_wanted, &p_wanted);
            if (t_wanted < -40 || t_wanted > 85 || p_wanted < 30000 || p_wanted > 110000)
                continue;
            TEST_ASSERT_TRUE(bme280_compensate(calibration, raw_t, raw_p, &t, &p));
            worst_t = fmax(worst_t, fabs(t / 100.0 - t_wanted));
            worst_p = fmax(worst_p, fabs(p / 256.0 - p_wanted));
            n++;
        }
    printf("%u readings: worst difference %.4f degC, %.3f Pa\n", n, worst_t, worst_p);
    TEST_ASSERT_GREATER_THAN(10000, n);
    TEST_ASSERT_TRUE(worst_t < 0.006);
    TEST_ASSERT_TRUE(worst_p < 0.1);
}

/* A calibration that is none overflows nothing (the sanitizers look). */
static void any_bytes_as_calibration_do_no_harm(void)
{
    struct random_source r = {.state = 38};
    unsigned taken = 0;
    printf("seed 38\n");
    for (unsigned k = 0; k < 200000; k++) {
        uint8_t calibration[BME280_CALIBRATION];
        for (unsigned i = 0; i < BME280_CALIBRATION; i++)
            calibration[i] = (uint8_t)random_below(&r, 256);
        int32_t t = 0, p = 0;
        if (bme280_compensate(calibration, (int32_t)random_below(&r, 1u << 20),
                              (int32_t)random_below(&r, 1u << 20), &t, &p)) {
            TEST_ASSERT_GREATER_OR_EQUAL(0, p);
            taken++;
        }
    }
    TEST_ASSERT_GREATER_THAN(0, taken);
    static const uint8_t same[] = {0x00, 0xFF, 0x7F, 0x80};
    for (unsigned k = 0; k < sizeof same; k++) {
        uint8_t calibration[BME280_CALIBRATION];
        int32_t t, p;
        memset(calibration, same[k], sizeof calibration);
        for (int32_t raw = 0; raw < 1 << 20; raw += 4095)
            (void)bme280_compensate(calibration, raw, (1 << 20) - 1 - raw, &t, &p);
    }
}

static void a_calibration_of_zeros_gives_no_pressure(void)
{
    const uint8_t calibration[BME280_CALIBRATION] = {0};
    int32_t t, p;
    TEST_ASSERT_FALSE(bme280_compensate(calibration, 519888, 415148, &t, &p));
}

/* ---- traffic ---- */

static void set_up(const char *id)
{
    script("D0", id);
    script("88", CALIBRATION);
    script("88", CALIBRATION);
}

static void reading(const char *reply)
{
    script("F4 55", "");
    script("F3", reply);
    script("F3", reply);
}

static struct device_result after_cycle(void)
{
    script_run(&d, 500);
    script_is_done();
    return script_result(&d);
}

static void a_reading_is_one_conversion_read_twice(void)
{
    set_up("60");
    reading(READING);
    struct device_result r = after_cycle();
    TEST_ASSERT_EQUAL(1, r.number);
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    float value;
    TEST_ASSERT_TRUE(bme280_kind.value(&settings, r.code, &value));
    TEST_ASSERT_FLOAT_WITHIN(0.03f, 100653.27f, value);
    TEST_ASSERT_TRUE(bme280_temperature_kind.value(&settings, r.code, &value));
    TEST_ASSERT_EQUAL_FLOAT(25.08f, value);
    TEST_ASSERT_EQUAL_HEX8(0x76, script_seen.address);
    TEST_ASSERT_EQUAL(script_began_ms(3), r.stamp_ms);
    TEST_ASSERT_GREATER_OR_EQUAL(44, script_began_ms(4) - script_began_ms(3));
}

static void a_bmp280_is_as_good(void)
{
    set_up("58");
    reading(READING);
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
}

static void calibration_is_read_once(void)
{
    set_up("60");
    reading(READING);
    after_cycle();
    reading("00 54 00 00 65 5A D0 7E ED 00");
    struct device_result r = after_cycle();
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    TEST_ASSERT_EQUAL(2, r.number);
}

static void another_id_is_a_wrong_chip(void)
{
    script("D0", "55"); /* BMP180 */
    TEST_ASSERT_EQUAL_HEX16(DEVICE_WRONG_CHIP, after_cycle().faults);
    set_up("60");
    reading(READING);
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
}

static void a_chip_that_lost_power_is_told_and_identified_again(void)
{
    set_up("60");
    reading(READING);
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
    reading("00 00 00 00 80 00 00 80 00 00");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_POWER_ON, after_cycle().faults);
    set_up("60");
    reading(READING);
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
}

static void another_configuration_is_a_wrong_chip(void)
{
    set_up("60");
    reading("00 24 00 00 " RAW);
    script("E0 B6", ""); /* a reset, so that it is as after power-on */
    TEST_ASSERT_EQUAL_HEX16(DEVICE_WRONG_CHIP, after_cycle().faults);
    set_up("60");
    reading("00 54 10 00 " RAW); /* a filter, which nobody has set */
    script("E0 B6", "");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_WRONG_CHIP, after_cycle().faults);
}

static void a_quantity_that_was_not_measured_is_out_of_range(void)
{
    set_up("60");
    reading("00 54 00 00 80 00 00 7E ED 00");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_RANGE, after_cycle().faults);
    set_up("60");
    reading("00 54 00 00 65 5A C0 80 00 00");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_RANGE, after_cycle().faults);
}

static void a_calibration_that_is_none_is_out_of_range_and_read_again(void)
{
    script("D0", "60");
    for (unsigned k = 0; k < 2; k++)
        script("88", "00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00");
    reading(READING);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_RANGE, after_cycle().faults);
    set_up("60");
    reading(READING);
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
}

static void calibrations_that_differ_are_a_checksum_fault(void)
{
    script("D0", "60");
    script("88", CALIBRATION);
    script("88", "71 6B 43 67 18 FC 7D 8E 43 D6 D0 0B 27 0B 8C 00 F9 FF 8C 3C F8 C6 70 17");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_CHECKSUM, after_cycle().faults);
}

static void reads_that_differ_are_read_again(void)
{
    set_up("60");
    script("F4 55", "");
    script("F3", READING);
    script("F3", "00 54 00 00 25 5A C0 7E ED 00");
    script("F3", READING);
    script("F3", READING);
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
}

static void reads_that_never_agree_are_a_checksum_fault(void)
{
    set_up("60");
    script("F4 55", "");
    for (unsigned k = 0; k < 4; k++) {
        script("F3", READING);
        script("F3", "00 54 00 00 25 5A C0 7E ED 00");
    }
    TEST_ASSERT_EQUAL_HEX16(DEVICE_CHECKSUM, after_cycle().faults);
}

static void a_slow_conversion_is_waited_for(void)
{
    set_up("60");
    script("F4 55", "");
    script("F3", "08 55 00 00 80 00 00 80 00 00");
    script("F3", "08 55 00 00 80 00 00 80 00 00");
    script("F3", READING);
    script("F3", READING);
    TEST_ASSERT_EQUAL_HEX16(0, after_cycle().faults);
}

/* Either of the two says so. */
static void a_conversion_runs_while_a_bit_or_the_mode_says_so(void)
{
    set_up("60");
    script("F4 55", "");
    for (unsigned k = 0; k < 2; k++)
        script("F3", "08 54 00 00 65 5A D0 7E ED 00");
    for (unsigned k = 0; k < 2; k++)
        script("F3", "00 55 00 00 65 5A D0 7E ED 00");
    for (unsigned k = 0; k < 2; k++)
        script("F3", "01 54 00 00 65 5A D0 7E ED 00");
    for (unsigned k = 0; k < 2; k++)
        script("F3", READING);
    struct device_result r = after_cycle();
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 100653.27, r.code[0] / 256.0);
}

static void a_conversion_without_an_end_is_a_wrong_chip(void)
{
    set_up("60");
    script("F4 55", "");
    for (unsigned k = 0; k < 8; k++)
        script("F3", "08 55 00 00 80 00 00 80 00 00");
    script("E0 B6", "");
    TEST_ASSERT_EQUAL_HEX16(DEVICE_WRONG_CHIP, after_cycle().faults);
}

static void a_chip_that_is_not_there_is_told(void)
{
    script_fails("D0", 1, TRANSFER_NO_ANSWER);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_NO_CHIP, after_cycle().faults);
}

static void a_transfer_that_does_not_end_is_stopped(void)
{
    script("D0", "60");
    script_fails("88", 24, SCRIPT_NEVER_ENDS);
    TEST_ASSERT_EQUAL_HEX16(DEVICE_BUS, after_cycle().faults);
    TEST_ASSERT_EQUAL(1, script_seen.stops);
}

static void pressure_and_temperature_share_a_chip(void)
{
    struct device *both[] = {&d, &e};
    TEST_ASSERT_EQUAL(ERR_OK, device_open(&e, &bme280_temperature_kind, &settings, 500));
    for (unsigned k = 0; k < 2; k++) {
        set_up("60");
        reading(READING);
    }
    script_run_several(both, 2, 500);
    script_is_done();
    TEST_ASSERT_EQUAL_HEX16(0, script_result(&d).faults);
    TEST_ASSERT_EQUAL_HEX16(0, script_result(&e).faults);
    TEST_ASSERT_EQUAL(2508, script_result(&e).code[1]);
}

static void values_beyond_the_chip_are_none(void)
{
    float value;
    TEST_ASSERT_FALSE(bme280_kind.value(&settings, (const int32_t[3]){30000 * 256 - 1}, &value));
    TEST_ASSERT_FALSE(bme280_kind.value(&settings, (const int32_t[3]){110000 * 256 + 1}, &value));
    TEST_ASSERT_TRUE(bme280_kind.value(&settings, (const int32_t[3]){110000 * 256}, &value));
    TEST_ASSERT_FALSE(
        bme280_temperature_kind.value(&settings, (const int32_t[3]){0, -4001}, &value));
    TEST_ASSERT_FALSE(
        bme280_temperature_kind.value(&settings, (const int32_t[3]){0, 8501}, &value));
    TEST_ASSERT_TRUE(bme280_temperature_kind.value(&settings, (const int32_t[3]){0, 8500}, &value));
}

static void settings_that_the_chip_cannot_have_are_refused(void)
{
    settings.address = 0x75;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &bme280_kind, &settings, 0));
    settings.address = 0x77;
    script_board.no_bus = true;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &bme280_kind, &settings, 0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_example_of_the_data_sheet_comes_out);
    RUN_TEST(whole_numbers_agree_with_double);
    RUN_TEST(any_bytes_as_calibration_do_no_harm);
    RUN_TEST(a_calibration_of_zeros_gives_no_pressure);
    RUN_TEST(a_reading_is_one_conversion_read_twice);
    RUN_TEST(a_bmp280_is_as_good);
    RUN_TEST(calibration_is_read_once);
    RUN_TEST(another_id_is_a_wrong_chip);
    RUN_TEST(a_chip_that_lost_power_is_told_and_identified_again);
    RUN_TEST(another_configuration_is_a_wrong_chip);
    RUN_TEST(a_quantity_that_was_not_measured_is_out_of_range);
    RUN_TEST(a_calibration_that_is_none_is_out_of_range_and_read_again);
    RUN_TEST(calibrations_that_differ_are_a_checksum_fault);
    RUN_TEST(reads_that_differ_are_read_again);
    RUN_TEST(reads_that_never_agree_are_a_checksum_fault);
    RUN_TEST(a_slow_conversion_is_waited_for);
    RUN_TEST(a_conversion_runs_while_a_bit_or_the_mode_says_so);
    RUN_TEST(a_conversion_without_an_end_is_a_wrong_chip);
    RUN_TEST(a_chip_that_is_not_there_is_told);
    RUN_TEST(a_transfer_that_does_not_end_is_stopped);
    RUN_TEST(pressure_and_temperature_share_a_chip);
    RUN_TEST(values_beyond_the_chip_are_none);
    RUN_TEST(settings_that_the_chip_cannot_have_are_refused);
    return UNITY_END();
}
