/* The chip with a current or a voltage, above a chip of the test's own that can be wrong in each way: codes, the clear pin, what is read back,
 * and what is told.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs_bench.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>

#define CLEAR  16u
#define SELECT 17u
/* Rounds of reading that may pass until a chip is told as silent, and a round and its rest. */
#define TOLD_MS  250u
#define RETRY_MS 350u

/* SBAS528D, AD5422 rev. I: registers; what is at the output follows from them and from the clear pin. */
static struct {
    uint16_t data, control, status, answer;
    bool cleared;        /* and nothing written since */
    bool absent;         /* no bit comes back, and none gets there */
    bool deaf;           /* the code is not taken over */
    uint16_t stuck_bits; /* of the code, that stay 0 */
    unsigned broken;     /* so many frames to come do not end */
    unsigned frames, data_frames;
    bool jumped; /* a frame behind a release of the clear pin was not the new code */
} chip;
static enum transfer_state ends;

/* The clear pin is level-sensitive, and the code of before comes back with any frame that is not a code. */
static void look_at_clear(void)
{
    if (bench_pins[CLEAR].high)
        chip.cleared = true;
}

static enum transfer_state exchange(const struct spi_device *device, struct transfer *t)
{
    TEST_ASSERT_EQUAL(1, device->bus);
    TEST_ASSERT_EQUAL(SELECT, device->select);
    TEST_ASSERT_EQUAL(0, device->mode);
    TEST_ASSERT_EQUAL(3, t->n_out + t->n_in);
    chip.frames++;
    if (chip.broken > 0) {
        chip.broken--;
        return ends;
    }
    const uint8_t answer[3] = {0, (uint8_t)(chip.answer >> 8), (uint8_t)chip.answer};
    for (unsigned k = 0; k < t->n_in; k++)
        t->in[k] = chip.absent ? 0xFFu : answer[k];
    if (chip.absent || t->n_out == 0)
        return TRANSFER_DONE;
    uint16_t word = (uint16_t)(t->out[1] << 8 | t->out[2]);
    look_at_clear();
    if (chip.cleared && !bench_pins[CLEAR].high && t->out[0] != 0x01)
        chip.jumped = true;
    switch (t->out[0]) {
    case 0x01:
        chip.data_frames++;
        if (!chip.deaf && !bench_pins[CLEAR].high) {
            chip.data = (uint16_t)(word & ~chip.stuck_bits);
            chip.cleared = false;
        }
        break;
    case 0x02:
        chip.answer = word == 0 ? chip.status : word == 1 ? chip.data : chip.control;
        break;
    case 0x55:
        chip.control = word;
        break;
    default:
        TEST_FAIL_MESSAGE("a frame that the chip does not know");
    }
    return TRANSFER_DONE;
}

/* Fraction of its range that the output is at; -1: it is off. */
static double at(void)
{
    look_at_clear();
    if ((chip.control & 0x1000u) == 0)
        return -1.0;
    return chip.cleared ? 0.0 : chip.data / 65536.0;
}

static struct output_settings settings;

static void begin(void)
{
    bench_open(&settings, 1);
}

void setUp(void)
{
    bench_begin();
    chip = (typeof(chip)){.cleared = true};
    ends = TRANSFER_FAILED;
    bench_spi = exchange;
    settings = bench_settings(OUTPUT_AD5422, 1);
}
void tearDown(void)
{
    bench_tell_seed();
}

/* The tick's commands come each 50 ms. */
static void run(double command, unsigned ms)
{
    for (unsigned k = 0; k < ms; k++) {
        if (k % 50u == 0)
            outputs_command(0, true, (float)command);
        bench_turn();
    }
}

static void idle(unsigned ms)
{
    for (unsigned k = 0; k < ms; k++)
        bench_turn();
}

/* ---- codes ---- */

static void each_range_is_that_of_the_chip(void)
{
    static const uint16_t controls[OUTPUT_RANGES] = {0x1005, 0x1006, 0x1007, 0x1000, 0x1001};
    for (unsigned range = 0; range < OUTPUT_RANGES; range++) {
        settings.range = (uint8_t)range;
        begin();
        run(0.5, 50);
        TEST_ASSERT_EQUAL_HEX16(controls[range], chip.control);
        TEST_ASSERT_EQUAL(0, outputs_faults(0));
    }
}

