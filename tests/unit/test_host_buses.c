/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* Buses and pins of the host keep what the headers of hal/ promise: with chips around them, and on an empty board. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "buses.h"
#include "chips/wired.h"
#include "hal/clock.h"
#include "hal/i2c.h"
#include "hal/onewire.h"
#include "hal/output.h"
#include "hal/pulse.h"
#include "hal/spi.h"
#include "unity.h"

#define WIRES 5u

static const char column[] = "T1 max31865 spi1 PA4\n"
                             "U  ads1115  i2c1 0x48 1\n"
                             "A  ds18b20  wire1 rom=28-000005e2fdc3\n"
                             "B  ds18b20  wire1 rom=28-000005e2fdc4\n"
                             "C  ds18b20  wire1 rom=28-0123456789ab\n"
                             "D  ds18b20  wire1 rom=28-ffffffffffff\n"
                             "E  ds18b20  wire1 rom=28-000000000000\n"
                             "Q  ssr      PB0\n"
                             "W  pwm      PB6\n"
                             "X  pwm      PB7 active=low\n"
                             "Z  relay    PB1 active=low\n";
enum { Q, W, X, Z, LOADS };

static uint64_t clock_ms;
static struct wired *world;

uint64_t hal_clock_ms(void)
{
    return clock_ms;
}

void setUp(void)
{
    char path[] = "/tmp/buses_test_XXXXXX", err[256] = "";
    int file = mkstemp(path);
    TEST_ASSERT_TRUE(file >= 0);
    TEST_ASSERT_EQUAL_INT((int)sizeof column - 1, (int)write(file, column, sizeof column - 1));
    (void)close(file);
    world = wired_open(path, 1, err, sizeof err);
    (void)remove(path);
    TEST_ASSERT_NOT_NULL_MESSAGE(world, err);
    clock_ms = 1000;
    buses_set_world(wired_world(world));
    buses_reset();
}

void tearDown(void)
{
    buses_reset();
    buses_set_world(NULL);
    wired_close(world);
}

/* Part of the next second that a load is on. */
static double part(unsigned load)
{
    double before[LOADS], after[LOADS];
    TEST_ASSERT_EQUAL_size_t(LOADS, wired_loads(world, clock_ms * 1000000u, before));
    clock_ms += 1000;
    (void)wired_loads(world, clock_ms * 1000000u, after);
    return (after[load] - before[load]) / 1e9;
}

/* ---- 1-wire ---- */

/* CRC-8 of a ROM is 0 over all 8 bytes of a right one. */
static uint8_t checksum(const uint8_t rom[ONEWIRE_ROM_BYTES])
{
    uint8_t crc = 0;
    for (unsigned i = 0; i < 64; i++) {
        unsigned feedback = (crc ^ (unsigned)(rom[i / 8] >> i % 8)) & 1u;
        crc = (uint8_t)(crc >> 1 ^ (feedback ? 0x8C : 0));
    }
    return crc;
}

static void a_search_finds_every_device_on_a_wire_once(void)
{
    uint8_t rom[ONEWIRE_ROM_BYTES] = {0};
    uint64_t found[WIRES];
    volatile uint8_t branch = 0;
    unsigned n = 0;
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_onewire_open(1));
    do {
        struct transfer t = {.in = rom, .n_in = sizeof rom};
        TEST_ASSERT_LESS_THAN_UINT(WIRES, n);
        TEST_ASSERT_EQUAL_INT(ERR_OK, hal_onewire_search(1, &t, &branch));
        TEST_ASSERT_EQUAL_UINT8(TRANSFER_DONE, t.state);
        TEST_ASSERT_EQUAL_HEX8(0x28, rom[0]);
        TEST_ASSERT_EQUAL_HEX8(0, checksum(rom));
        uint64_t serial = 0;
        for (unsigned k = 6; k >= 1; k--)
            serial = serial << 8 | rom[k];
        for (unsigned k = 0; k < n; k++)
            TEST_ASSERT_TRUE(found[k] != serial);
        found[n++] = serial;
    } while (branch != 0);
    static const uint64_t there[WIRES] = {0x000005e2fdc3, 0x000005e2fdc4, 0x0123456789ab,
                                          0xffffffffffff, 0};
    TEST_ASSERT_EQUAL_UINT(WIRES, n);
    for (unsigned i = 0; i < WIRES; i++) {
        unsigned times = 0;
        for (unsigned k = 0; k < n; k++)
            times += found[k] == there[i];
        TEST_ASSERT_EQUAL_UINT(1, times);
    }
}

