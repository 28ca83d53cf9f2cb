/* The output kind ad5422 above the model of its chip, which was written from the data sheets alone: what the load gets, on a bus of its own and on
 * one that a neighbour has as well, and that no rule of a data sheet is broken.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <math.h>
#include <string.h>

#include "chips/bus.h"
#include "chips/chip.h"
#include "devices/device.h"
#include "devices/line.h"
#include "outputs_bench.h"
#include "unity.h"

#define CLEAR     16u
#define SELECT    17u
#define NEIGHBOUR 40u /* select of another chip */
#define CODE      (1.01 / 65536.0)
#define TOLD_MS   250u
#define BACK_MS   700u
#define DEAD_MAN  2000u

static struct chips *bus;
static struct chip *chip, *neighbour;
static uint64_t ns;
static unsigned spoken; /* times that the neighbour had the bus */
static char err[200];
static struct output_settings settings;

static void look_at_clear(void)
{
    bool low = bench_pins[CLEAR].use == HAL_PIN_OUTPUT && !bench_pins[CLEAR].high;
    chip->kind->clear(chip, ns, !low);
}

static enum transfer_state exchange(const struct spi_device *device, struct transfer *t)
{
    look_at_clear();
    chips_select(bus, ns += 1000, device->select, true);
    for (unsigned k = 0; k < t->n_out; k++)
        (void)chips_exchange(bus, ns += 8000, device->mode, t->out[k]);
    for (unsigned k = 0; k < t->n_in; k++)
        t->in[k] = chips_exchange(bus, ns += 8000, device->mode, 0);
    chips_select(bus, ns += 1000, device->select, false);
    return TRANSFER_DONE;
}

