/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* Pins, addresses and numbers on a wire as people write them, and the words of devices, buses and outputs in the table of settings. */
#include <stdio.h>
#include <string.h>

#include "devices/device.h"
#include "exchange/config.h"
#include "io/board_devices.h"
#include "settings/parameter_table.h"
#include "settings/parameters.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

/* ---- texts ---- */

static void a_pin_is_its_port_and_number(void)
{
    static const struct {
        const char *text;
        unsigned pin;
    } known[] = {{"PA0", 0}, {"PA9", 9}, {"PA15", 15}, {"PB0", 16}, {"PC13", 45}, {"PI15", 143}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        uint8_t pin = 0xFF;
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, pins_parse_pin(known[i].text, &pin), known[i].text);
        TEST_ASSERT_EQUAL_UINT8_MESSAGE(known[i].pin, pin, known[i].text);
    }
}

static void what_is_no_pin_is_refused(void)
{
    static const char *const texts[] = {"",
                                        "P",
                                        "PA",
                                        "A4",
                                        "pa4",
                                        "Pa4",
                                        "PJ0",
                                        "P4",
                                        "PA16",
                                        "PA04",
                                        "PA00",
                                        "PA4 ",
                                        " PA4",
                                        "PA-1",
                                        "PA1x",
                                        "PA100",
                                        "PA999999999999",
                                        "-",
                                        "0x04"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        uint8_t pin = 0xA5;
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_PARSE, pins_parse_pin(texts[i], &pin), texts[i]);
        TEST_ASSERT_EQUAL_HEX8_MESSAGE(0xA5, pin, texts[i]);
    }
}

static void an_address_has_two_digits_of_either_case(void)
{
    static const struct {
        const char *text;
        unsigned address;
    } known[] = {{"0x08", 0x08}, {"0x48", 0x48}, {"0x4A", 0x4A}, {"0x4a", 0x4A}, {"0x77", 0x77}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        uint8_t address = 0;
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, pins_parse_address(known[i].text, &address),
                                      known[i].text);
        TEST_ASSERT_EQUAL_HEX8_MESSAGE(known[i].address, address, known[i].text);
    }
}

static void what_is_no_address_is_refused(void)
{
    static const char *const texts[] = {"",     "0x",   "0x4", "0x480", "48",  "0X48",
                                        "0x4g", "0xg4", "72",  "PA4",   "0x 8"};
    static const char *const reserved[] = {"0x00", "0x07", "0x78", "0x7F", "0xFF"};
    uint8_t address = 0xA5;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_PARSE, pins_parse_address(texts[i], &address), texts[i]);
    for (size_t i = 0; i < sizeof reserved / sizeof *reserved; i++)
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_RANGE, pins_parse_address(reserved[i], &address),
                                      reserved[i]);
    TEST_ASSERT_EQUAL_HEX8(0xA5, address);
}

/* CRC-8 by long division, the message as one row of bits: what is left of x^8 times it by x^8 + x^5 + x^4 + 1. */
static uint8_t remainder_of(const uint8_t *bytes, unsigned n)
{
    bool row[64 + 8] = {false};
    for (unsigned i = 0; i < 8 * n; i++)
        row[i] = ((unsigned)bytes[i / 8] >> i % 8 & 1u) != 0;
    for (unsigned i = 0; i < 8 * n; i++)
        if (row[i]) {
            row[i] = false;
            row[i + 3] = !row[i + 3]; /* x^5 */
            row[i + 4] = !row[i + 4]; /* x^4 */
            row[i + 8] = !row[i + 8]; /* 1 */
        }
    uint8_t crc = 0;
    for (unsigned i = 0; i < 8; i++)
        crc |= (uint8_t)(row[8 * n + i] << i);
    return crc;
}

static void a_number_on_a_wire_gets_its_checksum(void)
{
    /* The example of Maxim's application note 27: family 02h, serial number 1CB801h, checksum A2h (unverified). */
    static const uint8_t example[PINS_ROM_BYTES] = {0x02, 0x1C, 0xB8, 0x01, 0, 0, 0, 0xA2};
    uint8_t rom[PINS_ROM_BYTES];
    TEST_ASSERT_EQUAL_INT(ERR_OK, pins_parse_rom("0200000001b81c", rom));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(example, rom, sizeof rom);
    static const uint8_t serial[7] = {0x28, 0xC3, 0xFD, 0xE2, 0x05, 0x00, 0x00};
    TEST_ASSERT_EQUAL_INT(ERR_OK, pins_parse_rom("28000005E2fdC3", rom));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(serial, rom, sizeof serial);
    TEST_ASSERT_EQUAL_HEX8(remainder_of(serial, sizeof serial), rom[7]);
}

static void what_is_no_number_on_a_wire_is_refused(void)
{
    static const char *const texts[] = {"",
                                        "28",
                                        "28000005e2fdc",
                                        "28000005e2fdc33",
                                        "28-00005e2fdc3",
                                        "28000005e2fdcg",
                                        "2800 005e2fdc3",
                                        "0x000005e2fdc3"};
    uint8_t rom[PINS_ROM_BYTES];
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_PARSE, pins_parse_rom(texts[i], rom), texts[i]);
}

