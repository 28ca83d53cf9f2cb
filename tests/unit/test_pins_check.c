/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* Settings of devices and outputs that conflict, with each other or with what the board has: refused in words, with group, index and field. */
#include <stdio.h>
#include <string.h>

#include "exchange/config.h"
#include "service/pins_check.h"
#include "settings/parameters.h"
#include "unity.h"

static struct config config;
static struct config_fault fault;

static void set(const char *name, const char *value)
{
    struct parameter p;
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, parameter_find(name, &p), name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, parameter_set(&p, &config, value), value);
}

static void set_of(const char *group, unsigned index, const char *field, const char *value)
{
    char name[40];
    (void)snprintf(name, sizeof name, "%s%u.%s", group, index, field);
    set(name, value);
}

static void device(unsigned i, const char *name, const char *kind, const char *bus,
                   const char *select)
{
    set_of("chan", i, "name", name);
    set_of("chan", i, "device", kind);
    set_of("chan", i, "bus", bus);
    set_of("chan", i, "select", select);
}

static void output(unsigned i, const char *name, const char *kind, const char *pin)
{
    set_of("out", i, "name", name);
    set_of("out", i, "kind", kind);
    set_of("out", i, "pin", pin);
}

static void accepted(void)
{
    char words[200];
    memset(&fault, 0, sizeof fault);
    enum err err = pins_check(&config, &fault);
    (void)snprintf(words, sizeof words, "%s%u.%s %s: %s", fault.group ? fault.group : "",
                   fault.index, fault.field ? fault.field : "", fault.subject,
                   fault.wanted ? fault.wanted : "");
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, err, words);
}

static void refused(enum err err, const char *group, unsigned index, const char *field,
                    const char *subject, const char *words)
{
    memset(&fault, 0, sizeof fault);
    TEST_ASSERT_EQUAL_STRING(err_name(err), err_name(pins_check(&config, &fault)));
    TEST_ASSERT_EQUAL_STRING(err_name(err), err_name(fault.code));
    TEST_ASSERT_EQUAL_STRING(words, fault.wanted);
    TEST_ASSERT_EQUAL_STRING(group, fault.group);
    TEST_ASSERT_EQUAL_UINT(index, fault.index);
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_EQUAL_STRING(subject, fault.subject);
}

void setUp(void)
{
    parameters_defaults(&config);
}
void tearDown(void) {}

static const char pin_wanted[] =
    "must be a free pin, PA4 say; the console, the debugger and the boot loader keep theirs";
static const char pin_twice[] = "is taken by another device, output or bus";
static const char bus_wanted[] =
    "must be a bus that the device speaks: spi, i2c or wire; - for one at a pin";

/* ---- accepted ---- */

static void a_board_with_nothing_at_its_pins_is_accepted(void)
{
    accepted();
}

static void a_device_of_every_kind_and_an_output_of_every_kind_are_accepted(void)
{
    device(1, "T1", "max31865", "spi1", "PA4");
    device(2, "T2", "max31856", "spi1", "PB12");
    set("chan2.type", "K");
    device(3, "T3", "ds18b20", "wire1", "28000005e2fdc3");
    device(4, "L", "ads1115", "i2c1", "0x48");
    device(5, "P", "bme280", "i2c1", "0x76");
    device(6, "Tair", "bme280_temperature", "i2c1", "0x77");
    device(7, "dP", "xgzp6897", "i2c1", "0x6D");
    set("chan7.reference", "1");
    device(8, "U", "analog", "-", "PC0");
    device(9, "F", "flow", "-", "PC8");
    device(10, "S", "level", "-", "PC9");
    output(1, "Q", "window", "PB0");
    output(2, "Q2", "burst", "PB1");
    output(3, "W", "relay", "PC1");
    output(4, "Fan", "pwm", "PA1");
    output(5, "V", "motor_valve", "PC2");
    set("out5.pin2", "PC3");
    output(6, "E", "enable", "PC4");
    set("out6.least_off", "2");
    accepted();
}