static void make(const char *properties, enum output_range range)
{
    chips_free(bus);
    chip_free(chip);
    chip_free(neighbour);
    bus = chips_new(CHIP_SPI, 1);
    chip = chip_new("ad5422", properties, 1, err, sizeof err);
    neighbour = chip_new("max31865", "", 2, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(chip, err);
    TEST_ASSERT_TRUE(chips_add(bus, chip, SELECT, err, sizeof err));
    TEST_ASSERT_TRUE(chips_add(bus, neighbour, NEIGHBOUR, err, sizeof err));
    look_at_clear();
    chip_power(chip, ns, true);
    chip_power(neighbour, ns, true);
    settings.range = (uint8_t)range;
    bench_open(&settings, 1);
}

void setUp(void)
{
    ns = 0;
    spoken = 0;
    bench_begin();
    bench_spi = exchange;
    settings = bench_settings(OUTPUT_AD5422, 1);
    settings.safe = 0.25f;
}

void tearDown(void)
{
    chips_free(bus);
    chip_free(chip);
    chip_free(neighbour);
    bus = NULL;
    chip = neighbour = NULL;
    bench_tell_seed();
}

static void turn(void)
{
    ns = ns / 1000000u * 1000000u + 1000000u;
    chips_at(bus, ns);
    bench_turn();
    look_at_clear();
}

static void idle(unsigned ms)
{
    while (ms-- > 0)
        turn();
}

static void run(double command, unsigned ms)
{
    for (unsigned k = 0; k < ms; k++) {
        if (k % 50u == 0)
            outputs_command(0, true, (float)command);
        turn();
    }
}

/* mA or V at the load. */
static double load(void)
{
    return chip_drives(chip, ns);
}

/* Part of 4 to 20 mA. */
static double part(void)
{
    return (load() - 4.0) / 16.0;
}

static void put(const char *input, double value)
{
    TEST_ASSERT_TRUE_MESSAGE(chip_set(chip, input, value, err, sizeof err), err);
}

static void expect_no_rule_broken(void)
{
    TEST_ASSERT_EQUAL_STRING("", chips_wrong(bus, NULL));
}

/* Another device of the bus, which looks at a register of its own. */
static void neighbour_turns(struct random_source *random)
{
    static int self;
    if (random_below(random, 3) != 0 ||
        !line_claim(DEVICE_SPI, 1, LINE_WHOLE, &self, bench_now + 1u, 1))
        return;
    chips_select(bus, ns += 1000, NEIGHBOUR, true);
    (void)chips_exchange(bus, ns += 8000, 1, 0x03);
    TEST_ASSERT_EQUAL_HEX8(0xFF, chips_exchange(bus, ns += 8000, 1, 0)); /* as at power-on */
    TEST_ASSERT_EQUAL_HEX8(0xFF, chips_exchange(bus, ns += 8000, 1, 0));
    TEST_ASSERT_EQUAL_HEX8(0x00, chips_exchange(bus, ns += 8000, 1, 0));
    chips_select(bus, ns += 1000, NEIGHBOUR, false);
    spoken++;
}

/* ---- what the load gets ---- */

static void each_range_gives_its_current_or_voltage(void)
{
    static const struct {
        const char *signal;
        enum output_range range;
        double lo, hi;
    } ranges[] = {{"", OUTPUT_4_20_MA, 4, 20},
                  {"", OUTPUT_0_20_MA, 0, 20},
                  {"", OUTPUT_0_24_MA, 0, 24},
                  {"signal=voltage", OUTPUT_0_5_V, 0, 5},
                  {"signal=voltage", OUTPUT_0_10_V, 0, 10}};
    for (unsigned i = 0; i < sizeof ranges / sizeof *ranges; i++) {
        double span = ranges[i].hi - ranges[i].lo;
        make(ranges[i].signal, ranges[i].range);
        for (unsigned k = 0; k <= 20; k++) {
            run(k / 20.0, 60);
            TEST_ASSERT_DOUBLE_WITHIN(span * CODE, ranges[i].lo + span * k / 20.0, load());
        }
        TEST_ASSERT_EQUAL(0, outputs_faults(0));
        expect_no_rule_broken();
    }
}

static void a_neighbour_on_the_bus_reads_what_is_its_own_and_so_does_the_chip(void)
{
    struct random_source random = bench_random(17);
    make("", OUTPUT_4_20_MA);
    for (unsigned k = 0; k < 400; k++) {
        double command = random_below(&random, 65536) / 65536.0;
        outputs_command(0, true, (float)command);
        for (unsigned ms = 0; ms < 80; ms++) {
            neighbour_turns(&random);
            turn();
        }
        TEST_ASSERT_EQUAL(0, outputs_faults(0));
        TEST_ASSERT_DOUBLE_WITHIN(CODE, command, part());
    }
    TEST_ASSERT_TRUE(spoken > 5000);
    expect_no_rule_broken();
}

static void a_code_of_before_never_comes_back_with_a_release(void)
{
    struct random_source random = bench_random(19);
    make("", OUTPUT_4_20_MA);
    run(1.0, 60);
    for (unsigned k = 0; k < 300; k++) {
        run(k % 2 ? 0.1 : 1.0, 60);
        outputs_safe();
        look_at_clear();
        TEST_ASSERT_EQUAL_DOUBLE(4.0, load());
        idle(random_below(&random, 60));
        outputs_resume();
        double next = k % 2 ? 0.05 : 0.1;
        outputs_command(0, true, (float)next);
        for (unsigned ms = 0; ms < 60; ms++) {
            turn();
            TEST_ASSERT_TRUE(part() <= next + CODE);
        }
    }
    expect_no_rule_broken();
}

/* ---- the dead man ---- */

static void without_commands_the_load_is_in_its_safe_position(void)
{
    make("", OUTPUT_4_20_MA);
    run(0.8, 1000);
    idle(DEAD_MAN + 10u);
    TEST_ASSERT_DOUBLE_WITHIN(CODE, 0.25, part());
    expect_no_rule_broken();
}

static void a_chip_that_is_dead_falls_by_its_pin_before_the_dead_man(void)
{
    make("", OUTPUT_4_20_MA);
    run(0.8, 1000);
    put("dead", 1);
    TEST_ASSERT_DOUBLE_WITHIN(CODE, 0.8, part());
    run(0.8, TOLD_MS);
    TEST_ASSERT_EQUAL(OUTPUT_NO_CHIP, outputs_faults(0));
    TEST_ASSERT_EQUAL_DOUBLE(4.0, load());
    put("dead", 0);
    run(0.8, BACK_MS);
    TEST_ASSERT_EQUAL(0, outputs_faults(0));
    TEST_ASSERT_DOUBLE_WITHIN(CODE, 0.8, part());
    expect_no_rule_broken();
}

static void a_board_that_stands_leaves_the_load_to_the_pull_up(void)
{
    uint8_t failed;
    make("", OUTPUT_4_20_MA);
    run(0.8, 1000);
    TEST_ASSERT_EQUAL(ERR_OK, outputs_open(NULL, 0, &failed)); /* pins are inputs, as in a reset */
    look_at_clear();
    TEST_ASSERT_EQUAL_DOUBLE(4.0, load());
}

/* ---- what is told ---- */

static void an_open_loop_a_hot_die_and_a_lost_supply_are_told_and_mended(void)
{
    make("", OUTPUT_4_20_MA);
    run(0.5, 100);
    put("open", 1);
    run(0.5, 100);
    TEST_ASSERT_EQUAL(OUTPUT_LOOP_OPEN, outputs_faults(0));
    put("open", 0);
    put("hot", 1);
    run(0.5, 100);
    TEST_ASSERT_EQUAL(OUTPUT_HOT, outputs_faults(0));
    put("hot", 0);
    put("brownout", 1);
    run(0.5, 200);
    TEST_ASSERT_EQUAL(0, outputs_faults(0));
    TEST_ASSERT_DOUBLE_WITHIN(CODE, 0.5, part());
    chip_power(chip, ns, false);
    run(0.5, TOLD_MS);
    TEST_ASSERT_EQUAL(OUTPUT_NO_CHIP, outputs_faults(0));
    chip_power(chip, ns, true);
    run(0.5, BACK_MS);
    TEST_ASSERT_EQUAL(0, outputs_faults(0));
    TEST_ASSERT_DOUBLE_WITHIN(CODE, 0.5, part());
    expect_no_rule_broken();
}

/* A bit is wrong in each way with this probability. 72 bits go out in a round and 72 come back; a code that was taken wrongly is read back and
 * written again within a round and its rest. */
static void what_noise_has_written_is_mended_within_a_round(void)
{
    static const double probabilities[] = {1e-4, 1e-3, 1e-2};
    for (unsigned i = 0; i < 3; i++) {
        unsigned off = 0, longest = 0;
        make("", OUTPUT_4_20_MA);
        run(0.5, 1000);
        TEST_ASSERT_TRUE(chips_set(bus, "noise", probabilities[i], err, sizeof err));
        for (unsigned ms = 0; ms < 60000; ms++) {
            run(0.5, 1);
            bool high = part() > 0.5 + CODE; /* more than was commanded */
            off = high ? off + 1u : 0u;
            longest = off > longest ? off : longest;
        }
        TEST_ASSERT_TRUE(chips_set(bus, "noise", 0.0, err, sizeof err));
        run(0.5, BACK_MS);
        TEST_ASSERT_EQUAL(0, outputs_faults(0));
        TEST_ASSERT_DOUBLE_WITHIN(CODE, 0.5, part());
        printf("noise %g: too high for %u ms at most\n", probabilities[i], longest);
        TEST_ASSERT_TRUE(longest <= TOLD_MS);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(each_range_gives_its_current_or_voltage);
    RUN_TEST(a_neighbour_on_the_bus_reads_what_is_its_own_and_so_does_the_chip);
    RUN_TEST(a_code_of_before_never_comes_back_with_a_release);
    RUN_TEST(without_commands_the_load_is_in_its_safe_position);
    RUN_TEST(a_chip_that_is_dead_falls_by_its_pin_before_the_dead_man);
    RUN_TEST(a_board_that_stands_leaves_the_load_to_the_pull_up);
    RUN_TEST(an_open_loop_a_hot_die_and_a_lost_supply_are_told_and_mended);
    RUN_TEST(what_noise_has_written_is_mended_within_a_round);
    return UNITY_END();
}
