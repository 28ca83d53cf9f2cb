/* signal/: lag, lead-lag, washout, dead time, ramp.
 *
 * Contract                                             float32      Q7.24
 *   lag T = 60 s, h = 0.05 s, step, against 1-exp      5e-4         5e-4      (h/2T of backward Euler)
 *   lead-lag 90/30 s, h = 0.05 s, step, against exact  2e-3         2e-3
 *   washout, Td = 40 s, Tf = 20 s, h = 0.05 s, ramp    2e-3         2e-3
 *   each against its own recursion in double           5e-7         5e-7
 *   lag T = 10 h at 0.05 s ticks, after one T          1e-5         1e-5      of the recursion in double
 *   value at rest, all                                 one step     one step
 *   dead time with a fraction, of a straight line      2e-7         2e-7
 *   ramp of 1e-6 per second at 0.05 s                  1e-6 relative of the way; arrives exactly
 */
#include <math.h>
#include <string.h>

#include "csv.h"
#include "formats.h"
#include "ranges.h"
#include "signal/dead_time.h"
#include "signal/lag.h"
#include "signal/lead_lag.h"
#include "signal/ramp.h"
#include "signal/washout.h"
#include "unity.h"

#define STEP 6e-8 /* one step of num_t at 1: 2^-24 */

void setUp(void) {}
void tearDown(void) {}

static void the_continuous_step_responses_are_met_to_the_order_of_the_step_interval(void)
{
    const float h = 0.05f;
    struct lag lag;
    struct lead_lag lead_lag;
    struct washout washout;
    TEST_ASSERT_EQUAL_INT(ERR_OK, lag_init(&lag, 60.0f, h));
    TEST_ASSERT_EQUAL_INT(ERR_OK, lead_lag_init(&lead_lag, 90.0f, 30.0f, h));
    TEST_ASSERT_EQUAL_INT(ERR_OK, washout_init(&washout, 1.0f, 40.0f, 20.0f, h));
    FILE *f = csv_open("reference/signal_response.csv");
    double v[4];
    int done = 0, rows = 0;
    while (csv_row(f, v, 4)) {
        int due = (int)lround(v[0] / 0.05);
        num_t a = num_zero(), b = num_zero(), c = num_zero();
        for (; done < due; done++) {
            a = lag_step(&lag, num_one());
            b = lead_lag_step(&lead_lag, num_one());
            c = washout_step(&washout, N((done + 1) * 0.05 / 60.0));
        }
        if (due > 0) {
            TEST_ASSERT_DOUBLE_WITHIN(5e-4, v[1], D(a));
            TEST_ASSERT_DOUBLE_WITHIN(2e-3, v[2], D(b));
            TEST_ASSERT_DOUBLE_WITHIN(2e-3, v[3], D(c));
        }
        rows++;
    }
    fclose(f);
    TEST_ASSERT_GREATER_THAN(20, rows);
}

static void the_filters_follow_their_recursions_in_double(void)
{
    const double h = 0.5, T = 40.0, lead = 25.0, Td = 12.0, Tf = 3.0;
    struct lag lag;
    struct lead_lag lead_lag;
    struct washout washout;
    TEST_ASSERT_EQUAL_INT(ERR_OK, lag_init(&lag, (float)T, (float)h));
    TEST_ASSERT_EQUAL_INT(ERR_OK, lead_lag_init(&lead_lag, (float)lead, (float)T, (float)h));
    TEST_ASSERT_EQUAL_INT(ERR_OK, washout_init(&washout, -1.5f, (float)Td, (float)Tf, (float)h));
    double y1 = 0, y2 = 0, d = 0, last = 0, worst = 0;
    for (int k = 0; k < 5000; k++) {
        num_t x = N(0.5 + 0.4 * sin(0.013 * k) + 0.05 * sin(1.7 * k));
        double xd = D(x);
        y1 += h / (T + h) * (xd - y1);
        y2 += h / (T + h) * (xd - y2) + lead / (T + h) * (xd - last);
        d += -1.5 * Td / (Tf + h) * (xd - last) - h / (Tf + h) * d;
        last = xd;
        worst = fmax(worst, fabs(D(lag_step(&lag, x)) - y1));
        worst = fmax(worst, fabs(D(lead_lag_step(&lead_lag, x)) - y2));
        worst = fmax(worst, fabs(D(washout_step(&washout, x)) - d));
    }
    printf("filters: worst deviation from double %.2g\n", worst);
    TEST_ASSERT_TRUE(worst < 5e-7);
}

