/* DS18B20: traffic byte by byte, each fault, and the search for addresses.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include <string.h>

#include "devices/ds18b20/crc8.h"
#include "devices/ds18b20/ds18b20.h"
#include "devices/ds18b20/rom_search.h"
#include "scripted_bus.h"
#include "unity.h"

#define ROM     "28 AA 11 22 33 44 55 35"
#define ROM_2   "28 10 20 30 40 50 60 D6"
#define NO_ROM  "00 00 00 00 00 00 00 00"
#define SET_UP  "55 " ROM " 4E 7D C9 7F"
#define CONVERT "55 " ROM " 44"
#define READ    "55 " ROM " BE"

#define PAD_78 "E5 04 7D C9 7F FF 0F 10 B7"
#define PAD_25 "91 01 7D C9 7F FF 0F 10 DE"

static const struct device_settings settings = {
    .bus = 2, .rom = {0x28, 0xAA, 0x11, 0x22, 0x33, 0x44, 0x55, 0x35}};
static struct device d;

void setUp(void)
{
    script_clear();
    TEST_ASSERT_EQUAL(ERR_OK, device_open(&d, &ds18b20_kind, &settings, 1000));
}
void tearDown(void) {}

static float value_of(const struct device_result *r)
{
    float t = -1000;
    TEST_ASSERT_TRUE(ds18b20_kind.value(&settings, r->code, &t));
    return t;
}

/* One reading with this scratchpad, the first of a chip. */
static struct device_result first_reading(const char *scratchpad)
{
    script(SET_UP, "");
    script(CONVERT, "");
    script(READ, scratchpad);
    script_run(&d, 1000);
    script_is_done();
    return script_result(&d);
}

static void checksum_is_that_of_the_makers_example(void)
{
    /* Application note 27: 02 1C B8 01 00 00 00 has A2h. */
    const uint8_t rom[] = {0x02, 0x1C, 0xB8, 0x01, 0x00, 0x00, 0x00, 0xA2};
    TEST_ASSERT_EQUAL_HEX8(0xA2, crc8_onewire(rom, 7));
    TEST_ASSERT_EQUAL_HEX8(0, crc8_onewire(rom, 8));
}

