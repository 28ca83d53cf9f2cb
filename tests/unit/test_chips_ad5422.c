/* The model of an AD5422 against its data sheet: frames, reading back, ranges, CLEAR, slopes, faults of the loop.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "chip_bench.h"

#define CURRENT 0x1005u /* 4 to 20 mA, enabled */
#define VOLTS   0x1001u /* 0 to 10 V, enabled */
#define STATUS  0u
#define DATA    1u
#define CONTROL 2u

static uint16_t answer;

void setUp(void)
{
    bench_make("ad5422", "", BENCH_SEED);
}

void tearDown(void)
{
    bench_free();
}

static void send(uint8_t command, uint16_t value)
{
    bench_select(true);
    (void)bench_exchange(command);
    answer = (uint16_t)(bench_exchange((uint8_t)(value >> 8)) << 8);
    answer |= bench_exchange((uint8_t)value);
    bench_select(false);
    bench_ns += 10000;
}

static uint16_t get(unsigned which)
{
    send(0x02, (uint16_t)which);
    send(0x00, 0);
    return answer;
}

static void gives(double value)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, value, chip_drives(bench_chip, bench_ns));
}

static void clear(bool high)
{
    bench_chip->kind->clear(bench_chip, bench_ns, high);
}

static void another(const char *properties)
{
    bench_free();
    bench_make("ad5422", properties, BENCH_SEED);
}

/* ---- registers ---- */

static void it_drives_nothing_after_power_on(void)
{
    gives(0.0);
    TEST_ASSERT_EQUAL_HEX16(0, get(STATUS));
    TEST_ASSERT_EQUAL_HEX16(0, get(CONTROL));
    send(0x01, 0x8000);
    gives(0.0);
    bench_expect_right();
}

static void current_is_a_line_from_the_bottom_of_the_range(void)
{
    static const struct {
        uint16_t control, code;
        double ma;
    } points[] = {{0x1005, 0, 4.0},
                  {0x1005, 0x8000, 12.0},
                  {0x1005, 0x4000, 8.0},
                  {0x1006, 0, 0.0},
                  {0x1006, 0x8000, 10.0},
                  {0x1007, 0xC000, 18.0},
                  {0x1006, 0xFFFF, 20.0 * 65535 / 65536}};
    for (size_t i = 0; i < sizeof(points) / sizeof(points[0]); i++) {
        send(0x56, 1);
        send(0x55, points[i].control);
        send(0x01, points[i].code);
        gives(points[i].ma);
    }
    bench_expect_right();
}

static void voltage_is_at_the_other_pin(void)
{
    another("signal=voltage");
    send(0x55, CURRENT);
    send(0x01, 0x8000);
    gives(0.0);
    send(0x56, 1);
    send(0x55, VOLTS);
    send(0x01, 0x8000);
    gives(5.0);
    send(0x55, VOLTS | 0x4000); /* 10 % more */
    gives(5.5);
    send(0x56, 1);
    send(0x55, 0x1003);
    gives(0.0); /* the middle of -10 to 10 V, which another range goes to */
    send(0x01, 0);
    gives(-10.0);
    bench_expect_right();
}

static void what_was_written_is_read_behind_a_nop(void)
{
    send(0x55, CURRENT);
    send(0x01, 0x1234);
    TEST_ASSERT_EQUAL_HEX16(0x1234, get(DATA));
    TEST_ASSERT_EQUAL_HEX16(CURRENT, get(CONTROL));
    send(0x00, 0);
    TEST_ASSERT_EQUAL_HEX16(0xFFFF, answer); /* nobody has asked */
    bench_expect_right();
}

static void an_answer_is_fetched_by_a_nop_only(void)
{
    send(0x02, DATA);
    send(0x01, 0x4000);
    bench_expect_wrong("command 01h where a NOP has to fetch the answer to a read");
    TEST_ASSERT_EQUAL_HEX16(0x4000, get(DATA));
}