static void a_ten_hour_lag_at_50_ms_ticks_does_not_stall(void)
{
    struct lag lag;
    TEST_ASSERT_EQUAL_INT(ERR_OK, lag_init(&lag, 36000.0f, 0.05f));
    lag_reset(&lag, N(0.5));
    double y = 0.5, k = 0.05 / 36000.05;
    num_t x = N(0.501), out = num_zero();
    for (int i = 0; i < 720000; i++) {
        y += k * (D(x) - y);
        out = lag_step(&lag, x);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5 * 0.001 + STEP, y, D(out));
    for (int i = 0; i < 12 * 720000; i++)
        out = lag_step(&lag, x);
    TEST_ASSERT_DOUBLE_WITHIN(1.01 * STEP, D(x), D(out)); /* arrives */
}

static void a_lag_or_lead_lag_without_dynamics_passes_the_input_bit_for_bit(void)
{
    struct lag lag;
    struct lead_lag lead_lag;
    TEST_ASSERT_EQUAL_INT(ERR_OK, lag_init(&lag, 0.0f, 0.3f));
    TEST_ASSERT_EQUAL_INT(ERR_OK, lead_lag_init(&lead_lag, 7.0f, 7.0f, 0.3f));
    for (int i = 0; i < 1000; i++) {
        num_t x = N(sin(0.7 * i) * (i % 7 ? 1.0 : 1e-6));
        TEST_ASSERT_TRUE(num_eq(x, lag_step(&lag, x)));
        TEST_ASSERT_TRUE(num_eq(x, lead_lag_step(&lead_lag, x)));
    }
}

static void a_lead_lag_has_gain_one_at_rest(void)
{
    const float leads[] = {0.0f, 3.0f, 300.0f}, lags[] = {4.0f, 77.0f, 1000.0f};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            struct lead_lag f;
            TEST_ASSERT_EQUAL_INT(ERR_OK, lead_lag_init(&f, leads[i], lags[j], 1.0f));
            num_t out = num_zero();
            for (int k = 0; k < 40 * 1000; k++)
                out = lead_lag_step(&f, N(0.37));
            TEST_ASSERT_DOUBLE_WITHIN(STEP, D(N(0.37)), D(out));
        }
    }
}

static void every_filter_reset_to_a_value_stays_there(void)
{
    num_t ring[64];
    struct lag lag;
    struct lead_lag lead_lag;
    struct washout washout;
    struct dead_time dead_time;
    struct ramp ramp;
    num_t x = N(0.6180339);
    TEST_ASSERT_EQUAL_INT(ERR_OK, lag_init(&lag, 33.0f, 0.1f));
    TEST_ASSERT_EQUAL_INT(ERR_OK, lead_lag_init(&lead_lag, 5.0f, 33.0f, 0.1f));
    TEST_ASSERT_EQUAL_INT(ERR_OK, washout_init(&washout, 8.0f, 33.0f, 3.0f, 0.1f));
    TEST_ASSERT_EQUAL_INT(ERR_OK, dead_time_init(&dead_time, 1.234f, 0.1f, ring, sizeof ring));
    TEST_ASSERT_EQUAL_INT(ERR_OK, ramp_init(&ramp, 0.01f, 0.1f));
    lag_reset(&lag, x);
    lead_lag_reset(&lead_lag, x);
    washout_reset(&washout, x);
    dead_time_reset(&dead_time, x);
    ramp_reset(&ramp, x);
    for (int i = 0; i < 100; i++) {
        TEST_ASSERT_TRUE(num_eq(x, lag_step(&lag, x)));
        TEST_ASSERT_TRUE(num_eq(x, lead_lag_step(&lead_lag, x)));
        TEST_ASSERT_TRUE(num_eq(num_zero(), washout_step(&washout, x)));
        TEST_ASSERT_TRUE(num_eq(x, dead_time_step(&dead_time, x)));
        TEST_ASSERT_TRUE(num_eq(x, ramp_step(&ramp, x)));
    }
}

static void a_slow_washout_forgets_completely(void)
{
    struct washout f;
    TEST_ASSERT_EQUAL_INT(ERR_OK, washout_init(&f, 1.0f, 4000.0f, 500.0f, 0.05f));
    num_t out = washout_step(&f, N(0.1));
    TEST_ASSERT_TRUE(D(out) > 0.7);
    for (int i = 0; i < 20 * 10000; i++)
        out = washout_step(&f, N(0.1));
    TEST_ASSERT_DOUBLE_WITHIN(STEP, 0.0, D(out));
}