static void devices_share_a_bus(void)
{
    device(1, "T1", "max31865", "spi1", "PA4");
    device(2, "T2", "max31865", "spi1", "PB12");
    device(3, "T3", "max31865", "spi2", "PC0");
    accepted();
}

static void inputs_of_one_chip_are_several_channels(void)
{
    for (unsigned i = 0; i < 4; i++) {
        char name[4] = {'U', (char)('0' + i), '\0'}, input[2] = {(char)('0' + i), '\0'};
        device(i + 1, name, "ads1115", "i2c1", "0x48");
        set_of("chan", i + 1, "input", input);
    }
    accepted();
}

static void pressure_and_temperature_of_one_barometer_are_two_channels(void)
{
    device(1, "P", "bme280", "i2c1", "0x76");
    device(2, "Tair", "bme280_temperature", "i2c1", "0x76");
    accepted();
}

static void one_address_on_two_buses_is_two_chips(void)
{
    device(1, "U1", "ads1115", "i2c1", "0x48");
    device(2, "U2", "ads1115", "i2c2", "0x48");
    accepted();
}

static void what_has_no_name_is_not_looked_at(void)
{
    device(1, "-", "max31865", "i2c1", "nonsense");
    output(1, "-", "window", "PA9");
    accepted();
}

/* ---- devices refused ---- */

static void a_device_must_be_named_once(void)
{
    device(1, "T1", "max31865", "spi1", "PA4");
    device(3, "T1", "max31865", "spi1", "PB12");
    refused(ERR_CONFLICT, "chan", 3, "name", "T1", "is used twice");
}

static void a_named_channel_must_have_a_device(void)
{
    set("chan2.name", "T2");
    refused(ERR_EMPTY, "chan", 2, "device", "T2", "must say what is at the pins");
}

static void a_device_must_be_on_a_bus_that_it_speaks(void)
{
    static const char *const wrong[][2] = {
        {"max31865", "i2c1"}, {"max31865", "-"}, {"ads1115", "spi1"}, {"ds18b20", "i2c2"},
        {"bme280", "wire1"},  {"level", "spi1"}, {"analog", "wire2"}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        device(1, "T1", wrong[i][0], wrong[i][1], "PA4");
        refused(ERR_CONFLICT, "chan", 1, "bus", "T1", bus_wanted);
    }
}

static void a_select_must_be_a_free_pin(void)
{
    static const char *const wrong[] = {"-",    "PA",   "pa4", "PA2",  "PA3", "PA9",  "PA10",
                                        "PA13", "PA14", "PB2", "PC14", "PD0", "PI15", "0x48"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        device(1, "T1", "max31865", "spi1", wrong[i]);
        refused(ERR_RANGE, "chan", 1, "select", strcmp(wrong[i], "-") == 0 ? "" : wrong[i],
                pin_wanted);
        device(1, "S", "level", "-", wrong[i]);
        refused(ERR_RANGE, "chan", 1, "select", strcmp(wrong[i], "-") == 0 ? "" : wrong[i],
                pin_wanted);
    }
}

static void two_devices_cannot_have_one_pin(void)
{
    device(1, "T1", "max31865", "spi1", "PA4");
    device(2, "T2", "max31865", "spi1", "PA4");
    refused(ERR_CONFLICT, "chan", 2, "select", "PA4", pin_twice);
    device(2, "S", "level", "-", "PA4");
    refused(ERR_CONFLICT, "chan", 2, "select", "PA4", pin_twice);
}

static void a_device_cannot_have_a_pin_of_a_bus(void)
{
    device(1, "T1", "max31865", "spi1", "PA6"); /* what its own bus reads */
    refused(ERR_CONFLICT, "chan", 1, "select", "PA6", pin_twice);
    device(1, "T3", "ds18b20", "wire1", "28000005e2fdc3");
    device(2, "S", "level", "-", "PC6");
    refused(ERR_CONFLICT, "chan", 2, "select", "PC6", pin_twice);
}