static void a_reset_takes_all_registers_back(void)
{
    send(0x55, CURRENT);
    send(0x01, 0x8000);
    send(0x56, 0);
    gives(12.0);
    send(0x56, 1);
    gives(0.0);
    TEST_ASSERT_EQUAL_HEX16(0, get(CONTROL));
    TEST_ASSERT_EQUAL_HEX16(0, get(DATA));
    bench_expect_right();
}

static void another_range_takes_the_data_with_it(void)
{
    send(0x55, CURRENT);
    send(0x01, 0x8000);
    send(0x55, 0x0005); /* the same range, disabled */
    TEST_ASSERT_EQUAL_HEX16(0x8000, get(DATA));
    send(0x55, 0x1006);
    TEST_ASSERT_EQUAL_HEX16(0, get(DATA));
    gives(0.0);
    bench_expect_right();
    send(0x55, 0x1007);
    bench_expect_wrong("another range while the output is enabled");
}

static void what_no_register_takes_is_wrong(void)
{
    send(0x55, 0x1004);
    bench_expect_wrong("there is no range 4");
    send(0x56, 1);
    send(0x55, 0x000D);
    bench_expect_wrong("daisy chain");
    send(0x02, 3);
    bench_expect_wrong("read of address 3");
    send(0x00, 0);
    send(0x77, 3);
    bench_expect_wrong("command 77h");
}

/* ---- frames ---- */

static void a_frame_has_24_bits(void)
{
    send(0x55, CURRENT);
    bench_select(true);
    (void)bench_exchange(0x01);
    (void)bench_exchange(0x80);
    bench_select(false); /* ...05h, 01h, 80h: no command of the chip is 05h */
    bench_expect_wrong("LATCH rose after 16 bits");
    gives(4.0);
    bench_select(true);
    (void)bench_exchange(0x55);
    (void)bench_exchange(0x01);
    (void)bench_exchange(0x80);
    (void)bench_exchange(0x00);
    bench_select(false);
    bench_expect_wrong("LATCH rose after 32 bits");
    gives(12.0); /* the last 24 are taken */
    bench_select(true);
    (void)bench_exchange(0x01);
    chips_clock_bits(bench_bus, bench_ns, 3);
    bench_select(false);
    bench_expect_wrong("LATCH rose after 11 bits");
}

static void modes_that_sample_while_the_clock_falls_give_rubbish(void)
{
    bench_mode = 0;
    send(0x55, CURRENT);
    bench_expect_right();
    bench_mode = 1;
    send(0x55, CURRENT);
    bench_expect_wrong("SPI mode 1; it takes modes 0 and 3");
}

/* Bytes for another chip, whose select is not LATCH. */
static void bytes_of_others_are_shifted_through(void)
{
    send(0x55, CURRENT);
    (void)bench_exchange(0x01);
    (void)bench_exchange(0x80);
    (void)bench_exchange(0x00);
    gives(4.0);
    send(0x01, 0x4000);
    gives(8.0);
    bench_expect_right();
}

static void an_answer_that_waits_falls_into_what_another_chip_says(void)
{
    send(0x55, CURRENT);
    send(0x01, 0x0012);
    bench_expect_right();
    send(0x02, DATA);
    (void)bench_exchange(0xFF);
    TEST_ASSERT_EQUAL_HEX8(0x00, bench_exchange(0xFF));
    TEST_ASSERT_EQUAL_HEX8(0x12, bench_exchange(0xFF));
    bench_expect_wrong("another chip is talked to while SDO is enabled");
}

static void latch_stays_high_a_while_behind_the_control_register(void)
{
    bench_select(true);
    (void)bench_exchange(0x55);
    (void)bench_exchange(0x10);
    (void)bench_exchange(0x05);
    bench_select(false);
    bench_select(true);
    bench_expect_wrong("LATCH was high for 1000 ns after the control register");
}

/* ---- CLEAR ---- */