static void a_dead_time_of_whole_steps_repeats_its_input_later_exactly(void)
{
    num_t ring[8];
    struct dead_time f;
    TEST_ASSERT_EQUAL_UINT(5 * sizeof(num_t),
                           dead_time_bytes(0.3f, 0.1f)); /* 3 steps, rounding forgiven */
    TEST_ASSERT_EQUAL_INT(ERR_OK, dead_time_init(&f, 0.3f, 0.1f, ring, sizeof ring));
    for (int k = 0; k < 50; k++) {
        num_t out = dead_time_step(&f, N(0.01 * k));
        TEST_ASSERT_TRUE(num_eq(k < 3 ? num_zero() : N(0.01 * (k - 3)), out));
    }
}

static void a_dead_time_a_hair_below_a_whole_step_counts_as_whole(void)
{
    num_t ring[5];
    struct dead_time f;
    TEST_ASSERT_EQUAL_INT(ERR_OK, dead_time_init(&f, 2.9995f, 1.0f, ring, sizeof ring));
    for (int k = 0; k < 9; k++)
        TEST_ASSERT_TRUE(num_eq(k < 3 ? num_zero() : num_one(), dead_time_step(&f, num_one())));
}

static void no_dead_time_passes_the_input(void)
{
    num_t ring[2];
    struct dead_time f;
    TEST_ASSERT_EQUAL_INT(ERR_OK, dead_time_init(&f, 0.0f, 0.1f, ring, sizeof ring));
    for (int k = 0; k < 5; k++)
        TEST_ASSERT_TRUE(num_eq(N(0.1 * k), dead_time_step(&f, N(0.1 * k))));
}

static void a_fraction_of_a_step_is_interpolated(void)
{
    num_t ring[8];
    struct dead_time f;
    TEST_ASSERT_EQUAL_INT(ERR_OK, dead_time_init(&f, 2.6f, 1.0f, ring, sizeof ring));
    for (int k = 0; k < 60; k++) {
        num_t out = dead_time_step(&f, N(0.01 * k));
        if (k >= 4)
            TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.01 * (k - 2.6), D(out));
    }
}

static void a_ramp_moves_at_its_rate_and_arrives_exactly(void)
{
    struct ramp f;
    TEST_ASSERT_EQUAL_INT(ERR_OK, ramp_init(&f, 0.02f, 0.5f));
    num_t last = num_zero();
    for (int k = 1; k <= 100; k++) {
        num_t out = ramp_step(&f, N(0.335));
        TEST_ASSERT_TRUE(D(out) - D(last) < 0.01 + 2 * STEP);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, fmin(0.01 * k, 0.335), D(out));
        last = out;
    }
    TEST_ASSERT_TRUE(num_eq(N(0.335), last));
    for (int k = 1; k <= 100; k++)
        last = ramp_step(&f, N(-0.1));
    TEST_ASSERT_TRUE(num_eq(N(-0.1), last));
}

static void a_ramp_of_a_millionth_per_second_does_not_stall(void)
{
    struct ramp f;
    TEST_ASSERT_EQUAL_INT(ERR_OK, ramp_init(&f, 1e-6f, 0.05f));
    ramp_reset(&f, N(0.5));
    num_t out = num_zero();
    for (int k = 0; k < 1000000; k++)
        out = ramp_step(&f, N(0.9));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * 0.05 + STEP, 0.55, D(out));
}

static void a_ramp_without_rate_jumps(void)
{
    struct ramp f;
    TEST_ASSERT_EQUAL_INT(ERR_OK, ramp_init(&f, 0.0f, 0.05f));
    TEST_ASSERT_TRUE(num_eq(N(0.7), ramp_step(&f, N(0.7))));
    TEST_ASSERT_TRUE(num_eq(N(-0.7), ramp_step(&f, N(-0.7))));
}