static void a_bus_cannot_have_a_pin_of_a_device(void)
{
    device(1, "S", "level", "-", "PA7");
    device(2, "T1", "max31865", "spi1", "PA4");
    refused(ERR_CONFLICT, "chan", 2, "bus", "T1",
            "needs a pin that is taken by another device or output");
}

static void an_address_must_be_one(void)
{
    static const char *const wrong[] = {"0x07", "0x78", "48", "PA4"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        device(1, "U", "ads1115", "i2c1", wrong[i]);
        refused(ERR_RANGE, "chan", 1, "select", wrong[i],
                "must be its address on the bus, 0x08 to 0x77");
    }
}

static void a_number_on_a_wire_must_be_whole(void)
{
    device(1, "T3", "ds18b20", "wire1", "28000005e2fdc");
    refused(ERR_RANGE, "chan", 1, "select", "28000005e2fdc",
            "must be family and serial number, 14 digits: 28000005e2fdc3");
}

static void an_address_is_of_one_chip(void)
{
    device(1, "U", "ads1115", "i2c1", "0x4A");
    device(2, "P", "bme280", "i2c1", "0x4A");
    refused(ERR_CONFLICT, "chan", 2, "select", "0x4A", "is the address of another chip as well");
    device(2, "P", "bme280", "i2c1", "0x4a");
    refused(ERR_CONFLICT, "chan", 2, "select", "0x4a", "is the address of another chip as well");
}

static void an_input_is_read_once(void)
{
    device(1, "U1", "ads1115", "i2c1", "0x4A");
    device(2, "U2", "ads1115", "i2c1", "0x4A");
    refused(ERR_CONFLICT, "chan", 2, "input", "U2", "is read by another channel already");
    device(2, "U2", "ads1115", "i2c1", "0x4a");
    refused(ERR_CONFLICT, "chan", 2, "input", "U2", "is read by another channel already");
    device(1, "T1", "ds18b20", "wire1", "28000005e2fdc3");
    device(2, "T2", "ds18b20", "wire1", "28000005E2FDC3");
    refused(ERR_CONFLICT, "chan", 2, "input", "T2", "is read by another channel already");
}

static void a_signal_must_have_a_span(void)
{
    device(1, "T1", "max31865", "spi1", "PA4");
    set("chan1.lo", "100");
    refused(ERR_RANGE, "chan", 1, "lo", "T1", "must be below hi");
    set("chan1.lo", "200");
    refused(ERR_RANGE, "chan", 1, "lo", "T1", "must be below hi");
}

/* ---- outputs refused ---- */

static void an_output_must_be_named_once(void)
{
    output(1, "Q", "window", "PB0");
    output(8, "Q", "window", "PB1");
    refused(ERR_CONFLICT, "out", 8, "name", "Q", "is used twice");
}

static void a_named_output_must_have_a_kind(void)
{
    set("out1.name", "Q");
    refused(ERR_EMPTY, "out", 1, "kind", "Q", "must say what is done with the pin");
}

static void an_output_must_have_its_pins(void)
{
    output(1, "Q", "window", "-");
    refused(ERR_CONFLICT, "out", 1, "pin", "Q", "a pin is missing");
    output(1, "V", "motor_valve", "PB0");
    refused(ERR_CONFLICT, "out", 1, "pin2", "V", "a pin is missing");
    set("out1.pin2", "PB0");
    refused(ERR_CONFLICT, "out", 1, "pin2", "V", "the output has the same pin twice");
}

static void an_output_must_have_a_free_pin(void)
{
    output(1, "Q", "window", "PA13");
    refused(ERR_CONFLICT, "out", 1, "pin", "Q",
            "the pin is not free: this board lacks it, or something else needs it");
}

static void two_outputs_cannot_have_one_pin(void)
{
    output(1, "Q", "window", "PB0");
    output(2, "V", "motor_valve", "PB1");
    set("out2.pin2", "PC0");
    set("out2.end_closed", "PB0");
    refused(ERR_CONFLICT, "out", 2, "end_closed", "V", "another output has the same pin");
}

