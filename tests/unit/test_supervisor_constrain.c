/* Operating limits and rates of the outputs. */
#include "exchange/span.h"
#include "random_source.h"
#include "supervisor_bench.h"

void setUp(void)
{
    bench_start();
}
void tearDown(void) {}

static void an_acting_loop_stays_inside_the_operating_limits(void)
{
    put("mv2.min", "0.4");
    put("mv2.max", "1.6");
    apply();
    mode(BOTTOM, LOOP_AUTO);
    tick();
    reading(T10, 70);
    ticks(50);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.8, sent(HEAT));
    reading(T10, 159);
    ticks(50);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.2, sent(HEAT));
}

static void an_output_comes_off_its_limit_as_soon_as_the_error_turns(void)
{
    put("mv2.max", "1.6");
    apply();
    mode(BOTTOM, LOOP_AUTO);
    tick();
    reading(T10, 110);
    ticks(5000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.8, sent(HEAT));
    reading(T10, 116);
    ticks(2);
    TEST_ASSERT_TRUE(sent(HEAT) < 0.79);
}

static void manual_is_limited_too_but_may_rest_at_the_safe_value(void)
{
    put("mv2.min", "0.4");
    apply();
    out(BOTTOM, 0.2);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, sent(HEAT)); /* between safe (0) and min */
    out(BOTTOM, 0);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
    put("mv2.safe", "0.5");
    apply();
    out(BOTTOM, 0.2);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.2, sent(HEAT));
}

static void the_rate_limits_automatic_and_manual(void)
{
    set_and_apply("mv2.rate", "0.1"); /* a twentieth of the span a second */
    out(BOTTOM, 1.6);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(HEAT));
    ticks(10);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.8, sent(HEAT));
    mode(BOTTOM, LOOP_AUTO);
    tick();
    reading(T10, 155);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.75, sent(HEAT));
}

static void manual_may_rest_at_a_safe_value_above_the_highest(void)
{
    put("mv2.max", "1");
    set_and_apply("mv2.safe", "1.5");
    out(BOTTOM, 1.9);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.75, sent(HEAT));
}

static void the_rate_holds_from_the_first_command_after_the_safe_state(void)
{
    set_and_apply("mv2.rate", "0.1");
    supervisor_go_safe(&bench.s, "test");
    out(BOTTOM, 1.6); /* no tick in between */
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.05, sent(HEAT));
}

static void the_safe_state_does_not_wait_for_the_rate(void)
{
    set_and_apply("mv2.rate", "0.01");
    supervisor_go_safe(&bench.s, "test");
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
}

static void a_rate_below_the_resolution_of_a_tick_does_not_freeze_the_output(void)
{
    bench.tick_ms = 50;
    set_and_apply("mv2.rate", "5e-7"); /* 1.25e-8 of span a tick */
    out(BOTTOM, 0);
    ticks(20000);
    TEST_ASSERT_DOUBLE_WITHIN(2e-5, 0.5 - 20000 * 1.25e-8, sent(HEAT));
    TEST_ASSERT_TRUE(sent(HEAT) < 0.4999);
}

static void new_limits_are_entered_at_the_rate(void)
{
    put("mv2.rate", "0.1");
    put("mv2.max", "0.6");
    apply();
    mode(BOTTOM, LOOP_AUTO);
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.45, sent(HEAT));
    ticks(10);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.3, sent(HEAT));
}

static void a_rate_limited_loop_does_not_wind_up(void)
{
    set_and_apply("mv2.rate", "0.002");
    mode(BOTTOM, LOOP_AUTO);
    tick();
    reading(T10, 75);
    ticks(100); /* far behind what it wants */
    double at = sent(HEAT);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.6, at);
    reading(T10, 125);
    ticks(20);
    TEST_ASSERT_TRUE(sent(HEAT) < at - 0.015);
}

