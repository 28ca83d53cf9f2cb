/* What is behind a voltage: a current loop by NAMUR NE 43, dividers, a thermistor.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include <math.h>

#include "devices/device.h"
#include "devices/voltage/current_loop.h"
#include "devices/voltage/divider.h"
#include "devices/voltage/thermistor.h"
#include "unity.h"

static struct current_loop loop;

void setUp(void)
{
    loop = (struct current_loop){0};
}
void tearDown(void) {}

static void a_shunt_turns_voltage_into_current_and_span(void)
{
    TEST_ASSERT_EQUAL_FLOAT(4, loop_current(0.4f, 100));
    TEST_ASSERT_EQUAL_FLOAT(0, loop_fraction(4));
    TEST_ASSERT_EQUAL_FLOAT(1, loop_fraction(20));
    TEST_ASSERT_EQUAL_FLOAT(0.5f, loop_fraction(12));
    TEST_ASSERT_EQUAL_FLOAT(-0.0125f, loop_fraction(3.8f));
}

static void currents_have_the_quality_of_ne_43(void)
{
    static const struct {
        float milliampere;
        enum quality quality;
    } rows[] = {{0, QUALITY_BAD},
                {3.5f, QUALITY_BAD},
                {3.6f, QUALITY_BAD},
                {3.61f, QUALITY_UNCERTAIN},
                {3.79f, QUALITY_UNCERTAIN},
                {3.8f, QUALITY_GOOD},
                {4, QUALITY_GOOD},
                {20, QUALITY_GOOD},
                {20.5f, QUALITY_GOOD},
                {20.51f, QUALITY_UNCERTAIN},
                {20.99f, QUALITY_UNCERTAIN},
                {21, QUALITY_BAD},
                {24, QUALITY_BAD},
                {-4, QUALITY_BAD},
                {NAN, QUALITY_BAD},
                {INFINITY, QUALITY_BAD}};
    for (unsigned k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        setUp();
        TEST_ASSERT_EQUAL(rows[k].quality, loop_quality(&loop, rows[k].milliampere, 1, 0));
    }
}

static void a_failure_is_uncertain_for_the_delay(void)
{
    TEST_ASSERT_EQUAL(QUALITY_GOOD, loop_quality(&loop, 12, 1, 3));
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, loop_quality(&loop, 2, 1, 3));
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, loop_quality(&loop, 2, 1, 3));
    TEST_ASSERT_EQUAL(QUALITY_BAD, loop_quality(&loop, 22, 1, 3));
    TEST_ASSERT_EQUAL(QUALITY_BAD, loop_quality(&loop, 2, 1, 3));
    TEST_ASSERT_EQUAL(QUALITY_GOOD, loop_quality(&loop, 4, 1, 3));
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, loop_quality(&loop, 2, 1, 3)); /* counts anew */
}

static void a_divider_shows_a_part_of_its_source(void)
{
    TEST_ASSERT_EQUAL_FLOAT(10, divider_source(2, 40000, 10000));
    TEST_ASSERT_EQUAL_FLOAT(0, divider_source(0, 40000, 10000));
}

static void a_sensor_in_a_divider_has_a_resistance(void)
{
    float ohm = 0;
    TEST_ASSERT_EQUAL(0, divider_sensor(1.1f, 3.3f, 10000, true, &ohm));
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 5000, ohm);
    TEST_ASSERT_EQUAL(0, divider_sensor(1.1f, 3.3f, 10000, false, &ohm));
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 20000, ohm);
}

static void a_sensor_that_is_open_or_shorted_has_none(void)
{
    float ohm = 7;
    TEST_ASSERT_EQUAL_HEX16(DEVICE_OPEN, divider_sensor(3.28f, 3.3f, 10000, true, &ohm));
    TEST_ASSERT_EQUAL_HEX16(DEVICE_SHORT, divider_sensor(0.02f, 3.3f, 10000, true, &ohm));
    TEST_ASSERT_EQUAL_HEX16(DEVICE_SHORT, divider_sensor(3.28f, 3.3f, 10000, false, &ohm));
    TEST_ASSERT_EQUAL_HEX16(DEVICE_OPEN, divider_sensor(0.02f, 3.3f, 10000, false, &ohm));
    TEST_ASSERT_EQUAL_HEX16(DEVICE_RANGE, divider_sensor(NAN, 3.3f, 10000, true, &ohm));
    TEST_ASSERT_EQUAL_HEX16(DEVICE_RANGE, divider_sensor(1, 0, 10000, true, &ohm));
    TEST_ASSERT_EQUAL_FLOAT(7, ohm);
}

/* Against the equation in double, resistance from temperature. */
static void a_thermistor_follows_its_beta(void)
{
    for (int t = -50; t <= 195; t += 5) {
        double ohm = 10000 * exp(3950 * (1 / (t + 273.15) - 1 / 298.15));
        float found;
        TEST_ASSERT_TRUE(thermistor_temperature((float)ohm, 10000, 3950, &found));
        TEST_ASSERT_FLOAT_WITHIN(0.002f, (float)t, found);
    }
}

static void a_thermistor_has_no_temperature_beyond_its_range(void)
{
    float t = 7;
    TEST_ASSERT_FALSE(thermistor_temperature(0, 10000, 3950, &t));
    TEST_ASSERT_FALSE(thermistor_temperature(-1, 10000, 3950, &t));
    TEST_ASSERT_FALSE(thermistor_temperature(NAN, 10000, 3950, &t));
    TEST_ASSERT_FALSE(thermistor_temperature(1, 10000, 3950, &t));
    TEST_ASSERT_FALSE(thermistor_temperature(1e9f, 10000, 3950, &t));
    TEST_ASSERT_FALSE(thermistor_temperature(10000, 0, 3950, &t));
    TEST_ASSERT_FALSE(thermistor_temperature(10000, 10000, 0, &t));
    TEST_ASSERT_EQUAL_FLOAT(7, t);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_shunt_turns_voltage_into_current_and_span);
    RUN_TEST(currents_have_the_quality_of_ne_43);
    RUN_TEST(a_failure_is_uncertain_for_the_delay);
    RUN_TEST(a_divider_shows_a_part_of_its_source);
    RUN_TEST(a_sensor_in_a_divider_has_a_resistance);
    RUN_TEST(a_sensor_that_is_open_or_shorted_has_none);
    RUN_TEST(a_thermistor_follows_its_beta);
    RUN_TEST(a_thermistor_has_no_temperature_beyond_its_range);
    return UNITY_END();
}