static void clear_brings_the_output_to_the_bottom_of_its_range_without_a_bus(void)
{
    send(0x55, CURRENT);
    send(0x01, 0x8000);
    bench_set("dead", 1);
    clear(true);
    gives(4.0);
    bench_set("dead", 0);
    bench_expect_right();
}

static void while_clear_is_high_no_value_is_taken(void)
{
    send(0x55, CURRENT);
    send(0x01, 0x8000);
    clear(true);
    send(0x01, 0x4000);
    gives(4.0);
    TEST_ASSERT_EQUAL_HEX16(0x8000, get(DATA));
    gives(4.0);
}

static void the_value_before_clear_is_back_with_a_pulse_of_latch(void)
{
    send(0x55, CURRENT);
    send(0x01, 0x8000);
    clear(true);
    clear(false);
    gives(4.0);
    bench_select(true);
    bench_select(false);
    gives(12.0);
    bench_expect_right();
}

static void a_new_value_ends_what_clear_has_made(void)
{
    send(0x55, CURRENT);
    send(0x01, 0x8000);
    clear(true);
    clear(false);
    send(0x01, 0x4000);
    gives(8.0);
}

static void a_chip_that_gets_power_while_clear_is_high_is_cleared(void)
{
    clear(true);
    chip_power(bench_chip, bench_ns, false);
    chip_power(bench_chip, bench_ns, true);
    send(0x55, CURRENT);
    send(0x01, 0x8000);
    gives(4.0);
}

static void clear_select_takes_the_middle_of_a_voltage(void)
{
    another("signal=voltage");
    send(0x55, VOLTS | 0x8000);
    send(0x01, 0xFFFF);
    clear(true);
    gives(5.0);
    clear(false);
    send(0x56, 1);
    send(0x55, 0x9003);
    send(0x01, 0xFFFF);
    clear(true);
    gives(-10.0);
}

/* ---- slopes ---- */

/* Clock 1111b is 3300 Hz, step 100b is 16 codes: 52,800 codes a second. */
static void a_slope_goes_in_steps_and_tells_that_it_goes(void)
{
    send(0x55, 0x1F96);
    send(0x01, 0xCE40); /* 52,800 codes */
    uint64_t began_ns = bench_ns - 10000;
    TEST_ASSERT_EQUAL_HEX16(0x0002, get(STATUS));
    bench_ns = began_ns + 500000000;
    gives(20.0 * 26400 / 65536);
    bench_ns = began_ns + 1100000000;
    gives(20.0 * 52800 / 65536);
    TEST_ASSERT_EQUAL_HEX16(0x0000, get(STATUS));
    bench_expect_right();
}

static void clear_goes_down_the_slope_as_well(void)
{
    send(0x55, 0x1F96);
    send(0x01, 0xCE40);
    bench_wait_ms(2000);
    clear(true);
    bench_wait_ms(500);
    gives(20.0 * 26400 / 65536);
    bench_wait_ms(600);
    gives(0.0);
}

static void a_write_of_the_control_register_halts_a_slope(void)
{
    send(0x55, 0x1F96);
    send(0x01, 0xCE40);
    bench_wait_ms(100);
    double there = chip_drives(bench_chip, bench_ns);
    send(0x55, 0x1F96);
    bench_wait_ms(2000);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, there, chip_drives(bench_chip, bench_ns));
    TEST_ASSERT_TRUE(there > 1.0);
}

/* ---- the loop ---- */

static void an_open_loop_carries_no_current_and_is_told(void)
{
    send(0x55, CURRENT);
    send(0x01, 0x8000);
    bench_set("open", 1);
    gives(0.0);
    TEST_ASSERT_EQUAL_HEX16(0x0004, get(STATUS));
    bench_set("open", 0);
    gives(12.0);
    TEST_ASSERT_EQUAL_HEX16(0x0000, get(STATUS));
}

