/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* What a wiring file has at the board's own converter, pulse inputs and contacts is what the firmware reads, and their faults are told where they
 * show: by the reading, by a proof of the pump, by an output that counts the mains. */
#include "pins_bench.h"

#define PROOF_S 5u

static const char wiring[] = "I    analog PC0 lo=0 hi=10 lo_in=0.4 hi_in=2\n"
                             "F    flow   PC9\n"
                             "N    flow   PD2 quantity=F\n"
                             "L    level  PC8 limit=5 hysteresis=1 bounce=15\n"
                             "grid mains  PC7\n"
                             "P    ssr    PB0\n"
                             "Q    ssr    PB1\n";

void setUp(void)
{
    pins_power_on(wiring);
    PINS_ASK("begin", "set io.source board", "set tick.base 1");
    PINS_ASK("set chan1.name I", "set chan1.device analog", "set chan1.select PC0",
             "set chan1.type 4-20mA", "set chan1.lo 0", "set chan1.hi 10", "set meas1.name I",
             "set meas1.hi 10");
    PINS_ASK("set chan2.name F", "set chan2.device flow", "set chan2.select PC9",
             "set meas2.name F", "set meas2.hi 1000");
    PINS_ASK("set chan3.name N", "set chan3.device pulses", "set chan3.select PD2",
             "set meas3.name N", "set meas3.hi 65536");
    PINS_ASK("set chan4.name L", "set chan4.device level", "set chan4.select PC8",
             "set meas4.name L");
    PINS_ASK("set out1.name P", "set out1.kind window", "set out1.pin PB0", "set out1.hi 1",
             "set out1.proof flows", "set out1.proof_at chan2", "set out1.proof_change 10",
             "set out1.proof_on 5", "set out1.proof_off 5", "set mv1.name P", "set mv1.hi 1",
             "set mv1.max 1");
    PINS_ASK("set out2.name Q", "set out2.kind burst", "set out2.pin PB1",
             "set out2.zero_cross PC7", "set out2.hi 1", "set mv2.name Q", "set mv2.hi 1",
             "set mv2.max 1");
    pins_measure("I", 5);
    PINS_ASK("apply", "log on");
    pins_samples(5);
}

void tearDown(void)
{
    pins_close();
}

static void a_current_is_read_and_its_shorts_are_told(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 5.0, pins_field("I")); /* two of 4,095 codes */
    pins_fault("I", "short_high", 1);
    pins_samples(2);
    TEST_ASSERT_TRUE_MESSAGE(said("SENSOR_FAULT I"), board.said);
    TEST_ASSERT_TRUE(said("out of range"));
    pins_fault("I", "short_high", 0);
    pins_samples(2);
    TEST_ASSERT_TRUE_MESSAGE(said("SENSOR_FINE I"), board.said);
    pins_fault("I", "open", 1);
    pins_samples(2);
    TEST_ASSERT_TRUE_MESSAGE(said("MEASUREMENT_BAD I"), board.said);
}

static void noise_is_the_mean_of_16_conversions(void)
{
    double sum = 0.0;
    pins_fault("I", "pickup", 0.1);
    for (unsigned n = 0; n < 100; n++) {
        pins_samples(1);
        sum += (pins_field("I") - 5.0) * (pins_field("I") - 5.0);
    }
    double expected = 0.1 / 4.0 / 1.6 * 10.0; /* of the value: 1.6 V are 10 */
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * expected / sqrt(200.0), expected, sqrt(sum / 100.0));
}

static void two_flow_meters_count_the_same_pulses(void)
{
    pins_measure("F", 37.5);
    pins_measure("N", 37.5);
    double before = pins_field("N");
    pins_samples(20);
    TEST_ASSERT_DOUBLE_WITHIN(2.0, 37.5, pins_field("F"));
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 20 * 37.5, pins_field("N") - before);
}

static void a_pump_whose_flow_meter_stands_is_told(void)
{
    pins_measure("F", 50);
    ask_ok("out P 1");
    pins_samples(3u * PROOF_S);
    TEST_ASSERT_FALSE_MESSAGE(said("OUTPUT_CONTRADICTED"), board.said);
    pins_fault("F", "stopped", 1);
    pins_samples(2u * PROOF_S + 2u);
    TEST_ASSERT_TRUE_MESSAGE(said("on, and nothing flows"), board.said);
    pins_fault("F", "stopped", 0);
    pins_samples(2u * PROOF_S + 2u);
    TEST_ASSERT_TRUE_MESSAGE(said("OUTPUT_ACTS P"), board.said);
}

static void pulses_without_a_pump_are_told(void)
{
    ask_ok("out P 0");
    pins_samples(3u * PROOF_S);
    TEST_ASSERT_FALSE_MESSAGE(said("OUTPUT_CONTRADICTED"), board.said);
    pins_fault("F", "pickup", 60);
    pins_samples(2u * PROOF_S + 2u);
    TEST_ASSERT_TRUE_MESSAGE(said("off, and it flows"), board.said);
}

static void a_contact_that_bounces_changes_once(void)
{
    unsigned changes = 0;
    double before = pins_field("L");
    for (unsigned n = 0; n < 40; n++) {
        pins_measure("L", n % 4 < 2 ? 6 : 0);
        pins_samples(1);
        changes += pins_field("L") != before;
        before = pins_field("L");
    }
    TEST_ASSERT_EQUAL_UINT(20, changes);
}

static void the_mains_are_found_lost_and_found_again(void)
{
    pins_fault("grid", "lost", 1);
    pins_samples(2);
    TEST_ASSERT_TRUE_MESSAGE(said("OUTPUT_FAULT Q"), board.said);
    TEST_ASSERT_TRUE(said("no zero crossings"));
    pins_fault("grid", "lost", 0);
    pins_samples(3);
    TEST_ASSERT_TRUE_MESSAGE(said("OUTPUT_FINE Q 50"), board.said);
    pins_fault("grid", "shift", -12);
    pins_samples(3);
    TEST_ASSERT_TRUE_MESSAGE(said("OUTPUT_FAULT Q"), board.said);
    pins_fault("grid", "shift", 10);
    pins_samples(3);
    TEST_ASSERT_TRUE_MESSAGE(said("OUTPUT_FINE Q "), board.said);
}

/* Half waves of a heater that is half on, whether crossings come or not. */
static void a_burst_is_half_on_with_and_without_the_mains(void)
{
    ask_ok("out Q 0.5");
    pass(2000);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.5, pins_mean("Q", 10000));
    pins_fault("grid", "lost", 1);
    pass(2000);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.5, pins_mean("Q", 10000));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_current_is_read_and_its_shorts_are_told);
    RUN_TEST(noise_is_the_mean_of_16_conversions);
    RUN_TEST(two_flow_meters_count_the_same_pulses);
    RUN_TEST(a_pump_whose_flow_meter_stands_is_told);
    RUN_TEST(pulses_without_a_pump_are_told);
    RUN_TEST(a_contact_that_bounces_changes_once);
    RUN_TEST(the_mains_are_found_lost_and_found_again);
    RUN_TEST(a_burst_is_half_on_with_and_without_the_mains);
    return UNITY_END();
}