static void bad_arguments_are_refused_and_change_nothing(void)
{
    const float nan = nanf(""), inf = HUGE_VALF;
    struct lag lag, lag_was;
    struct lead_lag lead_lag;
    struct washout washout;
    struct ramp ramp;
    struct dead_time dead_time;
    num_t ring[4];
    TEST_ASSERT_EQUAL_INT(ERR_OK, lag_init(&lag, 1.0f, 1.0f));
    memcpy(&lag_was, &lag, sizeof lag);
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, lag_init(&lag, nan, 1.0f));
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, lag_init(&lag, inf, 1.0f));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, lag_init(&lag, -1.0f, 1.0f));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, lag_init(&lag, 1.0f, 0.0f));
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, lag_init(&lag, 1.0f, nan));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, lag_retune(&lag, 2e6f, 1.0f));
    TEST_ASSERT_EQUAL_MEMORY(&lag_was, &lag, sizeof lag);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE,
                          lead_lag_init(&lead_lag, 200.0f, 0.0f, 1.0f)); /* a bare lead */
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, lead_lag_init(&lead_lag, nan, 1.0f, 1.0f));
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, lead_lag_init(&lead_lag, 1.0f, nan, 1.0f));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, lead_lag_init(&lead_lag, 1.0f, -1.0f, 1.0f));
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, washout_init(&washout, nan, 1.0f, 1.0f, 1.0f));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, washout_init(&washout, 1.0f, -1.0f, 1.0f, 1.0f));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, washout_init(&washout, 1.0f, 1.0f, -1.0f, 1.0f));
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, ramp_init(&ramp, nan, 1.0f));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, ramp_init(&ramp, -1.0f, 1.0f));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, ramp_init(&ramp, 1e-12f, 1.0f));
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, dead_time_init(&dead_time, nan, 1.0f, ring, sizeof ring));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, dead_time_init(&dead_time, -1.0f, 1.0f, ring, sizeof ring));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, dead_time_init(&dead_time, 1e6f, 1.0f, ring, sizeof ring));
    TEST_ASSERT_EQUAL_INT(ERR_MEMORY, dead_time_init(&dead_time, 3.0f, 1.0f, ring, sizeof ring));
    TEST_ASSERT_EQUAL_INT(ERR_MEMORY, dead_time_init(&dead_time, 1.0f, 1.0f, NULL, 0));
    TEST_ASSERT_EQUAL_UINT(0, dead_time_bytes(-1.0f, 1.0f));
    TEST_ASSERT_EQUAL_UINT(0, dead_time_bytes(1.0f, nan));
}

/* ---- ranges ---- */

static struct {
    real_t first, second, third, interval;
} given;

static enum err try_lag(void)
{
    struct lag lag;
    return lag_init(&lag, given.first, given.interval);
}

static enum err try_lead_lag(void)
{
    struct lead_lag filter;
    return lead_lag_init(&filter, given.first, given.second, given.interval);
}

static enum err try_washout(void)
{
    struct washout washout;
    return washout_init(&washout, given.third, given.first, given.second, given.interval);
}

static enum err try_ramp(void)
{
    struct ramp ramp;
    return ramp_init(&ramp, given.first, given.interval);
}

static enum err try_dead_time(void)
{
    return dead_time_bytes(given.first, given.interval) > 0 ? ERR_OK : ERR_RANGE;
}

static void arguments_have_the_ranges_that_are_stated(void)
{
    static const struct range one[] = {{"first", 0, 0, 1e6, FROM}};
    static const struct range two[] = {{"first", 0, 0, 1e6, FROM},
                                       {"second", sizeof(real_t), 0, 1e6, FROM}};
    static const struct range scale[] = {{"third", 2 * sizeof(real_t), -1e6, 1e6, FROM}};
    static const struct range rate[] = {{"first", 0, 1e-9, 1e6, FROM}};
    given.first = given.second = given.third = given.interval = REAL_C(1e5);
    CHECK(given, one, try_lag);
    CHECK(given, two, try_lead_lag);
    CHECK(given, two, try_washout);
    CHECK(given, scale, try_washout);
    CHECK(given, rate, try_ramp);
    given.interval = REAL_C(1e3);
    CHECK(given, one, try_dead_time);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_continuous_step_responses_are_met_to_the_order_of_the_step_interval);
    RUN_TEST(the_filters_follow_their_recursions_in_double);
    RUN_TEST(a_ten_hour_lag_at_50_ms_ticks_does_not_stall);
    RUN_TEST(a_lag_or_lead_lag_without_dynamics_passes_the_input_bit_for_bit);
    RUN_TEST(a_lead_lag_has_gain_one_at_rest);
    RUN_TEST(every_filter_reset_to_a_value_stays_there);
    RUN_TEST(a_slow_washout_forgets_completely);
    RUN_TEST(a_dead_time_of_whole_steps_repeats_its_input_later_exactly);
    RUN_TEST(a_dead_time_a_hair_below_a_whole_step_counts_as_whole);
    RUN_TEST(no_dead_time_passes_the_input);
    RUN_TEST(a_fraction_of_a_step_is_interpolated);
    RUN_TEST(a_ramp_moves_at_its_rate_and_arrives_exactly);
    RUN_TEST(a_ramp_of_a_millionth_per_second_does_not_stall);
    RUN_TEST(a_ramp_without_rate_jumps);
    RUN_TEST(bad_arguments_are_refused_and_change_nothing);
    RUN_TEST(arguments_have_the_ranges_that_are_stated);
    return UNITY_END();
}