static void an_output_cannot_have_a_pin_of_a_device_or_of_its_bus(void)
{
    device(1, "T1", "max31865", "spi1", "PA4");
    output(1, "Q", "window", "PA4");
    refused(ERR_CONFLICT, "out", 1, "pin", "Q", pin_twice);
    output(1, "Q", "window", "PA5");
    refused(ERR_CONFLICT, "out", 1, "pin", "Q", pin_twice);
}

static void chip(unsigned i, const char *name, const char *clear, const char *select,
                 const char *bus)
{
    output(i, name, "ad5422", clear);
    set_of("out", i, "pin2", select);
    set_of("out", i, "bus", bus);
}

static void a_chip_shares_its_bus_with_devices_and_other_chips(void)
{
    device(1, "T1", "max31865", "spi1", "PA4");
    chip(1, "V", "PB0", "PB1", "spi1");
    chip(2, "W", "PC0", "PC1", "spi1");
    accepted();
}

static void a_chip_must_have_a_clear_pin_and_a_bus_that_is_there(void)
{
    chip(1, "V", "-", "PB1", "spi1");
    refused(ERR_CONFLICT, "out", 1, "pin", "V",
            "the chip has no watchdog of its own, so its clear pin is needed to let it fall");
    chip(1, "V", "PB0", "PB1", "-");
    refused(ERR_CONFLICT, "out", 1, "kind", "V", "its chip needs an SPI bus");
}

static void a_chip_takes_the_pins_of_its_bus(void)
{
    output(1, "Q", "window", "PA5");
    chip(2, "V", "PB0", "PB1", "spi1");
    refused(ERR_CONFLICT, "out", 2, "bus", "V",
            "needs a pin that is taken by another device or output");
}

static void a_chip_cannot_have_the_select_of_a_device(void)
{
    device(1, "T1", "max31865", "spi1", "PA4");
    chip(1, "V", "PB0", "PA4", "spi1");
    refused(ERR_CONFLICT, "out", 1, "pin2", "V", pin_twice);
}

static void bursts_share_their_zero_crossings_and_devices_do_not(void)
{
    output(1, "Q", "burst", "PB0");
    set("out1.zero_cross", "PC0");
    output(2, "R", "burst", "PB1");
    set("out2.zero_cross", "PC0");
    accepted();
    device(1, "F", "flow", "-", "PC0");
    refused(ERR_CONFLICT, "out", 1, "zero_cross", "Q", pin_twice);
}

static void there_is_one_enable_output(void)
{
    output(1, "E1", "enable", "PB0");
    set("out1.least_off", "2");
    set("out2.least_off", "2");
    output(2, "E2", "enable", "PB1");
    refused(ERR_CONFLICT, "out", 2, "kind", "E2", "another output is the enable output already");
}

static void a_number_outside_its_range_is_named(void)
{
    output(1, "Q", "window", "PB0");
    config.pins.output[0].settings.period = 1000.0f;
    refused(ERR_RANGE, "out", 1, "period", "Q", "a number is outside its range");
}

static void an_output_must_have_a_span(void)
{
    output(1, "Q", "window", "PB0");
    set("out1.hi", "0");
    refused(ERR_RANGE, "out", 1, "lo", "Q", "must be below hi");
}

/* ---- what the device's own kind would refuse, later and without a word ---- */

static void an_analogue_input_must_be_at_a_pin_that_has_one(void)
{
    device(1, "U", "analog", "-", "PC8");
    refused(ERR_RANGE, "chan", 1, "select", "PC8", "has no analogue input");
}

static void a_pulse_width_must_be_at_a_pin_with_a_timer_that_makes_it(void)
{
    output(1, "Fan", "pwm", "PA4");
    refused(ERR_CONFLICT, "out", 1, "pin", "Fan",
            "the pin has no timer for a pulse width, or not with this frequency");
    output(1, "V", "analog", "PC0");
    refused(ERR_CONFLICT, "out", 1, "pin", "V",
            "the pin has no timer for a pulse width, or not with this frequency");
    output(1, "V", "analog", "PA1");
    accepted();
}