static void each_single_bit_is_seen_by_the_checksum(void)
{
    uint8_t bytes[9] = {0xE5, 0x04, 0x7D, 0xC9, 0x7F, 0xFF, 0x0F, 0x10};
    bytes[8] = crc8_onewire(bytes, 8);
    for (unsigned bit = 0; bit < 72; bit++) {
        bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
        TEST_ASSERT_NOT_EQUAL(0, crc8_onewire(bytes, 9));
        bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
}

static void a_reading_is_set_up_conversion_and_scratchpad(void)
{
    struct device_result r = first_reading(PAD_78);
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    TEST_ASSERT_EQUAL_FLOAT(78.3125f, value_of(&r));
    TEST_ASSERT_EQUAL(DEVICE_ONEWIRE, script_seen.line);
    TEST_ASSERT_EQUAL(2, script_seen.bus);
    TEST_ASSERT_EQUAL(script_began_ms(1), r.stamp_ms);
    TEST_ASSERT_GREATER_OR_EQUAL(750, script_began_ms(2) - script_began_ms(1));
}

static void set_up_is_written_once(void)
{
    first_reading(PAD_78);
    script(CONVERT, "");
    script(READ, PAD_25);
    script_run(&d, 1000);
    script_is_done();
    struct device_result r = script_result(&d);
    TEST_ASSERT_EQUAL(2, r.number);
    TEST_ASSERT_EQUAL_FLOAT(25.0625f, value_of(&r));
    TEST_ASSERT_EQUAL(1000, script_began_ms(3) - script_began_ms(0));
}

static void temperatures_below_0_have_a_sign(void)
{
    struct device_result r = first_reading("5E FF 7D C9 7F FF 02 10 4D");
    TEST_ASSERT_EQUAL_FLOAT(-10.125f, value_of(&r));
}

static void a_temperature_of_85_degrees_is_good(void)
{
    struct device_result r = first_reading("50 05 7D C9 7F FF 10 10 46");
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    TEST_ASSERT_EQUAL_FLOAT(85, value_of(&r));
}

static void the_85_degrees_of_power_on_are_none(void)
{
    TEST_ASSERT_EQUAL_HEX16(DEVICE_POWER_ON, first_reading("50 05 7D C9 7F FF 0C 10 E7").faults);
}

static void a_chip_without_its_mark_has_lost_power_and_is_set_up_again(void)
{
    static const char *const lost[] = {"50 05 4B 46 7F FF 0C 10 1C", "50 05 4B 46 7F FF FF 10 D0",
                                       "40 01 4B 46 7F FF 0C 10 BC", "40 01 7D 46 7F FF 0F 10 B6",
                                       "40 01 4B C9 7F FF 0F 10 4D"};
    for (unsigned k = 0; k < 5; k++) {
        setUp();
        first_reading(PAD_78);
        script(CONVERT, "");
        script(READ, lost[k]);
        script_run(&d, 1000);
        TEST_ASSERT_EQUAL_HEX16(DEVICE_POWER_ON, script_result(&d).faults);
        script(SET_UP, "");
        script(CONVERT, "");
        script(READ, PAD_25);
        script_run(&d, 1000);
        script_is_done();
        TEST_ASSERT_EQUAL_HEX16(0, script_result(&d).faults);
    }
}

static void a_chip_without_12_bits_is_the_wrong_one(void)
{
    TEST_ASSERT_EQUAL_HEX16(DEVICE_WRONG_CHIP, first_reading("90 01 7D C9 1F FF 0C 10 58").faults);
}

static void a_wrong_checksum_is_read_again(void)
{
    script(SET_UP, "");
    script(CONVERT, "");
    script(READ, "E5 04 7D C9 7F FF 0F 10 00");
    script(READ, PAD_78);
    script_run(&d, 1000);
    script_is_done();
    struct device_result r = script_result(&d);
    TEST_ASSERT_EQUAL_HEX16(0, r.faults);
    TEST_ASSERT_EQUAL_FLOAT(78.3125f, value_of(&r));
}

static void a_checksum_that_is_wrong_twice_is_a_fault(void)
{
    script(SET_UP, "");
    script(CONVERT, "");
    script(READ, "E5 04 7D C9 7F FF 0F 10 00");
    script(READ, "E5 04 7D C9 7F FF 0F 10 01");
    script_run(&d, 1000);
    script_is_done();
    TEST_ASSERT_EQUAL_HEX16(DEVICE_CHECKSUM, script_result(&d).faults);
}

static void no_presence_pulse_is_no_chip(void)
{
    script_fails(SET_UP, 0, TRANSFER_NO_ANSWER);
    script_run(&d, 1000);
    script_is_done();
    TEST_ASSERT_EQUAL_HEX16(DEVICE_NO_CHIP, script_result(&d).faults);
}

/* Others answer the reset, nobody this address. */
static void ones_alone_are_no_chip(void)
{
    TEST_ASSERT_EQUAL_HEX16(DEVICE_NO_CHIP, first_reading("FF FF FF FF FF FF FF FF FF").faults);
}

/* Their checksum is right. */
static void zeros_alone_are_a_failure_of_the_bus(void)
{
    TEST_ASSERT_EQUAL_HEX16(DEVICE_BUS, first_reading("00 00 00 00 00 00 00 00 00").faults);
}

static void a_transfer_that_does_not_end_is_stopped(void)
{
    script(SET_UP, "");
    script(CONVERT, "");
    script_fails(READ, 9, SCRIPT_NEVER_ENDS);
    script_run(&d, 1000);
    script_is_done();
    TEST_ASSERT_EQUAL_HEX16(DEVICE_BUS, script_result(&d).faults);
    TEST_ASSERT_EQUAL(1, script_seen.stops);
}

static void two_chips_on_a_wire_convert_at_the_same_time(void)
{
    struct device_settings second = {.bus = 2,
                                     .rom = {0x28, 0x10, 0x20, 0x30, 0x40, 0x50, 0x60, 0xD6}};
    static struct device e;
    struct device *both[] = {&d, &e};
    TEST_ASSERT_EQUAL(ERR_OK, device_open(&e, &ds18b20_kind, &second, 1000));
    script(SET_UP, "");
    script(CONVERT, "");
    script("55 " ROM_2 " 4E 7D C9 7F", "");
    script("55 " ROM_2 " 44", "");
    script(READ, PAD_78);
    script("55 " ROM_2 " BE", PAD_25);
    script_run_several(both, 2, 1000);
    script_is_done();
    TEST_ASSERT_EQUAL(78 * 16 + 5, script_result(&d).code[0]);
    TEST_ASSERT_EQUAL(25 * 16 + 1, script_result(&e).code[0]);
}

static void addresses_that_are_none_of_this_chip_are_refused(void)
{
    struct device_settings s = settings;
    s.rom[7] ^= 1;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &ds18b20_kind, &s, 1000));
    const uint8_t ds18s20[] = {0x10, 0xAA, 0x11, 0x22, 0x33, 0x44, 0x55, 0xD0};
    memcpy(s.rom, ds18s20, sizeof ds18s20);
    TEST_ASSERT_EQUAL_HEX8(0, crc8_onewire(ds18s20, 8));
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &ds18b20_kind, &s, 1000));
    script_board.no_bus = true;
    TEST_ASSERT_EQUAL(ERR_RANGE, device_open(&d, &ds18b20_kind, &settings, 1000));
}