static void an_open_loop_that_should_carry_nothing_is_not_told(void)
{
    send(0x55, 0x1006);
    bench_set("open", 1);
    TEST_ASSERT_EQUAL_HEX16(0x0000, get(STATUS));
}

static void nobody_knows_of_an_open_voltage_output(void)
{
    another("signal=voltage");
    send(0x55, VOLTS);
    send(0x01, 0x8000);
    bench_set("open", 1);
    gives(0.0);
    TEST_ASSERT_EQUAL_HEX16(0x0000, get(STATUS));
}

static void a_loop_of_too_much_resistance_is_told(void)
{
    another("loop=1000 supply=14.5"); /* 12 mA at most */
    send(0x55, CURRENT);
    send(0x01, 0x7F00);
    TEST_ASSERT_EQUAL_HEX16(0x0000, get(STATUS));
    send(0x01, 0xFFFF);
    gives(12.0);
    TEST_ASSERT_EQUAL_HEX16(0x0004, get(STATUS));
}

static void a_hot_die_is_told(void)
{
    send(0x55, CURRENT);
    bench_set("hot", 1);
    TEST_ASSERT_EQUAL_HEX16(0x0001, get(STATUS));
    bench_set("hot", 0);
    TEST_ASSERT_EQUAL_HEX16(0x0000, get(STATUS));
}

static void a_brown_out_takes_the_registers_once(void)
{
    send(0x55, CURRENT);
    send(0x01, 0x8000);
    bench_set("brownout", 1);
    bench_wait_ms(1);
    gives(0.0);
    send(0x55, CURRENT);
    send(0x01, 0x8000);
    gives(12.0);
    bench_expect_right();
}

static void no_power_is_no_current(void)
{
    send(0x55, CURRENT);
    send(0x01, 0x8000);
    chip_power(bench_chip, bench_ns, false);
    gives(0.0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_drives_nothing_after_power_on);
    RUN_TEST(current_is_a_line_from_the_bottom_of_the_range);
    RUN_TEST(voltage_is_at_the_other_pin);
    RUN_TEST(what_was_written_is_read_behind_a_nop);
    RUN_TEST(an_answer_is_fetched_by_a_nop_only);
    RUN_TEST(a_reset_takes_all_registers_back);
    RUN_TEST(another_range_takes_the_data_with_it);
    RUN_TEST(what_no_register_takes_is_wrong);
    RUN_TEST(a_frame_has_24_bits);
    RUN_TEST(modes_that_sample_while_the_clock_falls_give_rubbish);
    RUN_TEST(bytes_of_others_are_shifted_through);
    RUN_TEST(an_answer_that_waits_falls_into_what_another_chip_says);
    RUN_TEST(latch_stays_high_a_while_behind_the_control_register);
    RUN_TEST(clear_brings_the_output_to_the_bottom_of_its_range_without_a_bus);
    RUN_TEST(while_clear_is_high_no_value_is_taken);
    RUN_TEST(the_value_before_clear_is_back_with_a_pulse_of_latch);
    RUN_TEST(a_new_value_ends_what_clear_has_made);
    RUN_TEST(a_chip_that_gets_power_while_clear_is_high_is_cleared);
    RUN_TEST(clear_select_takes_the_middle_of_a_voltage);
    RUN_TEST(a_slope_goes_in_steps_and_tells_that_it_goes);
    RUN_TEST(clear_goes_down_the_slope_as_well);
    RUN_TEST(a_write_of_the_control_register_halts_a_slope);
    RUN_TEST(an_open_loop_carries_no_current_and_is_told);
    RUN_TEST(an_open_loop_that_should_carry_nothing_is_not_told);
    RUN_TEST(nobody_knows_of_an_open_voltage_output);
    RUN_TEST(a_loop_of_too_much_resistance_is_told);
    RUN_TEST(a_hot_die_is_told);
    RUN_TEST(a_brown_out_takes_the_registers_once);
    RUN_TEST(no_power_is_no_current);
    return UNITY_END();
}
