/* The model of an MCP4725 against its data sheet: write commands, its memory, power-down, reading back.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "chip_bench.h"

#define AT        0x62u
#define SUPPLY_V  5.0
#define STORED    1000u
#define MEMORY_MS 50.0

void setUp(void)
{
    bench_make("mcp4725", "address=0x62 supply=5 stored=1000", BENCH_SEED);
}

void tearDown(void)
{
    bench_free();
}

#define PUT(...)                                                                                   \
    bench_i2c_write(AT, (const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__}))

static void gives(unsigned code)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, SUPPLY_V * code / 4096.0, chip_volts(bench_chip));
}

/* A read has no register: the bytes come after the address at once. */
static void reads(uint8_t bytes[5])
{
    TEST_ASSERT_EQUAL_INT(CHIPS_ANSWER, chips_start(bench_bus, bench_ns, AT, true));
    for (unsigned i = 0; i < 5; i++) {
        bytes[i] = chips_read(bench_bus, bench_ns, i < 4);
    }
    chips_stop(bench_bus, bench_ns);
}

static void it_begins_with_what_its_memory_holds(void)
{
    gives(STORED);
}

static void a_fast_write_moves_the_output_and_leaves_the_memory(void)
{
    TEST_ASSERT_TRUE(PUT(0x0A, 0xBC));
    gives(0xABC);
    chip_power(bench_chip, bench_ns, false);
    chip_power(bench_chip, bench_ns, true);
    gives(STORED);
    bench_expect_right();
}

static void fast_writes_may_follow_each_other_without_a_stop(void)
{
    TEST_ASSERT_TRUE(PUT(0x01, 0x00, 0x0F, 0xFF));
    gives(0xFFF);
    bench_expect_right();
}

static void a_write_of_the_register_has_its_code_in_the_upper_bits(void)
{
    TEST_ASSERT_TRUE(PUT(0x40, 0xAB, 0xC0));
    gives(0xABC);
    bench_expect_right();
}

static void what_is_written_to_the_memory_is_there_after_a_loss_of_power(void)
{
    TEST_ASSERT_TRUE(PUT(0x60, 0x12, 0x30));
    gives(0x123);
    bench_wait_ms(MEMORY_MS);
    chip_power(bench_chip, bench_ns, false);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, chip_volts(bench_chip));
    chip_power(bench_chip, bench_ns, true);
    gives(0x123);
    bench_expect_right();
}

static void what_comes_while_the_memory_is_written_is_ignored_and_wrong(void)
{
    TEST_ASSERT_TRUE(PUT(0x60, 0x12, 0x30));
    TEST_ASSERT_TRUE(PUT(0x0A, 0xBC));
    gives(0x123);
    bench_expect_wrong("before the memory is written");
    bench_wait_ms(MEMORY_MS);
    TEST_ASSERT_TRUE(PUT(0x0A, 0xBC));
    gives(0xABC);
    bench_expect_right();
}

static void a_read_gives_state_register_and_memory(void)
{
    uint8_t bytes[5];
    TEST_ASSERT_TRUE(PUT(0x0A, 0xBC));
    reads(bytes);
    TEST_ASSERT_EQUAL_HEX8(0xC0, bytes[0]); /* ready, powered, output on */
    TEST_ASSERT_EQUAL_HEX8(0xAB, bytes[1]);
    TEST_ASSERT_EQUAL_HEX8(0xC0, bytes[2]);
    TEST_ASSERT_EQUAL_HEX8(STORED >> 8, bytes[3]);
    TEST_ASSERT_EQUAL_HEX8(STORED & 0xFF, bytes[4]);
    TEST_ASSERT_TRUE(PUT(0x66, 0x12, 0x30)); /* 500 kohm, to the memory */
    reads(bytes);
    TEST_ASSERT_EQUAL_HEX8(0x46, bytes[0]); /* busy */
    bench_wait_ms(MEMORY_MS);
    reads(bytes);
    TEST_ASSERT_EQUAL_HEX8(0xC6, bytes[0]);
    TEST_ASSERT_EQUAL_HEX8(0x61, bytes[3]);
    TEST_ASSERT_EQUAL_HEX8(0x23, bytes[4]);
}

static void power_down_pulls_the_output_to_ground_until_it_is_woken(void)
{
    const uint8_t wake = 0x09;
    TEST_ASSERT_TRUE(PUT(0x1A, 0xBC));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, chip_volts(bench_chip));
    TEST_ASSERT_TRUE(bench_i2c_write(0x00, &wake, 1));
    gives(0xABC);
}

static void the_general_reset_takes_what_the_memory_holds(void)
{
    const uint8_t reset = 0x06;
    TEST_ASSERT_TRUE(PUT(0x0A, 0xBC));
    TEST_ASSERT_TRUE(bench_i2c_write(0x00, &reset, 1));
    gives(STORED);
}

static void half_a_command_and_a_reserved_one_are_wrong_and_move_nothing(void)
{
    TEST_ASSERT_TRUE(PUT(0x0A));
    bench_expect_wrong("1 byte of a command, which has 2");
    TEST_ASSERT_TRUE(PUT(0x40, 0xAB));
    bench_expect_wrong("2 bytes of a command, which has 3");
    TEST_ASSERT_TRUE(PUT(0x80, 0xAB, 0xC0));
    bench_expect_wrong("command 4 is reserved");
    gives(STORED);
}

static void an_output_that_is_stuck_stays_and_the_chip_says_what_was_written(void)
{
    uint8_t bytes[5];
    bench_set("stuck", 1);
    TEST_ASSERT_TRUE(PUT(0x0A, 0xBC));
    gives(STORED);
    reads(bytes);
    TEST_ASSERT_EQUAL_HEX8(0xAB, bytes[1]);
    bench_set("stuck", 0);
    TEST_ASSERT_TRUE(PUT(0x0A, 0xBC));
    gives(0xABC);
}

static void a_chip_that_takes_no_byte_keeps_its_output(void)
{
    bench_set("nack", 1);
    TEST_ASSERT_FALSE(PUT(0x0A, 0xBC));
    gives(STORED);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_begins_with_what_its_memory_holds);
    RUN_TEST(a_fast_write_moves_the_output_and_leaves_the_memory);
    RUN_TEST(fast_writes_may_follow_each_other_without_a_stop);
    RUN_TEST(a_write_of_the_register_has_its_code_in_the_upper_bits);
    RUN_TEST(what_is_written_to_the_memory_is_there_after_a_loss_of_power);
    RUN_TEST(what_comes_while_the_memory_is_written_is_ignored_and_wrong);
    RUN_TEST(a_read_gives_state_register_and_memory);
    RUN_TEST(power_down_pulls_the_output_to_ground_until_it_is_woken);
    RUN_TEST(the_general_reset_takes_what_the_memory_holds);
    RUN_TEST(half_a_command_and_a_reserved_one_are_wrong_and_move_nothing);
    RUN_TEST(an_output_that_is_stuck_stays_and_the_chip_says_what_was_written);
    RUN_TEST(a_chip_that_takes_no_byte_keeps_its_output);
    return UNITY_END();
}