static void a_number_on_a_wire_fits_into_a_setting(void)
{
    TEST_ASSERT_GREATER_THAN(2u * (PINS_ROM_BYTES - 1u), CHANNEL_NAME_SIZE);
}

/* ---- words ---- */

/* Word number i of a field. */
static const char *word(const char *name, unsigned i, char *to, size_t size)
{
    struct parameter p;
    TEST_ASSERT_EQUAL_INT(ERR_OK, parameter_find(name, &p));
    const char *s = parameter_word_list(&p);
    for (; i > 0; i--) {
        s = strchr(s, '|');
        if (s == NULL)
            return NULL;
        s++;
    }
    (void)snprintf(to, size, "%.*s", (int)strcspn(s, "|"), s);
    return to;
}

static void every_word_of_a_device_is_the_name_of_its_kind(void)
{
    static const enum bus_family families[] = {[DEVICE_NO_LINE] = BUS_FAMILY_PINS,
                                               [DEVICE_SPI] = BUS_FAMILY_SPI,
                                               [DEVICE_I2C] = BUS_FAMILY_I2C,
                                               [DEVICE_ONEWIRE] = BUS_FAMILY_WIRE};
    char text[32];
    for (unsigned i = DEVICE_NONE + 1; i < DEVICE_WORDS; i++) {
        struct device_config row = {.device = (uint8_t)i};
        const struct device_kind *kind = board_device_kind(&row);
        TEST_ASSERT_NOT_NULL(word("chan1.device", i, text, sizeof text));
        TEST_ASSERT_NOT_NULL_MESSAGE(kind, text);
        TEST_ASSERT_EQUAL_STRING(text, kind->name);
        TEST_ASSERT_EQUAL_INT_MESSAGE(families[kind->line], pins_device_family((enum device_word)i),
                                      text);
    }
    TEST_ASSERT_NULL(word("chan1.device", DEVICE_WORDS, text, sizeof text));
    struct device_config none = {.device = DEVICE_NONE}, beyond = {.device = DEVICE_WORDS};
    TEST_ASSERT_NULL(board_device_kind(&none));
    TEST_ASSERT_NULL(board_device_kind(&beyond));
}

static void every_word_of_a_bus_is_its_family_and_number(void)
{
    static const char *const names[] = {
        [BUS_FAMILY_SPI] = "spi", [BUS_FAMILY_I2C] = "i2c", [BUS_FAMILY_WIRE] = "wire"};
    char text[16], wanted[16];
    for (unsigned i = BUS_NONE + 1; i < BUS_WORDS; i++) {
        uint8_t number = 0;
        enum bus_family family = pins_bus_family((enum bus_word)i, &number);
        TEST_ASSERT_NOT_EQUAL_INT(BUS_FAMILY_PINS, family);
        (void)snprintf(wanted, sizeof wanted, "%s%u", names[family], number);
        TEST_ASSERT_EQUAL_STRING(wanted, word("chan1.bus", i, text, sizeof text));
    }
    TEST_ASSERT_NULL(word("chan1.bus", BUS_WORDS, text, sizeof text));
    uint8_t number = 9;
    TEST_ASSERT_EQUAL_INT(BUS_FAMILY_PINS, pins_bus_family(BUS_NONE, &number));
    TEST_ASSERT_EQUAL_UINT8(0, number);
}

static void every_word_of_a_pin_is_the_pin(void)
{
    static const char *const fields[] = {"out1.pin", "out1.pin2", "out1.end_open",
                                         "out1.end_closed", "out1.zero_cross"};
    char text[16];
    for (size_t k = 0; k < sizeof fields / sizeof *fields; k++) {
        TEST_ASSERT_EQUAL_STRING("-", word(fields[k], 0, text, sizeof text));
        for (unsigned i = 1; word(fields[k], i, text, sizeof text) != NULL; i++) {
            uint8_t pin;
            TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, pins_parse_pin(text, &pin), text);
            TEST_ASSERT_EQUAL_UINT8_MESSAGE(pins_of_word((uint8_t)i), pin, text);
        }
    }
    TEST_ASSERT_EQUAL_HEX8(HAL_PIN_NONE, pins_of_word(0));
}

static void every_word_of_an_output_is_the_name_of_its_type(void)
{
    char text[32];
    for (unsigned i = OUTPUT_NONE + 1; i < OUTPUT_TYPES; i++)
        TEST_ASSERT_EQUAL_STRING(output_type_name((uint8_t)i),
                                 word("out1.kind", i, text, sizeof text));
    TEST_ASSERT_NULL(word("out1.kind", OUTPUT_TYPES, text, sizeof text));
}

/* ---- settings of devices ---- */

