/* Devices on buses where anything may happen: they go on, and call nothing good.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include <stdio.h>
#include <string.h>

#include "devices/devices.h"
#include "devices/ds18b20/rom_search.h"
#include "scripted_bus.h"
#include "unity.h"

#define SEED 3801u

/* One device of each kind that has a bus, with settings that it takes. */
static const struct {
    const char *name;
    struct device_settings settings;
} wired[] = {
    {"max31865",
     {.bus = 1, .select = HAL_PIN('A', 4), .type = 3, .nominal = 100, .reference = 430}},
    {"max31856", {.bus = 1, .select = HAL_PIN('B', 0), .type = 'K'}},
    {"ads1115", {.bus = 1, .address = 0x48, .input = 0}},
    {"ads1115", {.bus = 1, .address = 0x48, .input = 3}},
    {"bme280", {.bus = 1, .address = 0x76}},
    {"bme280_temperature", {.bus = 1, .address = 0x76}},
    {"xgzp6897", {.bus = 1, .address = 0x6D, .reference = 1}},
    {"ds18b20", {.bus = 1, .rom = {0x28, 0xAA, 0x11, 0x22, 0x33, 0x44, 0x55, 0x35}}},
    {"ds18b20", {.bus = 1, .rom = {0x28, 0x10, 0x20, 0x30, 0x40, 0x50, 0x60, 0xD6}}},
};
#define WIRED (sizeof wired / sizeof wired[0])

static struct device devices[WIRED];
static struct device *all[WIRED];

void setUp(void)
{
    script_clear();
    for (unsigned k = 0; k < WIRED; k++) {
        all[k] = &devices[k];
        TEST_ASSERT_EQUAL(
            ERR_OK, device_open(all[k], device_kind_find(wired[k].name), &wired[k].settings, 1000));
    }
}
void tearDown(void) {}

/* An XGZP6897 has neither an id nor a checksum, so bytes that come twice are a reading. */
static bool can_tell(unsigned k)
{
    return strcmp(wired[k].name, "xgzp6897") != 0;
}

static void noise_is_never_called_good(void)
{
    uint32_t before[WIRED] = {0};
    printf("seed %u\n", SEED);
    script_noise(SEED);
    for (unsigned second = 0; second < 20000; second++) {
        script_run_several(all, WIRED, 1000);
        for (unsigned k = 0; k < WIRED; k++) {
            struct device_result r = script_result(all[k]);
            TEST_ASSERT_MESSAGE(r.number == 0 || r.faults != 0 || !can_tell(k), wired[k].name);
            before[k] = r.number;
        }
    }
    for (unsigned k = 0; k < WIRED; k++)
        TEST_ASSERT_GREATER_OR_EQUAL_MESSAGE(19900, before[k], wired[k].name);
    TEST_ASSERT_GREATER_THAN(300000, script_seen.transfers);
}

/* Each result, good or not, is there by the end of the interval after its own. */
static void results_come_in_time_whatever_happens(void)
{
    uint32_t number[WIRED] = {0}, since[WIRED] = {0};
    script_noise(SEED + 1);
    for (unsigned ms = 0; ms < 1000000; ms++) {
        script_run_several(all, WIRED, 1);
        for (unsigned k = 0; k < WIRED; k++) {
            since[k]++;
            if (script_result(all[k]).number != number[k]) {
                number[k]++;
                TEST_ASSERT_EQUAL_MESSAGE(number[k], script_result(all[k]).number, wired[k].name);
                since[k] = 0;
            }
            TEST_ASSERT_LESS_THAN_MESSAGE(2000, since[k], wired[k].name);
        }
    }
}

static void a_search_in_noise_ends_without_an_address_that_is_wrong(void)
{
    static struct rom_search search;
    unsigned states[5] = {0};
    script_noise(SEED + 2);
    for (unsigned n = 0; n < 2000; n++) {
        TEST_ASSERT_EQUAL(ERR_OK, rom_search_begin(&search, 1));
        unsigned ms = 0;
        while (search.state == ROM_SEARCH_RUNS && ms++ < 5000)
            rom_search_clock(&search, script_board.now_ms++);
        TEST_ASSERT_NOT_EQUAL(ROM_SEARCH_RUNS, search.state);
        TEST_ASSERT_LESS_OR_EQUAL(ROM_SEARCH_MAX, search.found);
        states[search.state]++;
    }
    TEST_ASSERT_GREATER_THAN(1000, states[ROM_SEARCH_CHECKSUM] + states[ROM_SEARCH_FAILED]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(noise_is_never_called_good);
    RUN_TEST(results_come_in_time_whatever_happens);
    RUN_TEST(a_search_in_noise_ends_without_an_address_that_is_wrong);
    return UNITY_END();
}