static void temperatures_beyond_the_chip_are_none(void)
{
    float t = 7;
    TEST_ASSERT_FALSE(ds18b20_kind.value(&settings, (const int32_t[DEVICE_CODES]){2001}, &t));
    TEST_ASSERT_FALSE(ds18b20_kind.value(&settings, (const int32_t[DEVICE_CODES]){-881}, &t));
    TEST_ASSERT_EQUAL_FLOAT(7, t);
    TEST_ASSERT_TRUE(ds18b20_kind.value(&settings, (const int32_t[DEVICE_CODES]){2000}, &t));
    TEST_ASSERT_EQUAL_FLOAT(125, t);
    TEST_ASSERT_TRUE(ds18b20_kind.value(&settings, (const int32_t[DEVICE_CODES]){-880}, &t));
    TEST_ASSERT_EQUAL_FLOAT(-55, t);
}

/* ---- search ---- */

static struct rom_search search;

static void run_search(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, rom_search_begin(&search, 2));
    for (unsigned k = 0; k < 2000 && search.state == ROM_SEARCH_RUNS; k++)
        rom_search_clock(&search, script_board.now_ms++);
}

static void a_search_finds_all_addresses(void)
{
    script_search(NO_ROM, 0, ROM, 9);
    script_search(ROM, 9, ROM_2, 0);
    run_search();
    script_is_done();
    TEST_ASSERT_EQUAL(ROM_SEARCH_DONE, search.state);
    TEST_ASSERT_EQUAL(2, search.found);
    TEST_ASSERT_GREATER_OR_EQUAL(19, script_began_ms(1) - script_began_ms(0)); /* of a pass */
    TEST_ASSERT_TRUE(ds18b20_is_address(search.rom[0]));
    TEST_ASSERT_EQUAL_MEMORY(settings.rom, search.rom[0], 8);
    TEST_ASSERT_EQUAL_HEX8(0x10, search.rom[1][1]);
}

static void a_search_on_an_empty_wire_finds_nothing(void)
{
    script_fails("", 8, TRANSFER_NO_ANSWER);
    run_search();
    TEST_ASSERT_EQUAL(ROM_SEARCH_DONE, search.state);
    TEST_ASSERT_EQUAL(0, search.found);
}

static void a_disturbed_pass_is_made_again_from_where_it_began(void)
{
    script_search(NO_ROM, 0, ROM, 9);
    script_search(ROM, 9, "28 10 20 30 40 50 61 D6", 4);
    script_search(ROM, 9, ROM_2, 0);
    run_search();
    script_is_done();
    TEST_ASSERT_EQUAL(ROM_SEARCH_DONE, search.state);
    TEST_ASSERT_EQUAL(2, search.found);
}

