/* Pseudorandom binary signals. Their correlations are sums of +-1, so all of it is exact. */
#include <math.h>
#include <string.h>

#include "identify/prbs.h"
#include "unity.h"

#define ROOM 2100

static struct prbs_settings settings;
static struct prbs prbs;
static int level[PRBS_INPUTS][ROOM];
static const char *field, *wanted;

void setUp(void)
{
    settings = (struct prbs_settings){
        .inputs = 2, .bits = 7, .independence = PRBS_SHIFTS, .clock = 1, .amplitude = {1, 1, 1, 1}};
    field = wanted = "";
}

void tearDown(void) {}

static void run(unsigned samples)
{
    TEST_ASSERT_EQUAL(ERR_OK, prbs_check(&settings, NULL, NULL));
    prbs_init(&prbs, &settings);
    for (unsigned k = 0; k < samples; k++) {
        real_t u[PRBS_INPUTS];
        prbs_step(&prbs, u);
        for (unsigned j = 0; j < settings.inputs; j++)
            level[j][k] = u[j] > 0 ? 1 : -1;
    }
}

/* Sum over a period of input i times input j lag later, of sequences that repeat after n. */
static int correlation(unsigned i, unsigned j, unsigned lag, unsigned n)
{
    int sum = 0;
    for (unsigned k = 0; k < n; k++)
        sum += level[i][k] * level[j][(k + lag) % n];
    return sum;
}

static void refused(enum err err, const char *name)
{
    TEST_ASSERT_EQUAL(err, prbs_check(&settings, &field, &wanted));
    TEST_ASSERT_EQUAL_STRING(name, field);
    TEST_ASSERT_NOT_EQUAL('\0', wanted[0]);
}

static void test_a_register_of_every_length_passes_through_all_its_states(void)
{
    settings.inputs = 1;
    for (unsigned bits = PRBS_BITS_LEAST; bits <= PRBS_BITS_MOST; bits++) {
        settings.bits = (uint8_t)bits;
        TEST_ASSERT_EQUAL(ERR_OK, prbs_check(&settings, NULL, NULL));
        prbs_init(&prbs, &settings);
        const uint16_t began = prbs.state[0];
        uint32_t steps = 0;
        real_t u;
        do {
            prbs_step(&prbs, &u);
            steps++;
        } while (prbs.state[0] != began && steps < 70000);
        TEST_ASSERT_EQUAL_UINT32(prbs_period(&settings), steps);
        TEST_ASSERT_EQUAL_UINT32((1u << bits) - 1u, steps);
    }
}

static void test_a_sequence_has_no_correlation_with_its_own_past(void)
{
    run(127);
    for (unsigned lag = 1; lag < 127; lag++)
        TEST_ASSERT_EQUAL(-1, correlation(0, 0, lag, 127));
}

static void test_shifts_of_a_sequence_are_uncorrelated_over_the_memory(void)
{
    settings.inputs = 4;
    run(127);
    const unsigned memory = prbs_memory(&settings);
    TEST_ASSERT_EQUAL(31, memory);
    for (unsigned i = 0; i < 4; i++)
        for (unsigned j = 0; j < 4; j++)
            for (unsigned lag = 0; lag < memory && i != j; lag++)
                TEST_ASSERT_EQUAL(-1, correlation(i, j, lag, 127));
}

static void test_registers_of_their_own_are_uncorrelated_over_both_periods(void)
{
    settings.independence = PRBS_REGISTERS;
    settings.bits = 5;
    run(31 * 63); /* the sum of each alone is 1, and all pairs of states occur once */
    for (unsigned lag = 0; lag < 31 * 63; lag += 13)
        TEST_ASSERT_EQUAL(1, correlation(0, 1, lag, 31 * 63));
}

static void test_the_clock_holds_every_level(void)
{
    settings.clock = 3;
    run(300);
    for (unsigned k = 0; k < 300; k++)
        TEST_ASSERT_EQUAL(level[0][k - k % 3], level[0][k]);
    settings.clock = 1;
    int slow[100];
    for (unsigned k = 0; k < 100; k++)
        slow[k] = level[0][3 * k];
    run(100);
    TEST_ASSERT_EQUAL_INT_ARRAY(slow, level[0], 100);
}

static void test_period_and_memory_count_samples(void)
{
    settings.clock = 5;
    TEST_ASSERT_EQUAL_UINT32(635, prbs_period(&settings));
    TEST_ASSERT_EQUAL_UINT32(315, prbs_memory(&settings));
    settings.independence = PRBS_REGISTERS;
    TEST_ASSERT_EQUAL_UINT32(635, prbs_memory(&settings));
}

static void test_every_input_has_its_amplitude(void)
{
    settings.amplitude[0] = REAL_C(0.25);
    settings.amplitude[1] = 0;
    prbs_init(&prbs, &settings);
    for (int k = 0; k < 127; k++) {
        real_t u[2];
        prbs_step(&prbs, u);
        TEST_ASSERT_TRUE(real_abs(u[0]) == REAL_C(0.25) && real_abs(u[1]) == REAL_C(0.0));
    }
}

static void test_settings_out_of_range_are_refused_by_name(void)
{
    settings.inputs = 5;
    refused(ERR_RANGE, "inputs");
    setUp();
    settings.independence = 2;
    refused(ERR_RANGE, "independence");
    setUp();
    settings.bits = 2;
    refused(ERR_RANGE, "bits");
    settings.bits = 16;
    refused(ERR_RANGE, "bits");
    setUp();
    settings.clock = 0;
    refused(ERR_RANGE, "clock");
    setUp();
    settings.amplitude[1] = REAL_C(-0.1);
    refused(ERR_RANGE, "amplitude");
    settings.amplitude[1] = (real_t)NAN;
    refused(ERR_NOT_FINITE, "amplitude");
}

static void test_the_longest_of_registers_of_their_own_has_to_exist(void)
{
    settings.independence = PRBS_REGISTERS;
    settings.inputs = 4;
    settings.bits = 12;
    TEST_ASSERT_EQUAL(ERR_OK, prbs_check(&settings, NULL, NULL));
    settings.bits = 13;
    refused(ERR_RANGE, "bits");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_register_of_every_length_passes_through_all_its_states);
    RUN_TEST(test_a_sequence_has_no_correlation_with_its_own_past);
    RUN_TEST(test_shifts_of_a_sequence_are_uncorrelated_over_the_memory);
    RUN_TEST(test_registers_of_their_own_are_uncorrelated_over_both_periods);
    RUN_TEST(test_the_clock_holds_every_level);
    RUN_TEST(test_period_and_memory_count_samples);
    RUN_TEST(test_every_input_has_its_amplitude);
    RUN_TEST(test_settings_out_of_range_are_refused_by_name);
    RUN_TEST(test_the_longest_of_registers_of_their_own_has_to_exist);
    return UNITY_END();
}
