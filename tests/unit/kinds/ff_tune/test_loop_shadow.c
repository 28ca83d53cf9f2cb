/* The shadow of a loop beside the loop itself, simulated in double.
 *
 * Contract: what the shadow says a loop would have
 * done without its feedforward is within 8 % r.m.s. of what the same loop does
 * without where that loop integrates another way, and within 0.1 % where it is the one the shadow is made for. */
#include <math.h>
#include <stdio.h>

#include "kinds/ff_tune/loop_shadow.h"
#include "siddha_loop.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void one_shadow_against_the_loop(int regime, double k, double lead, double lag)
{
    struct siddha_loop with, without;
    struct loop_shadow shadow;
    const struct fopdt m = {
        .gain = REAL_C(2.0), .dead_time_s = REAL_C(0.625), .time_constant_s = REAL_C(0.4)};
    double off = 0, size = 0;
    siddha_begin(&with, regime, 0, 1);
    siddha_begin(&without, regime, 0, 1);
    with.k = k;
    with.lead = lead;
    with.lag = lag;
    shadow_begin(&shadow, &m, REAL_C(0.325), REAL_C(0.66), REAL_C(0.05));
    for (long n = 0; n < 4000; n++) {
        double d = siddha_square((double)n * SIDDHA_TS, 15);
        siddha_step(&with, 0, d);
        siddha_step(&without, 0, d);
        /* the loop is with.y - y_shadow where it had no feedforward */
        double y = with.y - (double)shadow_step(&shadow, (real_t)with.ff);
        off += (y - without.y) * (y - without.y);
        size += without.y * without.y;
    }
    TEST_ASSERT_FALSE(shadow.lost);
    printf("case %s, K %.1f: off by %.2f %% r.m.s.\n", siddha_case[regime].name, k,
           100 * sqrt(off / size));
    /* The loop here integrates a sample sooner than kinds/pid/pid.h, which the shadow is made for: a part of h/Ti. */
    TEST_ASSERT_TRUE(sqrt(off / size) < 0.08);
}

static void it_says_what_the_loop_would_have_done_without(void)
{
    for (int c = 0; c < SIDDHA_CASES; c++) {
        one_shadow_against_the_loop(c, -1, 0.3, 0.2);
        one_shadow_against_the_loop(c, 0.5, 0, 0);
    }
}

/* The same controller as kinds/pid/pid.h: the integral takes an error in behind the proportional part. */
static void with_the_controller_of_the_firmware_it_is_exact(void)
{
    struct loop_shadow shadow;
    const struct fopdt m = {
        .gain = REAL_C(2.0), .dead_time_s = REAL_C(0.625), .time_constant_s = REAL_C(0.4)};
    double a = exp(-SIDDHA_TS / 0.4), x = 0, integral = 0, u[16] = {0}, off = 0, size = 0;
    shadow_begin(&shadow, &m, REAL_C(0.325), REAL_C(0.66), REAL_C(0.05));
    for (long n = 0; n < 3000; n++) {
        double v = siddha_square((double)n * SIDDHA_TS, 11), y = x;
        for (unsigned k = 15; k > 0; k--)
            u[k] = u[k - 1];
        u[0] = v - SIDDHA_GAIN * y + integral;
        integral -= SIDDHA_GAIN * SIDDHA_TS / SIDDHA_TI * y;
        x = a * x + 2 * (1 - a) * u[12];
        double said = (double)shadow_step(&shadow, (real_t)v);
        off += (said - y) * (said - y);
        size += y * y;
    }
    TEST_ASSERT_TRUE(sqrt(off / size) < 1e-3);
}

static void a_loop_that_the_model_makes_unstable_is_lost_and_says_nothing(void)
{
    struct loop_shadow shadow;
    const struct fopdt m = {
        .gain = REAL_C(20.0), .dead_time_s = REAL_C(0.625), .time_constant_s = REAL_C(0.4)};
    shadow_begin(&shadow, &m, REAL_C(0.325), REAL_C(0.66), REAL_C(0.05));
    for (long n = 0; n < 3000; n++)
        TEST_ASSERT_TRUE(real_abs(shadow_step(&shadow, REAL_C(0.1))) < REAL_C(20.0));
    TEST_ASSERT_TRUE(shadow.lost);
    TEST_ASSERT_FLOAT_WITHIN(1e-9, 0, shadow_step(&shadow, REAL_C(0.1)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_says_what_the_loop_would_have_done_without);
    RUN_TEST(with_the_controller_of_the_firmware_it_is_exact);
    RUN_TEST(a_loop_that_the_model_makes_unstable_is_lost_and_says_nothing);
    return UNITY_END();
}
