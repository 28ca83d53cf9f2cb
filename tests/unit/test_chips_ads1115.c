/* The model of an ADS1115 against its data sheet: registers, single shots, ranges and rates. */
#include "chip_bench.h"

#define AT              0x48u
#define SINGLE_ENDED(n) ((unsigned)(4u + (n)) << 12)
#define OS              0x8000u
#define ONE             0x0100u /* single shot */
#define OFF             0x0003u /* no comparator */
#define V2_048          (2u << 9)
#define SPS_128         (4u << 5)

void setUp(void)
{
    bench_make("ads1115", "", BENCH_SEED);
}

void tearDown(void)
{
    bench_free();
}

static bool put(uint8_t at, unsigned value)
{
    uint8_t bytes[3] = {at, (uint8_t)(value >> 8), (uint8_t)value};
    return bench_i2c_write(AT, bytes, 3);
}

static unsigned get(uint8_t at)
{
    uint8_t bytes[2] = {0, 0};
    TEST_ASSERT_TRUE(bench_i2c_read(AT, at, bytes, 2));
    return (unsigned)(bytes[0] << 8 | bytes[1]);
}

/* A single shot of this configuration, by the book: waits the longest time of 128 samples a second. */
static int shot(unsigned config)
{
    TEST_ASSERT_TRUE(put(1, OS | ONE | OFF | SPS_128 | config));
    bench_wait_ms(8.71);
    return (int16_t)get(0);
}

static void registers_after_power_on_are_those_of_the_data_sheet(void)
{
    TEST_ASSERT_EQUAL_HEX16(0x8583, get(1));
    TEST_ASSERT_EQUAL_HEX16(0x0000, get(0));
    TEST_ASSERT_EQUAL_HEX16(0x8000, get(2));
    TEST_ASSERT_EQUAL_HEX16(0x7FFF, get(3));
    bench_expect_right();
}

static void four_to_twenty_milliamperes_over_100_ohm_are_6400_to_32000_codes(void)
{
    static const double volts[4] = {0.4, 2.0, 0.36, 2.1};
    static const int code[4] = {6400, 32000, 5760, 32767};
    for (unsigned n = 0; n < 4; n++) {
        char input[] = "in0";
        input[2] = (char)('0' + n);
        bench_set(input, volts[n]);
    }
    for (unsigned n = 0; n < 4; n++) {
        TEST_ASSERT_EQUAL_INT(code[n], shot(SINGLE_ENDED(n) | V2_048));
    }
    bench_expect_right();
}

static void each_range_has_its_full_scale(void)
{
    static const double full[6] = {6.144, 4.096, 2.048, 1.024, 0.512, 0.256};
    bench_set("in2", 0.2);
    for (unsigned range = 0; range < 6; range++) {
        int expected = (int)(0.2 / full[range] * 32768.0 + 0.5);
        TEST_ASSERT_INT_WITHIN(1, expected, shot(SINGLE_ENDED(2) | range << 9));
    }
}

static void differences_take_two_inputs(void)
{
    bench_set("in0", 1.0);
    bench_set("in1", 0.5);
    bench_set("in2", 0.25);
    bench_set("in3", 2.0);
    TEST_ASSERT_EQUAL_INT(8000, shot(0u << 12 | V2_048));
    TEST_ASSERT_EQUAL_INT(-16000, shot(1u << 12 | V2_048));
    TEST_ASSERT_EQUAL_INT(-24000, shot(2u << 12 | V2_048));
    TEST_ASSERT_EQUAL_INT(-28000, shot(3u << 12 | V2_048));
}

static void an_input_ends_at_the_supply(void)
{
    bench_set("in0", 24);
    TEST_ASSERT_EQUAL_INT(19200, shot(SINGLE_ENDED(0))); /* 3.6 V of 6.144 */
    bench_set("in0", -10);
    TEST_ASSERT_EQUAL_INT(-4800, shot(SINGLE_ENDED(0) | V2_048));
}

static void os_tells_when_a_single_shot_has_ended_within_ten_percent(void)
{
    static const double rate[8] = {8, 16, 32, 64, 128, 250, 475, 860};
    for (unsigned code = 0; code < 8; code++) {
        bench_free();
        bench_make("ads1115", "", code);
        bench_set("in0", 1.024);
        TEST_ASSERT_TRUE(put(1, OS | ONE | OFF | SINGLE_ENDED(0) | V2_048 | code << 5));
        bench_wait_ms(1e3 / rate[code] / 1.1 - 0.5);
        TEST_ASSERT_EQUAL_HEX16(0, get(1) & OS);
        bench_wait_ms(1e3 / rate[code] * (1.0 / 0.9 - 1.0 / 1.1) + 0.5);
        TEST_ASSERT_EQUAL_HEX16(OS, get(1) & OS);
        TEST_ASSERT_EQUAL_INT(16384, get(0));
        bench_expect_right();
    }
}

static void a_result_read_too_early_is_noticed_and_old(void)
{
    bench_set("in0", 1.024);
    TEST_ASSERT_EQUAL_INT(16384, shot(SINGLE_ENDED(0) | V2_048));
    bench_set("in1", 0.512);
    TEST_ASSERT_TRUE(put(1, OS | ONE | OFF | SPS_128 | SINGLE_ENDED(1) | V2_048));
    bench_wait_ms(5);
    TEST_ASSERT_EQUAL_INT(16384, get(0));
    bench_expect_wrong("register 0 read 5.");
}

