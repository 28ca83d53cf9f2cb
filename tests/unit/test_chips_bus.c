/* Buses with their chips: who answers, and what faults of the lines do. */
#include <stdio.h>

#include "chips/bus.h"
#include "chips/chip.h"
#include "unity.h"

#define SEED 4711u

static struct chips *bus;
static struct chip *chip[3];
static size_t n_chips;
static char err[256];
static uint64_t now_ns;

void setUp(void)
{
    now_ns = 1000000000u;
    n_chips = 0;
    bus = NULL;
}

void tearDown(void)
{
    for (size_t i = 0; i < n_chips; i++) {
        chip_free(chip[i]);
    }
    chips_free(bus);
}

static void add(const char *kind, const char *properties, hal_pin select)
{
    struct chip *c = chip_new(kind, properties, n_chips, err, sizeof(err));
    TEST_ASSERT_NOT_NULL_MESSAGE(c, err);
    chip[n_chips++] = c;
    if (bus == NULL) {
        bus = chips_new(c->kind->bus, SEED);
    }
    TEST_ASSERT_TRUE_MESSAGE(chips_add(bus, c, select, err, sizeof(err)), err);
    chip_power(c, 0, true);
}

static void fault(const char *name, double value)
{
    TEST_ASSERT_TRUE_MESSAGE(chips_set(bus, name, value, err, sizeof(err)), err);
}

static uint8_t spi_get(hal_pin select, uint8_t address)
{
    now_ns += 100000;
    chips_select(bus, now_ns, select, true);
    (void)chips_exchange(bus, now_ns += 8000, 1, address);
    uint8_t byte = chips_exchange(bus, now_ns += 8000, 1, 0);
    chips_select(bus, now_ns += 8000, select, false);
    return byte;
}

static void spi_put(hal_pin select, uint8_t address, uint8_t value)
{
    now_ns += 100000;
    chips_select(bus, now_ns, select, true);
    (void)chips_exchange(bus, now_ns += 8000, 1, address);
    (void)chips_exchange(bus, now_ns += 8000, 1, value);
    chips_select(bus, now_ns += 8000, select, false);
}

static bool i2c_put(uint8_t address, const uint8_t *bytes, size_t n)
{
    now_ns += 1000000;
    bool acknowledged = chips_start(bus, now_ns, address, false) == CHIPS_ANSWER;
    for (size_t i = 0; i < n; i++) {
        acknowledged = chips_write(bus, now_ns, bytes[i]) && acknowledged;
    }
    chips_stop(bus, now_ns);
    return acknowledged;
}

static unsigned i2c_get(uint8_t address)
{
    now_ns += 1000000;
    TEST_ASSERT_EQUAL_INT(CHIPS_ANSWER, chips_start(bus, now_ns, address, true));
    unsigned high = chips_read(bus, now_ns, true);
    unsigned low = chips_read(bus, now_ns, false);
    chips_stop(bus, now_ns);
    return high << 8 | low;
}

static void a_select_reaches_its_chip_alone(void)
{
    add("max31865", "", HAL_PIN('A', 4));
    add("max31856", "", HAL_PIN('B', 0));
    spi_put(HAL_PIN('A', 4), 0x83, 0x12);
    spi_put(HAL_PIN('B', 0), 0x83, 0x34);
    spi_put(HAL_PIN('C', 1), 0x83, 0x56); /* nobody */
    TEST_ASSERT_EQUAL_HEX8(0x12, spi_get(HAL_PIN('A', 4), 0x03));
    TEST_ASSERT_EQUAL_HEX8(0x34, spi_get(HAL_PIN('B', 0), 0x03));
    TEST_ASSERT_EQUAL_HEX8(0xFF, spi_get(HAL_PIN('C', 1), 0x03));
    TEST_ASSERT_EQUAL_STRING("", chips_wrong(bus, NULL));
}

static void two_selects_at_once_are_noticed(void)
{
    add("max31865", "", HAL_PIN('A', 4));
    add("max31856", "", HAL_PIN('B', 0));
    chips_select(bus, now_ns, HAL_PIN('A', 4), true);
    TEST_ASSERT_EQUAL_STRING("", chips_wrong(bus, NULL));
    chips_select(bus, now_ns, HAL_PIN('B', 0), true);
    TEST_ASSERT_EQUAL_STRING("max31856: selected while another chip of the bus is",
                             chips_wrong(bus, NULL));
}