static void a_search_gives_up_after_three_wrong_addresses(void)
{
    for (unsigned k = 0; k < 3; k++)
        script_search(NO_ROM, 0, "28 10 20 30 40 50 61 D6", 4);
    run_search();
    script_is_done();
    TEST_ASSERT_EQUAL(ROM_SEARCH_CHECKSUM, search.state);
    TEST_ASSERT_EQUAL(0, search.found);
}

static void a_shorted_wire_ends_a_search(void)
{
    for (unsigned k = 0; k < 3; k++)
        script_search(NO_ROM, 0, "00 00 00 00 00 00 00 00", 0);
    run_search();
    script_is_done();
    TEST_ASSERT_EQUAL(ROM_SEARCH_FAILED, search.state);
}

static void a_pass_that_does_not_end_is_stopped(void)
{
    script_fails("", 8, SCRIPT_NEVER_ENDS);
    run_search();
    TEST_ASSERT_EQUAL(ROM_SEARCH_FAILED, search.state);
    TEST_ASSERT_EQUAL(1, script_seen.stops);
}

static void a_pass_that_fails_ends_a_search(void)
{
    script_search(NO_ROM, 0, ROM, 9);
    script_fails("", 8, TRANSFER_FAILED);
    run_search();
    script_is_done();
    TEST_ASSERT_EQUAL(ROM_SEARCH_FAILED, search.state);
    TEST_ASSERT_EQUAL(1, search.found);
}

static void a_search_on_a_wire_that_is_never_free_ends(void)
{
    script_board.busy = 1000000;
    run_search();
    TEST_ASSERT_EQUAL(ROM_SEARCH_FAILED, search.state);
}

static void more_chips_than_a_search_can_hold_are_told(void)
{
    for (uint8_t k = 0; k < ROM_SEARCH_MAX; k++)
        script_search(k == 0 ? NO_ROM : ROM, k, ROM, (uint8_t)(k + 1));
    run_search();
    script_is_done();
    TEST_ASSERT_EQUAL(ROM_SEARCH_FULL, search.state);
    TEST_ASSERT_EQUAL(ROM_SEARCH_MAX, search.found);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(checksum_is_that_of_the_makers_example);
    RUN_TEST(each_single_bit_is_seen_by_the_checksum);
    RUN_TEST(a_reading_is_set_up_conversion_and_scratchpad);
    RUN_TEST(set_up_is_written_once);
    RUN_TEST(temperatures_below_0_have_a_sign);
    RUN_TEST(a_temperature_of_85_degrees_is_good);
    RUN_TEST(the_85_degrees_of_power_on_are_none);
    RUN_TEST(a_chip_without_its_mark_has_lost_power_and_is_set_up_again);
    RUN_TEST(a_chip_without_12_bits_is_the_wrong_one);
    RUN_TEST(a_wrong_checksum_is_read_again);
    RUN_TEST(a_checksum_that_is_wrong_twice_is_a_fault);
    RUN_TEST(no_presence_pulse_is_no_chip);
    RUN_TEST(ones_alone_are_no_chip);
    RUN_TEST(zeros_alone_are_a_failure_of_the_bus);
    RUN_TEST(a_transfer_that_does_not_end_is_stopped);
    RUN_TEST(two_chips_on_a_wire_convert_at_the_same_time);
    RUN_TEST(addresses_that_are_none_of_this_chip_are_refused);
    RUN_TEST(temperatures_beyond_the_chip_are_none);
    RUN_TEST(a_search_finds_all_addresses);
    RUN_TEST(a_search_on_an_empty_wire_finds_nothing);
    RUN_TEST(a_disturbed_pass_is_made_again_from_where_it_began);
    RUN_TEST(a_search_gives_up_after_three_wrong_addresses);
    RUN_TEST(a_shorted_wire_ends_a_search);
    RUN_TEST(a_pass_that_does_not_end_is_stopped);
    RUN_TEST(a_pass_that_fails_ends_a_search);
    RUN_TEST(a_search_on_a_wire_that_is_never_free_ends);
    RUN_TEST(more_chips_than_a_search_can_hold_are_told);
    return UNITY_END();
}