static void continuous_mode_goes_on_by_itself(void)
{
    bench_set("in0", 0.5);
    TEST_ASSERT_TRUE(put(1, OFF | SPS_128 | SINGLE_ENDED(0) | V2_048));
    bench_wait_ms(9);
    TEST_ASSERT_EQUAL_INT(8000, get(0));
    bench_set("in0", 1.0);
    bench_wait_ms(18);
    TEST_ASSERT_EQUAL_INT(16000, get(0));
    bench_expect_right();
}

static void os_while_it_converts_begins_nothing(void)
{
    TEST_ASSERT_TRUE(put(1, OS | ONE | OFF | SPS_128 | SINGLE_ENDED(0)));
    TEST_ASSERT_TRUE(put(1, OS | ONE | OFF | SPS_128 | SINGLE_ENDED(1)));
    bench_expect_wrong("OS written while it converts");
}

static void broken_writes_are_noticed(void)
{
    uint8_t bytes[4] = {1, 0x85, 0x83, 0};
    TEST_ASSERT_TRUE(bench_i2c_write(AT, bytes, 2));
    bench_expect_wrong("register 1: one byte written of two");
    TEST_ASSERT_TRUE(bench_i2c_write(AT, bytes, 4));
    bench_expect_wrong("more than two bytes");
    TEST_ASSERT_TRUE(put(0, 1));
    bench_expect_wrong("register 0 written; it is read-only");
    bytes[0] = 4;
    TEST_ASSERT_TRUE(bench_i2c_write(AT, bytes, 1));
    bench_expect_wrong("pointer 04h");
}

static void a_pointer_stays_for_further_reads(void)
{
    uint8_t pointer = 3;
    uint8_t high;
    TEST_ASSERT_TRUE(bench_i2c_write(AT, &pointer, 1));
    for (unsigned i = 0; i < 2; i++) {
        TEST_ASSERT_EQUAL_INT(CHIPS_ANSWER, chips_start(bench_bus, bench_ns, AT, true));
        high = chips_read(bench_bus, bench_ns, true);
        TEST_ASSERT_EQUAL_HEX8(0x7F, high);
        TEST_ASSERT_EQUAL_HEX8(0xFF, chips_read(bench_bus, bench_ns, false));
        chips_stop(bench_bus, bench_ns);
    }
}

static void it_answers_at_its_own_address_and_the_general_call(void)
{
    uint8_t reset = 6;
    bench_free();
    bench_make("ads1115", "address=0x4b", BENCH_SEED);
    TEST_ASSERT_FALSE(put(1, 0x8583));
    uint8_t bytes[3] = {3, 0x12, 0x34};
    TEST_ASSERT_TRUE(bench_i2c_write(0x4B, bytes, 3));
    TEST_ASSERT_TRUE(bench_i2c_read(0x4B, 3, bytes, 2));
    TEST_ASSERT_EQUAL_HEX8(0x12, bytes[0]);
    TEST_ASSERT_TRUE(bench_i2c_write(0x00, &reset, 1));
    TEST_ASSERT_TRUE(bench_i2c_read(0x4B, 3, bytes, 2));
    TEST_ASSERT_EQUAL_HEX8(0x7F, bytes[0]);
}

static void faults_are_silence_refused_bytes_and_a_result_that_stays(void)
{
    bench_set("in0", 0.5);
    (void)shot(SINGLE_ENDED(0) | V2_048);
    bench_set("stuck", 1);
    bench_set("in0", 1.0);
    TEST_ASSERT_EQUAL_INT(8000, shot(SINGLE_ENDED(0) | V2_048));
    bench_set("stuck", 0);
    TEST_ASSERT_EQUAL_INT(16000, shot(SINGLE_ENDED(0) | V2_048));
    bench_set("nack", 1);
    TEST_ASSERT_EQUAL_INT(CHIPS_ANSWER, chips_start(bench_bus, bench_ns, AT, false));
    TEST_ASSERT_FALSE(chips_write(bench_bus, bench_ns, 1));
    chips_stop(bench_bus, bench_ns);
    bench_set("nack", 0);
    bench_set("dead", 1);
    TEST_ASSERT_EQUAL_INT(CHIPS_SILENT, chips_start(bench_bus, bench_ns, AT, false));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(registers_after_power_on_are_those_of_the_data_sheet);
    RUN_TEST(four_to_twenty_milliamperes_over_100_ohm_are_6400_to_32000_codes);
    RUN_TEST(each_range_has_its_full_scale);
    RUN_TEST(differences_take_two_inputs);
    RUN_TEST(an_input_ends_at_the_supply);
    RUN_TEST(os_tells_when_a_single_shot_has_ended_within_ten_percent);
    RUN_TEST(a_result_read_too_early_is_noticed_and_old);
    RUN_TEST(continuous_mode_goes_on_by_itself);
    RUN_TEST(os_while_it_converts_begins_nothing);
    RUN_TEST(broken_writes_are_noticed);
    RUN_TEST(a_pointer_stays_for_further_reads);
    RUN_TEST(it_answers_at_its_own_address_and_the_general_call);
    RUN_TEST(faults_are_silence_refused_bytes_and_a_result_that_stays);
    return UNITY_END();
}