/* AD5422: output = bottom + code / 2^16 of the range. 4-20 mA: 4 mA is 0, 12 mA 8000h; 20 mA is the last code, FFFFh. */
static void codes_are_those_of_the_data_sheet(void)
{
    static const struct {
        double milliampere;
        uint16_t code;
    } vectors[] = {{4, 0},      {5, 4096},     {8, 16384}, {12, 32768},
                   {16, 49152}, {19.9, 65126}, {20, 65535}};
    begin();
    for (unsigned k = 0; k < sizeof vectors / sizeof *vectors; k++) {
        run((vectors[k].milliampere - 4.0) / 16.0, 60);
        TEST_ASSERT_UINT16_WITHIN(1, vectors[k].code, chip.data);
    }
}

static void every_command_is_within_a_code(void)
{
    struct random_source random = bench_random(5422);
    begin();
    for (unsigned k = 0; k < 2000; k++) {
        double command = random_below(&random, 65537) / 65536.0;
        run(command, 50);
        TEST_ASSERT_DOUBLE_WITHIN(1.0, command * 65536.0, chip.data);
    }
}

static void gain_and_offset_move_the_span(void)
{
    settings.gain = -0.5f;
    settings.offset = 0.75f;
    begin();
    run(0.0, 60);
    TEST_ASSERT_UINT16_WITHIN(1, 49152, chip.data);
    run(1.0, 60);
    TEST_ASSERT_UINT16_WITHIN(1, 16384, chip.data);
}

static void a_new_command_is_there_within_ten_milliseconds(void)
{
    struct random_source random = bench_random(7);
    begin();
    run(0.5, 100);
    for (unsigned k = 0; k < 500; k++) {
        double command = random_below(&random, 65536) / 65536.0;
        idle(random_below(&random, 40));
        run(command, 10);
        TEST_ASSERT_DOUBLE_WITHIN(1.5 / 65536.0, command, at());
    }
}

/* ---- the clear pin ---- */

static void before_the_first_command_it_is_never_but_off_or_in_its_safe_position(void)
{
    settings.safe = 0.25f;
    chip.data = 40000; /* of a life before */
    begin();
    TEST_ASSERT_TRUE(bench_pins[CLEAR].high);
    for (unsigned k = 0; k < 500; k++) {
        bench_turn();
        TEST_ASSERT_TRUE(at() <= 0.0 || fabs(at() - 0.25) < 1e-4);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.25, at());
}

static void the_pins_alone_let_it_fall_at_once(void)
{
    begin();
    run(0.8, 100);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.8, at());
    outputs_safe();
    TEST_ASSERT_EQUAL_DOUBLE(0.0, at()); /* before any turn of the clock */
    idle(1000);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, at());
    outputs_resume();
    run(0.8, 20);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.8, at());
}

static void the_code_of_before_never_comes_back_with_a_release(void)
{
    struct random_source random = bench_random(11);
    begin();
    for (unsigned k = 0; k < 500; k++) {
        run(random_below(&random, 65536) / 65536.0, 1u + random_below(&random, 60));
        outputs_safe();
        look_at_clear();
        idle(random_below(&random, 3));
        outputs_resume();
    }
    TEST_ASSERT_FALSE(chip.jumped);
    TEST_ASSERT_TRUE(chip.data_frames > 300);
}

static void without_commands_it_goes_to_its_safe_position(void)
{
    settings.safe = 0.25f;
    begin();
    run(0.8, 100);
    idle(2010);
    TEST_ASSERT_EQUAL(OUTPUT_DEAD_MAN, outputs_rule(0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.25, at());
}

static void a_chip_that_does_not_listen_falls_by_its_pin_when_nobody_commands(void)
{
    settings.safe = 0.25f;
    begin();
    run(0.8, 100);
    chip.absent = true; /* it keeps its code */
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.8, at());
    idle(2010);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, at());
}

static void closing_it_leaves_the_pin_to_its_resistor_and_no_transfer(void)
{
    uint8_t failed;
    begin();
    run(0.8, 100);
    ends = TRANSFER_RUNS;
    chip.broken = 1;
    while (chip.broken != 0)
        bench_turn();
    TEST_ASSERT_EQUAL(0, bench_spi_stops);
    TEST_ASSERT_EQUAL(ERR_OK, outputs_open(NULL, 0, &failed));
    TEST_ASSERT_EQUAL(1, bench_spi_stops);
    TEST_ASSERT_EQUAL(HAL_PIN_CLOSED, bench_pins[CLEAR].use);
}