static void a_wire_without_a_device_does_not_answer(void)
{
    uint8_t rom[ONEWIRE_ROM_BYTES] = {0}, skip = 0xCC;
    volatile uint8_t branch = 0;
    struct transfer t = {.in = rom, .n_in = sizeof rom};
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_onewire_search(2, &t, &branch));
    TEST_ASSERT_EQUAL_UINT8(TRANSFER_NO_ANSWER, t.state);
    t = (struct transfer){.out = &skip, .n_out = 1, .in = rom, .n_in = 2};
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_onewire_start(2, &t));
    TEST_ASSERT_EQUAL_UINT8(TRANSFER_NO_ANSWER, t.state);
}

static void a_device_on_a_wire_is_read_by_its_number(void)
{
    /* Match ROM, then read the scratchpad: 85 degC at power-on, 0550h (data sheet of the DS18B20, figure 4). */
    uint8_t out[10] = {0x55, 0x28, 0xC3, 0xFD, 0xE2, 0x05, 0, 0, 0, 0xBE}, in[2] = {0};
    for (unsigned crc = 0; crc < 256 && checksum(&out[1]) != 0; crc++)
        out[8] = (uint8_t)crc;
    TEST_ASSERT_EQUAL_HEX8(0, checksum(&out[1]));
    struct transfer t = {.out = out, .n_out = sizeof out, .in = in, .n_in = sizeof in};
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_onewire_start(1, &t));
    TEST_ASSERT_EQUAL_UINT8(TRANSFER_DONE, t.state);
    TEST_ASSERT_EQUAL_HEX8(0x50, in[0]);
    TEST_ASSERT_EQUAL_HEX8(0x05, in[1]);
}

/* ---- I2C ---- */

static enum transfer_state read_register(uint8_t bus, uint8_t address, uint8_t in[2])
{
    uint8_t config = 1;
    struct transfer t = {.out = &config, .n_out = 1, .in = in, .n_in = 2};
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_i2c_start(bus, address, &t));
    return (enum transfer_state)t.state;
}

static void i2c_reads_what_a_chip_has(void)
{
    uint8_t in[2] = {0};
    TEST_ASSERT_EQUAL_INT(TRANSFER_DONE, read_register(1, 0x48, in));
    TEST_ASSERT_EQUAL_HEX8(0x85, in[0]); /* configuration at power-on, 8583h (SBAS444, table 8) */
    TEST_ASSERT_EQUAL_HEX8(0x83, in[1]);
}

static void i2c_tells_that_nobody_answers(void)
{
    uint8_t in[2] = {0};
    TEST_ASSERT_EQUAL_INT(TRANSFER_NO_ANSWER, read_register(1, 0x49, in));
    TEST_ASSERT_EQUAL_INT(TRANSFER_NO_ANSWER, read_register(2, 0x48, in));
    TEST_ASSERT_EQUAL_INT(TRANSFER_DONE, read_register(1, 0x48, in)); /* the bus is free again */
}

/* ---- SPI ---- */

static void spi_reads_what_a_chip_has_and_selects_it_itself(void)
{
    struct spi_device d = {.bus = 1, .select = HAL_PIN('A', 4), .mode = 1, .hz = 1000000};
    uint8_t at = 0x03, in[2] = {0};
    struct transfer t = {.out = &at, .n_out = 1, .in = in, .n_in = 2};
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_spi_open(&d));
    for (unsigned twice = 0; twice < 2; twice++) {
        TEST_ASSERT_EQUAL_INT(ERR_OK, hal_spi_start(&d, &t));
        TEST_ASSERT_EQUAL_UINT8(TRANSFER_DONE, t.state);
        TEST_ASSERT_EQUAL_HEX8(0xFF, in[0]); /* thresholds at power-on */
        TEST_ASSERT_EQUAL_HEX8(0xFF, in[1]);
    }
    at = 0x05; /* low thresholds */
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_spi_start(&d, &t));
    TEST_ASSERT_EQUAL_HEX8(0x00, in[0]);
    TEST_ASSERT_EQUAL_HEX8(0x00, in[1]);
}

static void buses_beyond_the_last_are_refused(void)
{
    static const uint8_t wrong[] = {0, 4, 255};
    hal_pin pins[3];
    for (unsigned i = 0; i < sizeof wrong; i++) {
        struct spi_device d = {.bus = wrong[i], .select = HAL_PIN('A', 4)};
        TEST_ASSERT_EQUAL_INT(ERR_RANGE, hal_spi_open(&d));
        TEST_ASSERT_EQUAL_INT(ERR_RANGE, hal_i2c_open(wrong[i]));
        TEST_ASSERT_EQUAL_INT(ERR_RANGE, hal_onewire_open(wrong[i]));
        TEST_ASSERT_FALSE(hal_spi_pins(wrong[i], pins));
        TEST_ASSERT_FALSE(hal_i2c_pins(wrong[i], pins));
        TEST_ASSERT_FALSE(hal_onewire_pin(wrong[i], pins));
    }
}

