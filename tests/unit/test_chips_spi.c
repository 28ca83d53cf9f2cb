/* SPI of the MAX31865 and MAX31856, with registers of a MAX31865: data sheet 19-6478 rev. 3, pages 4 and 17. */
#include "chip_bench.h"

void setUp(void)
{
    bench_make("max31865", "reference=400", BENCH_SEED);
}

void tearDown(void)
{
    bench_free();
}

static void registers_that_are_read_only_stay(void)
{
    bench_spi_put(0x81, 0x55);
    bench_expect_wrong("register 01h written; it is read-only");
    bench_spi_put(0x87, 0x55);
    bench_expect_wrong("register 07h written; it is read-only");
    TEST_ASSERT_EQUAL_HEX8(0x00, bench_spi_get(0x01));
    TEST_ASSERT_EQUAL_HEX8(0x00, bench_spi_get(0x07));
}

static void addresses_that_are_none_read_ffh_and_go_round(void)
{
    uint8_t bytes[3];
    TEST_ASSERT_EQUAL_HEX8(0xFF, bench_spi_get(0x08));
    bench_spi_put(0x83, 0x12);
    bench_spi_read(0x7F, bytes, 2); /* loops from 7Fh to 00h */
    TEST_ASSERT_EQUAL_HEX8(0xFF, bytes[0]);
    TEST_ASSERT_EQUAL_HEX8(0x00, bytes[1]);
}

static void modes_1_and_3_are_taken_and_others_are_rubbish(void)
{
    bench_spi_put(0x83, 0x12);
    bench_mode = 1;
    TEST_ASSERT_EQUAL_HEX8(0x12, bench_spi_get(0x03));
    bench_expect_right();
    bench_mode = 0;
    bench_spi_put(0x83, 0x34);
    bench_expect_wrong("SPI mode 0; it takes modes 1 and 3");
    bench_mode = 2;
    (void)bench_spi_get(0x03);
    bench_expect_wrong("SPI mode 2");
    bench_mode = 3;
    TEST_ASSERT_EQUAL_HEX8(0x12, bench_spi_get(0x03));
    bench_expect_right();
}

static void a_select_released_within_a_byte_is_noticed(void)
{
    bench_select(true);
    (void)bench_exchange(0x83);
    chips_clock_bits(bench_bus, bench_ns, 5);
    bench_select(false);
    bench_expect_wrong("select released after 5 of 8 bits");
    TEST_ASSERT_EQUAL_HEX8(0xFF, bench_spi_get(0x03)); /* not written */
    bench_expect_right();
}

static void a_clock_above_5_mhz_and_a_short_pause_are_noticed(void)
{
    bench_select(true);
    bench_ns += 8000;
    (void)chips_exchange(bench_bus, bench_ns, 3, 0x03);
    bench_ns += 1500;
    (void)chips_exchange(bench_bus, bench_ns, 3, 0);
    bench_expect_wrong("the clock is 5 MHz at most");
    bench_select(false);
    bench_ns += 300;
    chips_select(bench_bus, bench_ns, BENCH_SELECT, true);
    bench_expect_wrong("select was high for 300 ns; at least 400 ns");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(registers_that_are_read_only_stay);
    RUN_TEST(addresses_that_are_none_read_ffh_and_go_round);
    RUN_TEST(modes_1_and_3_are_taken_and_others_are_rubbish);
    RUN_TEST(a_select_released_within_a_byte_is_noticed);
    RUN_TEST(a_clock_above_5_mhz_and_a_short_pause_are_noticed);
    return UNITY_END();
}
