/* A chip on a bus of its own, and time that goes on with each byte, for tests of the models of chips.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_TESTS_CHIP_BENCH_H
#define REFLUX_TESTS_CHIP_BENCH_H

#include <stdint.h>
#include <string.h>

#include "chips/bus.h"
#include "chips/chip.h"
#include "unity.h"

#define BENCH_SELECT HAL_PIN('A', 4)
#define BENCH_SEED   20u

static struct chips *bench_bus;
static struct chip *bench_chip;
static uint64_t bench_ns;
static unsigned bench_mode;
static char bench_err[256];

/* A chip with power, and an hour behind it. */
static inline void bench_make(const char *kind, const char *properties, uint64_t seed)
{
    bench_ns = 0;
    bench_mode = 3;
    bench_chip = chip_new(kind, properties, seed, bench_err, sizeof(bench_err));
    TEST_ASSERT_NOT_NULL_MESSAGE(bench_chip, bench_err);
    bench_bus = chips_new(bench_chip->kind->bus, seed);
    TEST_ASSERT_TRUE(chips_add(bench_bus, bench_chip, BENCH_SELECT, bench_err, sizeof(bench_err)));
    chip_power(bench_chip, bench_ns, true);
    bench_ns += 3600000000000u;
}

static inline void bench_free(void)
{
    chips_free(bench_bus);
    chip_free(bench_chip);
    bench_bus = NULL;
    bench_chip = NULL;
}

static inline void bench_wait_us(double us)
{
    bench_ns += (uint64_t)(us * 1e3);
    chips_at(bench_bus, bench_ns);
}

static inline void bench_wait_ms(double ms)
{
    bench_wait_us(ms * 1e3);
}

static inline void bench_set(const char *input, double value)
{
    chip_at(bench_chip, bench_ns);
    TEST_ASSERT_TRUE_MESSAGE(chip_set(bench_chip, input, value, bench_err, sizeof(bench_err)),
                             bench_err);
}

/* No rule of the data sheet has been broken. */
static inline void bench_expect_right(void)
{
    TEST_ASSERT_EQUAL_STRING("", bench_chip->wrong);
}

/* A rule has been broken, and the text says these words; then it is forgotten. */
static inline void bench_expect_wrong(const char *words)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bench_chip->wrong, words), bench_chip->wrong);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bench_chip->wrong, bench_chip->kind->name),
                                 bench_chip->wrong);
    bench_chip->wrong[0] = '\0';
    bench_chip->wrongs = 0;
}

static inline uint8_t bench_exchange(uint8_t out)
{
    bench_ns += 8000; /* 1 MHz */
    return chips_exchange(bench_bus, bench_ns, bench_mode, out);
}

static inline void bench_select(bool low)
{
    bench_ns += 1000;
    chips_select(bench_bus, bench_ns, BENCH_SELECT, low);
}

static inline void bench_spi_read(uint8_t address, uint8_t *bytes, size_t n)
{
    bench_select(true);
    (void)bench_exchange(address);
    for (size_t i = 0; i < n; i++) {
        bytes[i] = bench_exchange(0);
    }
    bench_select(false);
}

static inline uint8_t bench_spi_get(uint8_t address)
{
    uint8_t byte;
    bench_spi_read(address, &byte, 1);
    return byte;
}

static inline void bench_spi_write(uint8_t address, const uint8_t *bytes, size_t n)
{
    bench_select(true);
    (void)bench_exchange(address);
    for (size_t i = 0; i < n; i++) {
        (void)bench_exchange(bytes[i]);
    }
    bench_select(false);
}

static inline void bench_spi_put(uint8_t address, uint8_t value)
{
    bench_spi_write(address, &value, 1);
}

static inline bool bench_i2c_write(uint8_t address, const uint8_t *bytes, size_t n)
{
    bench_ns += 90000; /* 100 kHz */
    bool acknowledged = chips_start(bench_bus, bench_ns, address, false) == CHIPS_ANSWER;
    for (size_t i = 0; i < n && acknowledged; i++) {
        bench_ns += 90000;
        acknowledged = chips_write(bench_bus, bench_ns, bytes[i]);
    }
    chips_stop(bench_bus, bench_ns);
    return acknowledged;
}

/* A register's address, start again, bytes. */
static inline bool bench_i2c_read(uint8_t address, uint8_t at, uint8_t *bytes, size_t n)
{
    bench_ns += 90000;
    bool acknowledged = chips_start(bench_bus, bench_ns, address, false) == CHIPS_ANSWER &&
                        chips_write(bench_bus, bench_ns, at);
    acknowledged = acknowledged && chips_start(bench_bus, bench_ns, address, true) == CHIPS_ANSWER;
    for (size_t i = 0; i < n && acknowledged; i++) {
        bench_ns += 90000;
        bytes[i] = chips_read(bench_bus, bench_ns, i + 1 < n);
    }
    chips_stop(bench_bus, bench_ns);
    return acknowledged;
}

#endif