/* Behind its rate, a loop is told where the output is when its turn comes again, not where it was one base tick after. */
static void a_rate_the_output_keeps_up_with_between_turns_takes_nothing_from_the_integral(void)
{
    static const char *const forms[] = {"positional", "velocity"};
    for (unsigned f = 0; f < 2; f++) {
        double at[2];
        for (unsigned limited = 0; limited < 2; limited++) {
            bench_start();
            put_all((const char *const[]){"loop2.divisor", "20", "loop2.tt", "20",
                                          "loop2.algorithm", forms[f], "mv2.rate",
                                          limited ? "0.02" : "0", NULL}); /* 0.2 of span a turn */
            apply();
            mode(BOTTOM, LOOP_AUTO);
            ticks(40);
            reading(T10, 107); /* asks for 0.12 at once */
            ticks(199);
            at[limited] = sent(HEAT);
        }
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, at[0], at[1]);
    }
}

static void a_rate_limited_loop_with_a_divisor_does_not_wind_up(void)
{
    static const char *const forms[] = {"positional", "velocity"};
    for (unsigned f = 0; f < 2; f++) {
        bench_start();
        put_all((const char *const[]){"loop2.divisor", "10", "mv2.rate", "0.002", "loop2.tt", "30",
                                      "loop2.algorithm", forms[f], NULL});
        apply();
        mode(BOTTOM, LOOP_AUTO);
        ticks(10);
        reading(T10, 75);
        ticks(100);
        double at = sent(HEAT);
        TEST_ASSERT_DOUBLE_WITHIN(0.011, 0.6, at);
        reading(T10, 125);
        ticks(20); /* its turn, and then at the rate */
        TEST_ASSERT_TRUE(sent(HEAT) < at - 0.005);
    }
}

/* 200,000 spans, drawn: what is sent at the fraction of a limit is the limit itself, and nothing below it is sent as more. */
static void what_is_sent_never_passes_a_limit_by_rounding(void)
{
    struct random_source from = {32};
    for (unsigned n = 0; n < 200000; n++) {
        float a = (float)(int32_t)random_next(&from) / 65536.0f;
        float b = (float)random_below(&from, 1000000) / 997.0f + 0.001f;
        struct mv_config c = {.lo = a, .hi = a + b};
        c.max = c.lo + (c.hi - c.lo) * (float)random_below(&from, 1000) / 999.0f;
        c.min = c.safe = c.lo;
        if (!(c.max <= c.hi))
            continue;
        num_t most = span_to_fraction(c.max, c.lo, c.hi);
        char text[80];
        (void)snprintf(text, sizeof text, "seed 32, case %u: %.9g > %.9g", n,
                       (double)mv_to_eu(most, &c), (double)c.max);
        TEST_ASSERT_TRUE_MESSAGE(mv_to_eu(most, &c) <= c.max, text);
        num_t less = num_sub(most, num_from_float(1.0f / 16777216.0f));
        TEST_ASSERT_TRUE_MESSAGE(mv_to_eu(less, &c) <= c.max, text);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_acting_loop_stays_inside_the_operating_limits);
    RUN_TEST(an_output_comes_off_its_limit_as_soon_as_the_error_turns);
    RUN_TEST(manual_is_limited_too_but_may_rest_at_the_safe_value);
    RUN_TEST(the_rate_limits_automatic_and_manual);
    RUN_TEST(manual_may_rest_at_a_safe_value_above_the_highest);
    RUN_TEST(the_rate_holds_from_the_first_command_after_the_safe_state);
    RUN_TEST(the_safe_state_does_not_wait_for_the_rate);
    RUN_TEST(a_rate_below_the_resolution_of_a_tick_does_not_freeze_the_output);
    RUN_TEST(new_limits_are_entered_at_the_rate);
    RUN_TEST(a_rate_limited_loop_does_not_wind_up);
    RUN_TEST(a_rate_the_output_keeps_up_with_between_turns_takes_nothing_from_the_integral);
    RUN_TEST(a_rate_limited_loop_with_a_divisor_does_not_wind_up);
    RUN_TEST(what_is_sent_never_passes_a_limit_by_rounding);
    return UNITY_END();
}