static void every_bus_has_pins_of_its_own_beside_those_of_console_and_link(void)
{
    bool taken[256] = {[HAL_PIN('A', 2)] = true,
                       [HAL_PIN('A', 3)] = true,
                       [HAL_PIN('A', 9)] = true,
                       [HAL_PIN('A', 10)] = true};
    hal_pin pins[3];
    unsigned n;
    for (uint8_t bus = 1; bus <= 3; bus++) {
        struct {
            bool there;
            unsigned n;
        } of[3] = {{bus <= hal_spi_buses(), 3},
                   {bus <= hal_i2c_buses(), 2},
                   {bus <= hal_onewire_buses(), 1}};
        for (unsigned kind = 0; kind < 3; kind++) {
            bool there = kind == 0   ? hal_spi_pins(bus, pins)
                         : kind == 1 ? hal_i2c_pins(bus, pins)
                                     : hal_onewire_pin(bus, pins);
            TEST_ASSERT_EQUAL_INT(of[kind].there, there);
            n = there ? of[kind].n : 0;
            for (unsigned k = 0; k < n; k++) {
                TEST_ASSERT_FALSE(taken[pins[k]]);
                taken[pins[k]] = true;
            }
        }
    }
}

/* ---- outputs ---- */

static void an_output_is_off_until_it_is_set(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(0.0, part(Q));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, part(Z));
    hal_output_set(HAL_PIN('B', 0), true); /* not opened: nothing happens */
    TEST_ASSERT_EQUAL_DOUBLE(0.0, part(Q));
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_output_open(HAL_PIN('B', 0), false));
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_output_open(HAL_PIN('B', 1), true));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, part(Q));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, part(Z));
    hal_output_set(HAL_PIN('B', 0), true);
    hal_output_set(HAL_PIN('B', 1), true);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, part(Q));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, part(Z));
    TEST_ASSERT_TRUE(hal_pin_read(HAL_PIN('B', 0)));
    TEST_ASSERT_FALSE(hal_pin_read(HAL_PIN('B', 1))); /* on when low */
}

static void a_pulse_width_is_off_until_it_is_set(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_pwm_open(HAL_PIN('B', 6), 1000, false));
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_pwm_open(HAL_PIN('B', 7), 1000, true));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, part(W));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, part(X));
    hal_pwm_set(HAL_PIN('B', 6), HAL_PWM_FULL / 5);
    hal_pwm_set(HAL_PIN('B', 7), HAL_PWM_FULL / 5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.2, part(W));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.2, part(X));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, hal_pwm_open(HAL_PIN('B', 6), 0, false));
}

static void a_pulse_width_is_opened_where_it_is_found_and_nowhere_else(void)
{
    static const uint32_t hz[] = {0, 1, 1000, 100000, 100001};
    unsigned found = 0;
    for (unsigned pin = 0; pin < WORLD_PINS; pin++)
        for (unsigned i = 0; i < sizeof hz / sizeof *hz; i++) {
            struct hal_pwm_place place;
            bool there = hal_pwm_find((hal_pin)pin, hz[i], &place);
            found += there;
            TEST_ASSERT_EQUAL_INT(there ? ERR_OK : ERR_RANGE,
                                  hal_pwm_open((hal_pin)pin, hz[i], false));
            if (there) {
                TEST_ASSERT_TRUE(hal_pin_is_free((hal_pin)pin));
                TEST_ASSERT_TRUE(hz[i] >= 1 && hz[i] <= 100000);
            }
        }
    TEST_ASSERT_EQUAL_UINT(16 * 3, found);
    buses_reset();
}

static void all_on(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_output_open(HAL_PIN('B', 0), false));
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_output_open(HAL_PIN('B', 1), true));
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_pwm_open(HAL_PIN('B', 6), 1000, false));
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_pwm_open(HAL_PIN('B', 7), 1000, true));
    hal_output_set(HAL_PIN('B', 0), true);
    hal_output_set(HAL_PIN('B', 1), true);
    hal_pwm_set(HAL_PIN('B', 6), HAL_PWM_FULL);
    hal_pwm_set(HAL_PIN('B', 7), HAL_PWM_FULL);
    for (unsigned i = 0; i < LOADS; i++)
        TEST_ASSERT_EQUAL_DOUBLE(1.0, part(i));
}

