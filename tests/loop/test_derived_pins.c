/* Channels of the kind `derived` from sensors at the board's own pins: a temperature compensated by the barometer, and the volume
 * that a flow meter's pulses make.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "pins_bench.h"

static const char wiring[] = "T1   max31865 spi1 PA4  reference=430 wires=3\n"
                             "P    bme280   i2c2 0x76 pressure\n"
                             "Tair bme280   i2c2 0x76 temperature\n"
                             "Q    ssr      PB0       hi=3\n";

#define PULSES_PER_LITRE 450.0

static void set_up(void)
{
    ask_ok("begin");
    PINS_ASK("set io.source board", "set tick.base 1");
    PINS_ASK("set chan1.name T1", "set chan1.unit degC", "set chan1.device max31865",
             "set chan1.bus spi1", "set chan1.select PA4", "set meas1.name T1",
             "set meas1.unit degC", "set meas1.hi 200");
    PINS_ASK("set chan2.name P", "set chan2.unit Pa", "set chan2.device bme280",
             "set chan2.bus i2c2", "set chan2.select 0x76", "set meas2.name P", "set meas2.unit Pa",
             "set meas2.lo 80000", "set meas2.hi 120000");
    PINS_ASK("set chan3.name F", "set chan3.unit -", "set chan3.device pulses",
             "set chan3.select PC9", "set meas3.name F", "set meas3.unit -", "set meas3.hi 65536");
    PINS_ASK("set meas4.name T1c", "set meas4.unit degC", "set meas4.hi 200",
             "set meas5.name drawn", "set meas5.unit l", "set meas5.hi 2");
    PINS_ASK("set block1.kind derived", "set block1.inputs T1,P,F", "set block1.points T1c,drawn");
    PINS_ASK("set block1.is.1 boil", "set block1.weight.1 1,0,0,0,0,0,0,0", "set block1.by.1 2",
             "set block1.at.1 101325", "set block1.slope.1 0.0003336");
    PINS_ASK("set block1.is.2 total", "set block1.weight.2 0,0,0.00222222222,0,0,0,0,0",
             "set block1.wrap.2 65536");
}

void setUp(void)
{
    pins_power_on(wiring);
    pins_measure("T1", 90);
    pins_measure("P", 101325);
    pins_measure("Tair", 23);
    buses_set_pin(HAL_PIN('C', 9), PIN_LEVEL_HIGH);
    buses_set_pin(HAL_PIN('C', 8), PIN_LEVEL_HIGH);
    set_up();
    PINS_ASK("apply", "log on");
    pins_samples(8);
}

void tearDown(void)
{
    pins_close();
    buses_set_pin(HAL_PIN('C', 8), PIN_LEVEL_OPEN);
    buses_set_pin(HAL_PIN('C', 9), PIN_LEVEL_OPEN);
}

/* Within the resolution of the sensors: 0.03 K, and 0.2 Pa. */
static void a_temperature_is_what_it_would_be_at_the_reference_pressure(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 90, pins_field("T1c"));
    TEST_ASSERT_EQUAL_DOUBLE(0, pins_field("T1c.q"));
    /* Bad weather: the same liquid boils 1.725 K lower (derived_boil.csv, stage 6, 95 % of the pressure). */
    pins_measure("P", 101325 * 0.95);
    pins_measure("T1", 90 - 1.725);
    pins_samples(5);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 90 - 1.725, pins_field("T1"));
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 90, pins_field("T1c"));
    TEST_ASSERT_EQUAL_DOUBLE(0, pins_field("T1c.q"));
}

static void without_a_barometer_there_is_no_compensated_temperature(void)
{
    pins_fault("P", "nack", 1);
    pins_samples(3);
    TEST_ASSERT_TRUE(pins_field("T1c.q") > 0);
    TEST_ASSERT_EQUAL_DOUBLE(0, pins_field("T1.q"));
    pins_fault("P", "nack", 0);
    pins_samples(5);
    TEST_ASSERT_EQUAL_DOUBLE(0, pins_field("T1c.q"));
}

/* To the pulse, though a tick sees one of ten results of the meter. */
static void pulses_make_a_volume(void)
{
    ask_ok("block 1 reset");
    pins_samples(3);
    TEST_ASSERT_EQUAL_DOUBLE(0, pins_field("drawn"));
    TEST_ASSERT_EQUAL_DOUBLE(0, pins_field("drawn.q"));
    board_forget();
    for (unsigned i = 0; i < 300; i++) {
        buses_set_pin(HAL_PIN('C', 9), PIN_LEVEL_LOW);
        buses_set_pin(HAL_PIN('C', 9), PIN_LEVEL_HIGH);
        pass(100);
    }
    pins_samples(3);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 / PULSES_PER_LITRE, 300 / PULSES_PER_LITRE, pins_field("drawn"));
    TEST_ASSERT_EQUAL_DOUBLE(0, pins_field("drawn.q"));
}

static void give_pulses(unsigned n)
{
    for (unsigned i = 0; i < n; i++) {
        buses_set_pin(HAL_PIN('C', 9), PIN_LEVEL_LOW);
        buses_set_pin(HAL_PIN('C', 9), PIN_LEVEL_HIGH);
        if (i % 50 == 49)
            pass(100);
    }
}

/* New settings of the pins open all devices anew, and the counter begins at 0. From the upper half of its range that looks like a wrap. */
static void a_counter_that_begins_anew_with_new_settings_is_no_volume(void)
{
    ask_ok("set block1.weight.2 0,0,1e-5,0,0,0,0,0");
    ask_ok("block 1 reset");
    pins_samples(3);
    give_pulses(40000);
    pins_samples(3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.4, pins_field("drawn"));
    TEST_ASSERT_EQUAL_DOUBLE(0, pins_field("drawn.q"));
    ask_ok("set chan1.nominal 100");
    pins_samples(5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.4, pins_field("drawn"));
    TEST_ASSERT_TRUE(pins_field("drawn.q") > 0);
}

/* The other meter has counted more by then: that is no volume of it. */
static void another_counter_in_the_place_of_the_first_adds_nothing_of_its_past(void)
{
    PINS_ASK("begin", "set chan4.name G", "set chan4.unit -", "set chan4.device pulses",
             "set chan4.select PC8", "set meas6.name G", "set meas6.unit -", "set meas6.hi 65536",
             "apply");
    pins_samples(5);
    for (unsigned i = 0; i < 450; i++) {
        buses_set_pin(HAL_PIN('C', 8), PIN_LEVEL_LOW);
        buses_set_pin(HAL_PIN('C', 8), PIN_LEVEL_HIGH);
    }
    ask_ok("block 1 reset");
    pins_samples(3);
    TEST_ASSERT_EQUAL_DOUBLE(0, pins_field("drawn"));
    TEST_ASSERT_EQUAL_DOUBLE(0, pins_field("drawn.q"));
    ask_ok("set block1.inputs T1,P,G");
    pins_samples(5);
    TEST_ASSERT_EQUAL_DOUBLE(0, pins_field("drawn"));
    TEST_ASSERT_TRUE(pins_field("drawn.q") > 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_temperature_is_what_it_would_be_at_the_reference_pressure);
    RUN_TEST(without_a_barometer_there_is_no_compensated_temperature);
    RUN_TEST(pulses_make_a_volume);
    RUN_TEST(a_counter_that_begins_anew_with_new_settings_is_no_volume);
    RUN_TEST(another_counter_in_the_place_of_the_first_adds_nothing_of_its_past);
    return UNITY_END();
}