static void a_read_that_ends_with_an_acknowledgement_is_noticed(void)
{
    add("ads1115", "", HAL_PIN_NONE);
    (void)i2c_get(0x48);
    TEST_ASSERT_EQUAL_STRING("", chips_wrong(bus, NULL));
    (void)chips_start(bus, now_ns, 0x48, true);
    (void)chips_read(bus, now_ns, true);
    (void)chips_read(bus, now_ns, true);
    chips_stop(bus, now_ns);
    TEST_ASSERT_EQUAL_STRING("ads1115: a read ends behind a byte that was acknowledged",
                             chips_wrong(bus, NULL));
}

static void an_address_reaches_its_chip_alone(void)
{
    uint8_t first[3] = {3, 0x12, 0x34};
    uint8_t second[3] = {3, 0x56, 0x78};
    add("ads1115", "address=0x48", HAL_PIN_NONE);
    add("ads1115", "address=0x49", HAL_PIN_NONE);
    TEST_ASSERT_TRUE(i2c_put(0x48, first, 3));
    TEST_ASSERT_TRUE(i2c_put(0x49, second, 3));
    TEST_ASSERT_FALSE(i2c_put(0x4A, second, 0));
    TEST_ASSERT_EQUAL_HEX16(0x1234, i2c_get(0x48));
    TEST_ASSERT_EQUAL_HEX16(0x5678, i2c_get(0x49));
}

static void a_chip_that_does_not_fit_is_refused(void)
{
    add("max31865", "", HAL_PIN('A', 4));
    struct chip *other = chip_new("max31856", "", 1, err, sizeof(err));
    TEST_ASSERT_FALSE(chips_add(bus, other, HAL_PIN('A', 4), err, sizeof(err)));
    TEST_ASSERT_EQUAL_STRING("max31856 has the select of another max31865", err);
    chip_free(other);
    other = chip_new("ads1115", "", 1, err, sizeof(err));
    TEST_ASSERT_FALSE(chips_add(bus, other, HAL_PIN_NONE, err, sizeof(err)));
    TEST_ASSERT_EQUAL_STRING("ads1115 is a chip for i2c, not for spi", err);
    chip_free(other);
}

static void a_fault_that_is_none_is_refused(void)
{
    add("max31865", "", HAL_PIN('A', 4));
    TEST_ASSERT_FALSE(chips_set(bus, "noisy", 1, err, sizeof(err)));
    TEST_ASSERT_EQUAL_STRING("a bus has no fault noisy; it has noise, stuck, floats_low", err);
    TEST_ASSERT_FALSE(chips_set(bus, "noise", 1.5, err, sizeof(err)));
    TEST_ASSERT_EQUAL_STRING("noise is a probability, 0 to 1, not 1.5", err);
}

static void a_stuck_line_reads_nothing_and_comes_back(void)
{
    uint8_t bytes[3] = {3, 0x12, 0x34};
    add("max31865", "", HAL_PIN('A', 4));
    fault("stuck", 1);
    TEST_ASSERT_EQUAL_HEX8(0, spi_get(HAL_PIN('A', 4), 0x03));
    fault("stuck", 0);
    TEST_ASSERT_EQUAL_HEX8(0xFF, spi_get(HAL_PIN('A', 4), 0x03));
    tearDown();
    setUp();
    add("ads1115", "", HAL_PIN_NONE);
    fault("stuck", 1);
    TEST_ASSERT_EQUAL_INT(CHIPS_HELD_LOW, chips_start(bus, now_ns, 0x48, false));
    fault("stuck", 0);
    TEST_ASSERT_TRUE(i2c_put(0x48, bytes, 3));
    tearDown();
    setUp();
    add("ds18b20", "", HAL_PIN_NONE);
    fault("stuck", 1);
    TEST_ASSERT_EQUAL_INT(CHIPS_HELD_LOW, chips_reset(bus, now_ns));
    TEST_ASSERT_FALSE(chips_slot(bus, now_ns, true));
    fault("stuck", 0);
    TEST_ASSERT_EQUAL_INT(CHIPS_ANSWER, chips_reset(bus, now_ns));
    TEST_ASSERT_TRUE(chips_slot(bus, now_ns, true));
}