static void a_reset_switches_every_output_off(void)
{
    all_on();
    buses_reset();
    for (unsigned i = 0; i < LOADS; i++)
        TEST_ASSERT_EQUAL_DOUBLE(0.0, part(i));
    hal_output_set(HAL_PIN('B', 0), true); /* it must be opened anew */
    hal_pwm_set(HAL_PIN('B', 6), HAL_PWM_FULL);
    for (unsigned i = 0; i < LOADS; i++)
        TEST_ASSERT_EQUAL_DOUBLE(0.0, part(i));
}

static void output_safe_switches_every_output_off(void)
{
    all_on();
    hal_output_safe();
    for (unsigned i = 0; i < LOADS; i++)
        TEST_ASSERT_EQUAL_DOUBLE(0.0, part(i));
    hal_output_set(HAL_PIN('B', 0), true); /* it is open still */
    TEST_ASSERT_EQUAL_DOUBLE(1.0, part(Q));
}

static void an_output_that_becomes_an_input_goes_off(void)
{
    all_on();
    hal_pin_use(HAL_PIN('B', 0), HAL_PIN_INPUT_PULLED);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, part(Q));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, part(Z));
}

static void pins_that_are_not_free_are_no_outputs(void)
{
    static const hal_pin kept[] = {HAL_PIN('A', 2),  HAL_PIN('A', 3),  HAL_PIN('A', 9),
                                   HAL_PIN('A', 10), HAL_PIN('A', 13), HAL_PIN('A', 14),
                                   HAL_PIN('D', 0),  HAL_PIN_NONE};
    for (unsigned i = 0; i < sizeof kept; i++) {
        TEST_ASSERT_FALSE(hal_pin_is_free(kept[i]));
        TEST_ASSERT_EQUAL_INT(ERR_RANGE, hal_output_open(kept[i], false));
        TEST_ASSERT_EQUAL_INT(ERR_RANGE, hal_pwm_open(kept[i], 1000, false));
        TEST_ASSERT_EQUAL_INT(ERR_RANGE, hal_pulse_open(kept[i]));
    }
}

/* ---- an empty board ---- */

static void on_an_empty_board_nobody_answers(void)
{
    uint8_t in[2] = {0}, at = 3, rom[ONEWIRE_ROM_BYTES] = {0};
    volatile uint8_t branch = 0;
    buses_set_world(NULL);
    TEST_ASSERT_EQUAL_INT(TRANSFER_NO_ANSWER, read_register(1, 0x48, in));
    struct transfer t = {.in = rom, .n_in = sizeof rom};
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_onewire_search(1, &t, &branch));
    TEST_ASSERT_EQUAL_UINT8(TRANSFER_NO_ANSWER, t.state);
    struct spi_device d = {.bus = 1, .select = HAL_PIN('A', 4), .mode = 1, .hz = 1000000};
    t = (struct transfer){.out = &at, .n_out = 1, .in = in, .n_in = 2};
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_spi_start(&d, &t));
    TEST_ASSERT_EQUAL_UINT8(TRANSFER_DONE, t.state); /* SPI cannot tell */
    TEST_ASSERT_EQUAL_HEX8(0xFF, in[0]);
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_output_open(HAL_PIN('B', 0), false));
    hal_output_set(HAL_PIN('B', 0), true);
    TEST_ASSERT_TRUE(hal_pin_read(HAL_PIN('B', 0)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_search_finds_every_device_on_a_wire_once);
    RUN_TEST(a_wire_without_a_device_does_not_answer);
    RUN_TEST(a_device_on_a_wire_is_read_by_its_number);
    RUN_TEST(i2c_reads_what_a_chip_has);
    RUN_TEST(i2c_tells_that_nobody_answers);
    RUN_TEST(spi_reads_what_a_chip_has_and_selects_it_itself);
    RUN_TEST(buses_beyond_the_last_are_refused);
    RUN_TEST(every_bus_has_pins_of_its_own_beside_those_of_console_and_link);
    RUN_TEST(an_output_is_off_until_it_is_set);
    RUN_TEST(a_pulse_width_is_off_until_it_is_set);
    RUN_TEST(a_pulse_width_is_opened_where_it_is_found_and_nowhere_else);
    RUN_TEST(a_reset_switches_every_output_off);
    RUN_TEST(output_safe_switches_every_output_off);
    RUN_TEST(an_output_that_becomes_an_input_goes_off);
    RUN_TEST(pins_that_are_not_free_are_no_outputs);
    RUN_TEST(on_an_empty_board_nobody_answers);
    return UNITY_END();
}