/* ---- what is told ---- */

static void no_chip_is_told_and_its_output_is_cleared(void)
{
    chip.absent = true;
    begin();
    run(0.8, TOLD_MS);
    TEST_ASSERT_EQUAL(OUTPUT_NO_CHIP, outputs_faults(0));
    TEST_ASSERT_TRUE(bench_pins[CLEAR].high);
}

static void a_chip_that_comes_back_is_set_up_and_gets_its_code(void)
{
    begin();
    run(0.8, 100);
    chip.absent = true;
    run(0.8, TOLD_MS);
    TEST_ASSERT_EQUAL(OUTPUT_NO_CHIP, outputs_faults(0));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, at());
    chip = (typeof(chip)){.cleared = true};
    run(0.8, 2 * RETRY_MS);
    TEST_ASSERT_EQUAL(0, outputs_faults(0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.8, at());
}

static void a_chip_that_has_lost_its_supply_gets_range_and_code_again(void)
{
    begin();
    run(0.8, 100);
    chip.control = chip.data = 0;
    run(0.8, 150);
    TEST_ASSERT_EQUAL_HEX16(0x1005, chip.control);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.8, at());
    TEST_ASSERT_EQUAL(0, outputs_faults(0));
}

static void a_code_that_is_not_taken_over_is_told_and_cleared(void)
{
    begin();
    run(0.2, 100);
    chip.deaf = true;
    run(0.8, TOLD_MS);
    TEST_ASSERT_EQUAL(OUTPUT_NO_CHIP, outputs_faults(0));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, at());
    /* It stays told, although all else that is read is right, and it is at rest nearly all the time. */
    unsigned at_rest = 0, told = 0;
    for (unsigned k = 0; k < 10000; k++) {
        run(0.8, 1);
        at_rest += bench_pins[CLEAR].high;
        told += outputs_faults(0) == OUTPUT_NO_CHIP;
    }
    TEST_ASSERT_EQUAL(10000, told);
    TEST_ASSERT_TRUE(at_rest > 9500);
    chip.deaf = false;
    run(0.8, 2 * RETRY_MS);
    TEST_ASSERT_EQUAL(0, outputs_faults(0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.8, at());
}

static void a_bit_that_sticks_is_told(void)
{
    begin();
    run(0.5, 100);
    chip.stuck_bits = 1;
    run(32769.0 / 65536.0, TOLD_MS);
    TEST_ASSERT_EQUAL(OUTPUT_NO_CHIP, outputs_faults(0));
}

static void single_disturbed_frames_are_mended_and_not_told(void)
{
    struct random_source random = bench_random(13);
    begin();
    run(0.4, 100);
    for (unsigned k = 0; k < 300; k++) {
        chip.broken = 1;
        ends = random_below(&random, 2) ? TRANSFER_FAILED : TRANSFER_RUNS;
        run(0.4, 130 + random_below(&random, 60));
        TEST_ASSERT_EQUAL(0, outputs_faults(0));
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.4, at());
    }
    TEST_ASSERT_TRUE(bench_spi_stops > 50); /* those that did not end */
}

static void an_open_loop_is_told_of_currents_only(void)
{
    begin();
    chip.status = 4;
    run(0.5, 100);
    TEST_ASSERT_EQUAL(OUTPUT_LOOP_OPEN, outputs_faults(0));
    chip.status = 0;
    run(0.5, 100);
    TEST_ASSERT_EQUAL(0, outputs_faults(0));
    settings.range = OUTPUT_0_10_V;
    begin();
    chip.status = 4;
    run(0.5, 100);
    TEST_ASSERT_EQUAL(0, outputs_faults(0));
}

static void a_hot_chip_is_told(void)
{
    begin();
    chip.status = 1;
    run(0.5, 100);
    TEST_ASSERT_EQUAL(OUTPUT_HOT, outputs_faults(0));
}

