/* The test signal on an output, and what back-calculation makes of it. */
#include "supervisor_bench.h"

void setUp(void)
{
    bench_start();
}
void tearDown(void) {}

static void excite(uint8_t j, double fraction)
{
    supervisor_excite(&bench.s, j, num_from_float((float)fraction));
}

static void a_test_signal_lies_on_a_manual_output_and_goes_without_a_trace(void)
{
    out(BOTTOM, 1.0);
    tick();
    excite(HEAT, 0.1);
    ticks(20);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, sent(HEAT));
    excite(HEAT, -0.1);
    ticks(20);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, sent(HEAT));
    excite(HEAT, 0);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, sent(HEAT));
}

static void a_test_signal_stays_inside_the_operating_limits(void)
{
    set_and_apply("mv2.max", "1.1");
    out(BOTTOM, 1.0);
    tick();
    excite(HEAT, 0.3);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(HEAT));
}

static void a_loop_takes_over_what_lies_below_the_test_signal(void)
{
    reading(T10, 110);
    out(BOTTOM, 1.0);
    ticks(3);
    excite(HEAT, 0.1);
    ticks(5);
    mode(BOTTOM, LOOP_AUTO); /* at the measurement: nothing to correct */
    ticks(5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.6, sent(HEAT));
    mode(BOTTOM, LOOP_MANUAL);
    ticks(5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.6, sent(HEAT));
    excite(HEAT, 0);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.5, sent(HEAT));
}

static void a_loop_that_acts_does_not_take_the_test_signal_for_its_own_output(void)
{
    mode(BOTTOM, LOOP_AUTO); /* at the measurement: nothing to correct */
    ticks(5);
    double before = sent(HEAT);
    excite(HEAT, 0.05);
    ticks(100);
    excite(HEAT, 0);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, before, sent(HEAT));
}

static void the_safe_state_ends_a_test_signal(void)
{
    out(BOTTOM, 1.0);
    tick();
    excite(HEAT, 0.1);
    tick();
    supervisor_go_safe(&bench.s, "link");
    out(BOTTOM, 1.0);
    ticks(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, sent(HEAT));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_test_signal_lies_on_a_manual_output_and_goes_without_a_trace);
    RUN_TEST(a_test_signal_stays_inside_the_operating_limits);
    RUN_TEST(a_loop_takes_over_what_lies_below_the_test_signal);
    RUN_TEST(a_loop_that_acts_does_not_take_the_test_signal_for_its_own_output);
    RUN_TEST(the_safe_state_ends_a_test_signal);
    return UNITY_END();
}