static void pulse_widths_of_one_timer_have_one_frequency_and_a_channel_each(void)
{
    output(1, "F1", "pwm", "PB0");
    output(2, "F2", "pwm", "PC7");
    accepted();
    set("out2.frequency", "500");
    refused(ERR_CONFLICT, "out", 2, "pin", "F2",
            "another output of the pin's timer has another frequency");
    output(2, "F2", "pwm", "PB6"); /* of another timer */
    accepted();
    output(2, "F2", "pwm", "PC8");
    set("out2.frequency", "1000");
    set("out1.frequency", "1000");
    refused(ERR_CONFLICT, "out", 2, "pin", "F2",
            "another output has the same channel of the pin's timer");
}

static void a_thermocouple_must_have_its_type(void)
{
    device(1, "T1", "max31856", "spi1", "PA4");
    refused(ERR_RANGE, "chan", 1, "type", "T1", "must be one that the device can have");
    set("chan1.type", "3wire");
    refused(ERR_RANGE, "chan", 1, "type", "T1", "must be one that the device can have");
    set("chan1.type", "N");
    accepted();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_board_with_nothing_at_its_pins_is_accepted);
    RUN_TEST(a_device_of_every_kind_and_an_output_of_every_kind_are_accepted);
    RUN_TEST(devices_share_a_bus);
    RUN_TEST(inputs_of_one_chip_are_several_channels);
    RUN_TEST(pressure_and_temperature_of_one_barometer_are_two_channels);
    RUN_TEST(one_address_on_two_buses_is_two_chips);
    RUN_TEST(what_has_no_name_is_not_looked_at);
    RUN_TEST(a_device_must_be_named_once);
    RUN_TEST(a_named_channel_must_have_a_device);
    RUN_TEST(a_device_must_be_on_a_bus_that_it_speaks);
    RUN_TEST(a_select_must_be_a_free_pin);
    RUN_TEST(two_devices_cannot_have_one_pin);
    RUN_TEST(a_device_cannot_have_a_pin_of_a_bus);
    RUN_TEST(a_bus_cannot_have_a_pin_of_a_device);
    RUN_TEST(an_address_must_be_one);
    RUN_TEST(a_number_on_a_wire_must_be_whole);
    RUN_TEST(an_address_is_of_one_chip);
    RUN_TEST(an_input_is_read_once);
    RUN_TEST(a_signal_must_have_a_span);
    RUN_TEST(an_output_must_be_named_once);
    RUN_TEST(a_named_output_must_have_a_kind);
    RUN_TEST(an_output_must_have_its_pins);
    RUN_TEST(an_output_must_have_a_free_pin);
    RUN_TEST(two_outputs_cannot_have_one_pin);
    RUN_TEST(an_output_cannot_have_a_pin_of_a_device_or_of_its_bus);
    RUN_TEST(a_chip_shares_its_bus_with_devices_and_other_chips);
    RUN_TEST(a_chip_must_have_a_clear_pin_and_a_bus_that_is_there);
    RUN_TEST(a_chip_takes_the_pins_of_its_bus);
    RUN_TEST(a_chip_cannot_have_the_select_of_a_device);
    RUN_TEST(bursts_share_their_zero_crossings_and_devices_do_not);
    RUN_TEST(there_is_one_enable_output);
    RUN_TEST(a_number_outside_its_range_is_named);
    RUN_TEST(an_output_must_have_a_span);
    RUN_TEST(an_analogue_input_must_be_at_a_pin_that_has_one);
    RUN_TEST(a_pulse_width_must_be_at_a_pin_with_a_timer_that_makes_it);
    RUN_TEST(pulse_widths_of_one_timer_have_one_frequency_and_a_channel_each);
    RUN_TEST(a_thermocouple_must_have_its_type);
    return UNITY_END();
}