/* 250 turns without the bus count as a round that failed. */
static void a_bus_that_is_never_free_is_told_and_the_output_cleared(void)
{
    begin();
    run(0.8, 100);
    bench_spi_busy = true;
    run(0.8, 1000);
    TEST_ASSERT_EQUAL(OUTPUT_NO_CHIP, outputs_faults(0));
    TEST_ASSERT_TRUE(bench_pins[CLEAR].high);
}

static void an_output_that_is_switched_off_while_it_waits_for_the_bus_stays_cleared(void)
{
    begin();
    idle(100);
    bench_spi_busy = true;
    run(0.8, 10);
    outputs_safe();
    bench_turn();
    bench_spi_busy = false;
    idle(50);
    TEST_ASSERT_TRUE(bench_pins[CLEAR].high);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, at());
}

/* ---- what it was ---- */

static void the_mean_is_that_of_codes_that_were_read_back(void)
{
    begin();
    run(0.5, 100);
    (void)outputs_readback(0);
    run(0.5, 1000);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0.5f, outputs_readback(0));
    outputs_safe();
    idle(1000);
    TEST_ASSERT_FLOAT_WITHIN(0.002f, 0.0f, outputs_readback(0));
    outputs_resume();
    chip.absent = true;
    run(0.5, 1000);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.0f, outputs_readback(0));
}

/* ---- settings ---- */

static void refuses(const char *words)
{
    struct output_problem problem;
    TEST_ASSERT_FALSE(output_check(&settings, 1, 0, &problem));
    TEST_ASSERT_EQUAL_STRING(words, problem.words);
}

static void it_needs_a_clear_pin_a_select_and_a_bus(void)
{
    settings.pin[OUTPUT_PIN] = HAL_PIN_NONE;
    refuses("the chip has no watchdog of its own, so its clear pin is needed to let it fall");
    settings = bench_settings(OUTPUT_AD5422, 1);
    settings.pin[OUTPUT_SECOND_PIN] = HAL_PIN_NONE;
    refuses("a pin is missing");
    settings = bench_settings(OUTPUT_AD5422, 1);
    settings.bus = 0;
    refuses("its chip needs an SPI bus");
    settings = bench_settings(OUTPUT_AD5422, 1);
    settings.range = OUTPUT_RANGES;
    refuses("there is no such range");
    settings = bench_settings(OUTPUT_AD5422, 1);
    settings.offset = 0.5f;
    refuses("offset and gain take the output out of 0 to 1 at command 1");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(each_range_is_that_of_the_chip);
    RUN_TEST(codes_are_those_of_the_data_sheet);
    RUN_TEST(every_command_is_within_a_code);
    RUN_TEST(gain_and_offset_move_the_span);
    RUN_TEST(a_new_command_is_there_within_ten_milliseconds);
    RUN_TEST(before_the_first_command_it_is_never_but_off_or_in_its_safe_position);
    RUN_TEST(the_pins_alone_let_it_fall_at_once);
    RUN_TEST(the_code_of_before_never_comes_back_with_a_release);
    RUN_TEST(without_commands_it_goes_to_its_safe_position);
    RUN_TEST(a_chip_that_does_not_listen_falls_by_its_pin_when_nobody_commands);
    RUN_TEST(closing_it_leaves_the_pin_to_its_resistor_and_no_transfer);
    RUN_TEST(no_chip_is_told_and_its_output_is_cleared);
    RUN_TEST(a_chip_that_comes_back_is_set_up_and_gets_its_code);
    RUN_TEST(a_chip_that_has_lost_its_supply_gets_range_and_code_again);
    RUN_TEST(a_code_that_is_not_taken_over_is_told_and_cleared);
    RUN_TEST(a_bit_that_sticks_is_told);
    RUN_TEST(single_disturbed_frames_are_mended_and_not_told);
    RUN_TEST(an_open_loop_is_told_of_currents_only);
    RUN_TEST(a_hot_chip_is_told);
    RUN_TEST(a_bus_that_is_never_free_is_told_and_the_output_cleared);
    RUN_TEST(an_output_that_is_switched_off_while_it_waits_for_the_bus_stays_cleared);
    RUN_TEST(the_mean_is_that_of_codes_that_were_read_back);
    RUN_TEST(it_needs_a_clear_pin_a_select_and_a_bus);
    return UNITY_END();
}