static void noise_turns_as_many_bits_as_it_says(void)
{
    static const double noise[3] = {1e-3, 1e-2, 0.1};
    printf("seed %u\n", SEED);
    add("max31865", "", HAL_PIN('A', 4));
    for (unsigned k = 0; k < 3; k++) {
        enum { N = 50000 };
        unsigned wrong = 0;
        fault("noise", noise[k]);
        chips_select(bus, now_ns, HAL_PIN('B', 1), true); /* nobody: FFh comes in */
        for (unsigned i = 0; i < N; i++) {
            for (unsigned byte = chips_exchange(bus, now_ns, 1, 0) ^ 0xFFu; byte;
                 byte &= byte - 1u) {
                wrong++;
            }
        }
        double mean = 8.0 * N * noise[k];
        TEST_ASSERT_TRUE(((double)wrong - mean) * ((double)wrong - mean) < 16.0 * mean);
    }
}

static void noise_is_the_same_for_the_same_seed(void)
{
    uint8_t seen[2][64];
    for (unsigned run = 0; run < 2; run++) {
        tearDown();
        setUp();
        add("max31865", "", HAL_PIN('A', 4));
        fault("noise", 0.05);
        for (unsigned i = 0; i < 64; i++) {
            seen[run][i] = spi_get(HAL_PIN('A', 4), 0x03);
        }
    }
    TEST_ASSERT_EQUAL_HEX8_ARRAY(seen[0], seen[1], 64);
}

/* Bits of a scratchpad that are not those of power-on, in 100 reads of all 9 bytes, by a bus with this noise. */
static unsigned bad_pads(double noise)
{
    static const uint8_t first[9] = {0x50, 0x05, 0x4B, 0x46, 0x7F, 0xFF, 0x0C, 0x10, 0x1C};
    unsigned bad = 0;
    fault("noise", noise);
    for (unsigned n = 0; n < 100; n++) {
        unsigned differ = 0;
        (void)chips_reset(bus, now_ns += 1000000);
        for (unsigned i = 0; i < 16; i++) {
            (void)chips_slot(bus, now_ns, (0xBECCu >> i) & 1u);
        }
        for (unsigned i = 0; i < 72; i++) {
            bool bit = chips_slot(bus, now_ns, true);
            differ += bit != (((unsigned)first[i / 8] >> (i % 8)) & 1u);
        }
        bad += differ != 0;
    }
    return bad;
}

static void noise_on_a_wire_spoils_some_reads(void)
{
    add("ds18b20", "", HAL_PIN_NONE);
    TEST_ASSERT_EQUAL_UINT(0, bad_pads(0.0));
    unsigned some = bad_pads(3e-3); /* 88 bits and more: about a quarter of the reads */
    TEST_ASSERT_TRUE(some > 5 && some < 60);
    TEST_ASSERT_EQUAL_UINT(0, bad_pads(0.0));
}

static void a_broken_rule_is_told_with_the_number_of_all(void)
{
    unsigned count;
    add("max31865", "", HAL_PIN('A', 4));
    add("max31856", "", HAL_PIN('B', 0));
    spi_put(HAL_PIN('B', 0), 0x8F, 1);
    spi_put(HAL_PIN('B', 0), 0x8E, 1);
    TEST_ASSERT_EQUAL_STRING("max31856: register 0Fh written; it is read-only",
                             chips_wrong(bus, &count));
    TEST_ASSERT_EQUAL_UINT(2, count);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_select_reaches_its_chip_alone);
    RUN_TEST(two_selects_at_once_are_noticed);
    RUN_TEST(a_read_that_ends_with_an_acknowledgement_is_noticed);
    RUN_TEST(an_address_reaches_its_chip_alone);
    RUN_TEST(a_chip_that_does_not_fit_is_refused);
    RUN_TEST(a_fault_that_is_none_is_refused);
    RUN_TEST(a_stuck_line_reads_nothing_and_comes_back);
    RUN_TEST(noise_turns_as_many_bits_as_it_says);
    RUN_TEST(noise_is_the_same_for_the_same_seed);
    RUN_TEST(noise_on_a_wire_spoils_some_reads);
    RUN_TEST(a_broken_rule_is_told_with_the_number_of_all);
    return UNITY_END();
}
