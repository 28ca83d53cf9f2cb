/* The model of an XGZP6897D: conversion on demand, its end in bit 3 of register 30h, counts for a pascal by the span. */
#include "chip_bench.h"

#define AT 0x6Du

void setUp(void)
{
    bench_make("xgzp6897", "span=1", BENCH_SEED);
}

void tearDown(void)
{
    bench_free();
}

static void command(uint8_t value)
{
    uint8_t bytes[2] = {0x30, value};
    TEST_ASSERT_TRUE(bench_i2c_write(AT, bytes, 2));
}

static uint8_t get(uint8_t at)
{
    uint8_t byte = 0;
    TEST_ASSERT_TRUE(bench_i2c_read(AT, at, &byte, 1));
    return byte;
}

/* Pressure and temperature codes in one burst. */
static int32_t codes(int *temperature)
{
    uint8_t b[5];
    TEST_ASSERT_TRUE(bench_i2c_read(AT, 0x06, b, 5));
    *temperature = (int16_t)(uint16_t)(b[3] << 8 | b[4]);
    return (int32_t)((uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8) >> 8;
}

static int32_t measure(int *temperature)
{
    command(0x0A);
    bench_wait_ms(20);
    return codes(temperature);
}

static void a_pascal_has_the_counts_of_its_span(void)
{
    static const struct {
        const char *span;
        double k;
    } rows[] = {{"span=0.9", 8192}, {"span=1", 4096}, {"span=2", 2048}, {"span=4", 2048},
                {"span=5", 1024},   {"span=10", 512}, {"span=20", 256}, {"span=40", 128},
                {"span=100", 64},   {"span=200", 32}, {"span=500", 16}, {"span=1000", 8}};
    for (unsigned i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
        int t;
        bench_free();
        bench_make("xgzp6897", rows[i].span, BENCH_SEED);
        bench_set("pressure", 100);
        TEST_ASSERT_EQUAL_INT32(100 * rows[i].k, measure(&t));
        bench_set("pressure", -123);
        TEST_ASSERT_EQUAL_INT32(-123 * rows[i].k, measure(&t));
        bench_expect_right();
    }
}

static void pressure_ends_at_the_span_and_temperature_is_in_256ths(void)
{
    int t;
    bench_set("pressure", 5000);
    bench_set("temperature", -12.5);
    TEST_ASSERT_EQUAL_INT32(1000 * 4096, measure(&t));
    TEST_ASSERT_EQUAL_INT(-3200, t);
    bench_set("pressure", -5000);
    TEST_ASSERT_EQUAL_INT32(-1000 * 4096, measure(&t));
}

static void bit_3_tells_the_end(void)
{
    for (uint64_t seed = 1; seed <= 10; seed++) {
        int t;
        bench_free();
        bench_make("xgzp6897", "", seed);
        bench_set("pressure", 10);
        command(0x0A);
        uint64_t start_ns = bench_ns;
        TEST_ASSERT_EQUAL_HEX8(0x0A, get(0x30));
        while (get(0x30) & 0x08u) {
        }
        TEST_ASSERT_TRUE(bench_ns - start_ns < 20400000u && bench_ns - start_ns > 11000000u);
        TEST_ASSERT_EQUAL_INT32(40960, codes(&t));
        bench_expect_right();
    }
}

static void a_result_read_too_early_is_noticed_and_old(void)
{
    int t;
    bench_set("pressure", 10);
    command(0x0A);
    bench_wait_ms(8);
    TEST_ASSERT_EQUAL_INT32(0, codes(&t));
    bench_expect_wrong(
        "register 06h read 8.2 ms after a conversion began, which takes up to 20 ms");
}

static void one_quantity_leaves_the_other(void)
{
    int t;
    bench_set("pressure", 10);
    bench_set("temperature", 30);
    command(0x09);
    bench_wait_ms(20);
    TEST_ASSERT_EQUAL_INT32(40960, codes(&t));
    TEST_ASSERT_EQUAL_INT(0, t);
    bench_set("pressure", 20);
    command(0x08);
    bench_wait_ms(20);
    TEST_ASSERT_EQUAL_INT32(40960, codes(&t));
    TEST_ASSERT_EQUAL_INT(7680, t);
}

static void uncalibrated_values_differ(void)
{
    int t;
    uint8_t raw[2] = {0xA5, 0x02};
    bench_set("pressure", 10);
    TEST_ASSERT_TRUE(bench_i2c_write(AT, raw, 2));
    TEST_ASSERT_EQUAL_HEX8(0x02, get(0xA5));
    TEST_ASSERT_NOT_EQUAL(40960, measure(&t));
}

static void rules_of_the_registers_are_watched(void)
{
    uint8_t bytes[2] = {0x06, 1};
    TEST_ASSERT_TRUE(bench_i2c_write(AT, bytes, 2));
    bench_expect_wrong("register 06h written; it is read-only");
    command(0x0A);
    command(0x0A);
    bench_expect_wrong("asked for while one runs");
}

static void faults_are_silence_refused_bytes_and_a_result_that_stays(void)
{
    int t;
    bench_set("pressure", 10);
    (void)measure(&t);
    bench_set("stuck", 1);
    bench_set("pressure", 20);
    TEST_ASSERT_EQUAL_INT32(40960, measure(&t));
    bench_set("nack", 1);
    TEST_ASSERT_EQUAL_INT(CHIPS_ANSWER, chips_start(bench_bus, bench_ns, AT, false));
    TEST_ASSERT_FALSE(chips_write(bench_bus, bench_ns, 0x30));
    bench_set("dead", 1);
    TEST_ASSERT_EQUAL_INT(CHIPS_SILENT, chips_start(bench_bus, bench_ns, AT, false));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_pascal_has_the_counts_of_its_span);
    RUN_TEST(pressure_ends_at_the_span_and_temperature_is_in_256ths);
    RUN_TEST(bit_3_tells_the_end);
    RUN_TEST(a_result_read_too_early_is_noticed_and_old);
    RUN_TEST(one_quantity_leaves_the_other);
    RUN_TEST(uncalibrated_values_differ);
    RUN_TEST(rules_of_the_registers_are_watched);
    RUN_TEST(faults_are_silence_refused_bytes_and_a_result_that_stays);
    return UNITY_END();
}
