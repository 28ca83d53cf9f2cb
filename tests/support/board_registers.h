/* A virtual board that a test asks register by register: no code runs but where a test gives it some. */
#ifndef REFLUX_TESTS_BOARD_REGISTERS_H
#define REFLUX_TESTS_BOARD_REGISTERS_H

#include <string.h>

#include "interrupts.h"
#include "models/models.h"
#include "stm32_addresses.h" /* registers.h of the port: names stand for addresses */
#include "unity.h"

#define BAUD_FAR 115200u

static struct board *b;

/* 0x20002000 and 0x08000008: a stack, and a first instruction, which faults, because what is erased is none. */
static const uint8_t empty_image[8] = {0, 0x20, 0, 0x20, 0x09, 0, 0, 0x08};

static inline void start_board(const struct chip *chip, const struct surroundings *around,
                               const uint8_t *image, size_t size)
{
    char err[200] = "";
    if (b != NULL)
        board_free(b);
    b = board_new(chip, around, image, size, false, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(b, err);
    board_power_on(b);
}

static inline struct surroundings usual(const struct chip *chip, uint32_t crystal_hz)
{
    return (struct surroundings){.crystal_hz = crystal_hz,
                                 .slow_clock_hz = chip->slow_clock_hz,
                                 .supply_mv = 3300,
                                 .baud = BAUD_FAR,
                                 .seed = 1};
}

static inline void restart(enum board_reset kind)
{
    board_ask_reset(b, kind);
    board_run(b, board_ns(b) + 1); /* the one instruction that is run faults */
}

static inline void pass(uint64_t ns)
{
    b->cycles = board_cycles_at(b, board_ns(b) + ns);
    board_run_events(b);
}

static inline uint32_t get(uint32_t address)
{
    return bus_read(b, address, 4);
}

static inline void put(uint32_t address, uint32_t word)
{
    bus_write(b, address, 4, word);
}

static inline void put_ok(uint32_t address, uint32_t word)
{
    put(address, word);
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
}

/* The verdict has these words. The board goes on after it, so that one test can ask for several. */
static inline void expect_verdict(const char *words)
{
    if (strstr(b->verdict, words) == NULL)
        TEST_FAIL_MESSAGE(b->verdict[0] != '\0' ? b->verdict : words);
    b->verdict[0] = '\0';
}

#endif