/* The settings that a kind gets from a row with this word of chan.type. */
static struct device_settings settings_of(enum device_word device, const char *type)
{
    struct config config;
    struct parameter p;
    parameters_defaults(&config);
    config.pins.device[0].device = (uint8_t)device;
    config.pins.device[0].bus = BUS_SPI1;
    (void)strcpy(config.pins.device[0].select, "PA4");
    TEST_ASSERT_EQUAL_INT(ERR_OK, parameter_find("chan1.type", &p));
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, parameter_set(&p, &config, type), type);
    return board_device_settings(&config.pins, &config.pins.device[0]);
}

static void a_thermocouple_has_the_letter_of_its_type(void)
{
    for (const char *letter = "BEJKNRST"; *letter != '\0'; letter++) {
        char type[2] = {*letter, '\0'};
        struct device_settings s = settings_of(DEVICE_MAX31856, type);
        TEST_ASSERT_EQUAL_CHAR(*letter, (char)s.type);
    }
}

static void a_thermometer_has_the_number_of_its_wires(void)
{
    TEST_ASSERT_EQUAL_UINT8(2, settings_of(DEVICE_MAX31865, "2wire").type);
    TEST_ASSERT_EQUAL_UINT8(3, settings_of(DEVICE_MAX31865, "3wire").type);
    TEST_ASSERT_EQUAL_UINT8(4, settings_of(DEVICE_MAX31865, "4wire").type);
}

static void a_thermometer_is_a_pt100_at_430_ohm_unless_it_is_said(void)
{
    struct config config;
    parameters_defaults(&config);
    struct device_config *row = &config.pins.device[0];
    row->device = DEVICE_MAX31865;
    struct device_settings s = board_device_settings(&config.pins, row);
    TEST_ASSERT_EQUAL_FLOAT(100.0f, s.nominal);
    TEST_ASSERT_EQUAL_FLOAT(430.0f, s.reference);
    row->nominal = 1000.0f;
    s = board_device_settings(&config.pins, row);
    TEST_ASSERT_EQUAL_FLOAT(4300.0f, s.reference);
    row->reference = 4000.0f;
    s = board_device_settings(&config.pins, row);
    TEST_ASSERT_EQUAL_FLOAT(4000.0f, s.reference);
}

/* ---- settings of outputs ---- */

static void an_output_without_a_name_is_not_used(void)
{
    struct config config;
    parameters_defaults(&config);
    config.pins.output[2].settings.type = OUTPUT_WINDOW;
    TEST_ASSERT_EQUAL_UINT8(OUTPUT_NONE, pins_output(&config.pins, 2).type);
    (void)strcpy(config.pins.output[2].name, "Q");
    TEST_ASSERT_EQUAL_UINT8(OUTPUT_WINDOW, pins_output(&config.pins, 2).type);
}

static void an_output_has_its_pins_and_the_mains_of_the_board(void)
{
    struct config config;
    parameters_defaults(&config);
    struct output_config *o = &config.pins.output[0];
    (void)strcpy(o->name, "Q");
    o->settings.type = OUTPUT_MOTOR_VALVE;
    o->settings.pin[0] = HAL_PIN('B', 0) + 1u;
    o->settings.pin[1] = HAL_PIN('A', 0) + 1u;
    struct output_settings s = pins_output(&config.pins, 0);
    TEST_ASSERT_EQUAL_UINT8(HAL_PIN('B', 0), s.pin[OUTPUT_PIN]);
    TEST_ASSERT_EQUAL_UINT8(HAL_PIN('A', 0), s.pin[OUTPUT_SECOND_PIN]);
    TEST_ASSERT_EQUAL_HEX8(HAL_PIN_NONE, s.pin[OUTPUT_OPEN_END]);
    TEST_ASSERT_FALSE(s.mains_60);
    config.pins.mains_60 = 1;
    TEST_ASSERT_TRUE(pins_output(&config.pins, 0).mains_60);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_pin_is_its_port_and_number);
    RUN_TEST(what_is_no_pin_is_refused);
    RUN_TEST(an_address_has_two_digits_of_either_case);
    RUN_TEST(what_is_no_address_is_refused);
    RUN_TEST(a_number_on_a_wire_gets_its_checksum);
    RUN_TEST(what_is_no_number_on_a_wire_is_refused);
    RUN_TEST(a_number_on_a_wire_fits_into_a_setting);
    RUN_TEST(every_word_of_a_device_is_the_name_of_its_kind);
    RUN_TEST(every_word_of_a_bus_is_its_family_and_number);
    RUN_TEST(every_word_of_a_pin_is_the_pin);
    RUN_TEST(every_word_of_an_output_is_the_name_of_its_type);
    RUN_TEST(a_thermocouple_has_the_letter_of_its_type);
    RUN_TEST(a_thermometer_has_the_number_of_its_wires);
    RUN_TEST(a_thermometer_is_a_pt100_at_430_ohm_unless_it_is_said);
    RUN_TEST(an_output_without_a_name_is_not_used);
    RUN_TEST(an_output_has_its_pins_and_the_mains_of_the_board);
    return UNITY_END();
}
