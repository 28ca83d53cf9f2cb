/* Gd/Gp from exact responses of the closed loop, the nine cases of Siddha (2003), by each of his constructions.
 *
 * Contract: within 2e-5 of the largest part that goes into it, float; the process from T within 1e-3 at 0.5 rad/s and above, where the
 * difference Cr - T C keeps a hundredth of Cr. */
#include <complex.h>
#include <math.h>
#include <stdio.h>

#include "identify/disturbance_ratio.h"
#include "siddha_loop.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static struct high_order_point point(double complex z, double sd)
{
    return (struct high_order_point){cplx((real_t)creal(z), (real_t)cimag(z)), (real_t)sd};
}

static double distance(const struct high_order_point *p, double complex z)
{
    return cabs((double)p->value.re + I * (double)p->value.im - z);
}

/* Ratios that can be identified with the loop closed. */
struct seen {
    double complex gp, gd, c, cr, f, s;
    struct loop_response loop;
};

static struct seen at(int regime, double w, double b, double k)
{
    struct seen s = {.gp = siddha_process(w), .gd = siddha_disturbance(regime, w)};
    double complex q = SIDDHA_TS / SIDDHA_TI / (1 - cexp(-I * w * SIDDHA_TS));
    s.c = SIDDHA_GAIN * (1 + q);
    s.cr = SIDDHA_GAIN * (b + q);
    s.s = 1 / (1 + s.gp * s.c);
    s.f = siddha_feedforward(k, 0.3, 0.2, w);
    loop_response_of_pi(&s.loop, REAL_C(0.325), REAL_C(0.66), (real_t)b, false, REAL_C(0.05),
                        (real_t)(w * SIDDHA_TS));
    s.loop.feedforward = cplx((real_t)creal(s.f), (real_t)cimag(s.f));
    return s;
}

static void check_all(double b, double k)
{
    for (int c = 0; c < SIDDHA_CASES; c++)
        for (int n = 1; n <= 12; n++) {
            double w = 0.5 * n;
            struct seen s = at(c, w, b, k);
            double complex ratio = s.gd / s.gp, left = (s.gd + s.gp * s.f) * s.s;
            struct high_order_point process = point(s.gp, 0),
                                    tracking = point(s.gp * s.cr * s.s, 0), sd = point(left, 0),
                                    input = point(-s.c * left, 0), out;
            TEST_ASSERT_EQUAL(ERR_OK, ratio_from_process(&process, &sd, &s.loop, &out));
            TEST_ASSERT_TRUE(distance(&out, ratio) < 2e-5);
            TEST_ASSERT_EQUAL(ERR_OK, ratio_from_tracking(&tracking, &sd, &s.loop, &out));
            TEST_ASSERT_TRUE(distance(&out, ratio) < 2e-5);
            TEST_ASSERT_EQUAL(ERR_OK, ratio_from_input(&tracking, &input, &s.loop, &out));
            TEST_ASSERT_TRUE(distance(&out, ratio) < 2e-5);
            TEST_ASSERT_EQUAL(ERR_OK, process_from_tracking(&tracking, &s.loop, &out));
            TEST_ASSERT_TRUE(distance(&out, s.gp) < 1e-3);
            struct high_order_point of_ratio = point(ratio, 0);
            TEST_ASSERT_EQUAL(ERR_OK, sensitivity_from_ratio(&process, &of_ratio, &s.loop, &out));
            TEST_ASSERT_TRUE(distance(&out, s.gd * s.s) < 2e-5);
        }
}

static void every_construction_gives_the_ratio(void)
{
    check_all(1, 0);
}

static void with_a_setpoint_weight_as_well(void)
{
    check_all(0.4, 0);
}

/* Nothing has to be switched off for it. */
static void with_a_feedforward_that_runs_as_well(void)
{
    check_all(1, -0.7);
    check_all(1, 0.9);
}

/* As the source prints it, the ratio is turned by half a turn. */
static void without_the_lost_minus_sign_it_would_be_turned(void)
{
    struct seen s = at(4, 2, 1, 0);
    double complex printed = (s.c * s.gd * s.s) / (s.gp * s.c * s.s);
    double complex as_measured = (-s.c * s.gd * s.s) / (s.gp * s.c * s.s);
    TEST_ASSERT_TRUE(cabs(printed - s.gd / s.gp) < 1e-12);
    TEST_ASSERT_TRUE(cabs(as_measured + s.gd / s.gp) < 1e-12);
}

/* |Sd| without feedforward, digest section 8.1, dB at 0.5, 2 and 6 rad/s, for the cases c, b, a; +-0.06 dB: PI there continuous. */
static void the_sensitivity_is_that_of_the_digest(void)
{
    static const double db[3][3] = {
        {-0.49, 9.39, 0.02}, {-0.60, 8.21, -3.16}, {-0.69, 7.35, -4.86}};
    static const double w[3] = {0.5, 2, 6};
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < 3; i++) {
            double tq = siddha_case[(size_t)c * 3].lag;
            double complex jw = I * w[i], gp = 2 * cexp(-0.6 * jw) / (0.4 * jw + 1),
                           gd = 2 * cexp(-0.4 * jw) / (tq * jw + 1);
            double complex pi = 0.325 + 0.4924 / jw;
            struct loop_response loop = {.controller = {(real_t)creal(pi), (real_t)cimag(pi)}};
            struct high_order_point process = point(gp, 0), ratio = point(gd / gp, 0), sd;
            TEST_ASSERT_EQUAL(ERR_OK, sensitivity_from_ratio(&process, &ratio, &loop, &sd));
            TEST_ASSERT_TRUE(fabs(20 * log10((double)cplx_abs(sd.value)) - db[c][i]) < 0.06);
        }
}

/* By what a response that is turned and stretched by its sd moves the result. */
static void standard_deviations_follow_from_those_of_the_parts(void)
{
    struct seen s = at(0, 2, 1, 0);
    struct high_order_point process = point(s.gp, 0), sd = point(s.gd * s.s, 0),
                            tracking = point(s.gp * s.cr * s.s, 0), out, moved;
    const double small = 1e-3;
    tracking.sd = (real_t)small;
    TEST_ASSERT_EQUAL(ERR_OK, ratio_from_tracking(&tracking, &sd, &s.loop, &out));
    struct high_order_point other = point(s.gp * s.cr * s.s + small * cexp(0.7 * I), 0);
    TEST_ASSERT_EQUAL(ERR_OK, ratio_from_tracking(&other, &sd, &s.loop, &moved));
    TEST_ASSERT_FLOAT_WITHIN(0.05 * out.sd, out.sd,
                             distance(&moved, (double)out.value.re + I * (double)out.value.im));
    process.sd = (real_t)small;
    TEST_ASSERT_EQUAL(ERR_OK, ratio_from_process(&process, &sd, &s.loop, &out));
    other = point(s.gp + small * cexp(0.7 * I), 0);
    TEST_ASSERT_EQUAL(ERR_OK, ratio_from_process(&other, &sd, &s.loop, &moved));
    TEST_ASSERT_FLOAT_WITHIN(0.05 * out.sd, out.sd,
                             distance(&moved, (double)out.value.re + I * (double)out.value.im));
    process.sd = 0;
    sd.sd = (real_t)small;
    TEST_ASSERT_EQUAL(ERR_OK, ratio_from_process(&process, &sd, &s.loop, &out));
    other = point(s.gd * s.s + small * cexp(0.7 * I), 0);
    TEST_ASSERT_EQUAL(ERR_OK, ratio_from_process(&process, &other, &s.loop, &moved));
    TEST_ASSERT_FLOAT_WITHIN(0.05 * out.sd, out.sd,
                             distance(&moved, (double)out.value.re + I * (double)out.value.im));
}

/* Moved in many directions: the root of the mean square, as sd is defined. */
static double moved_by(enum err (*of)(const struct high_order_point *,
                                      const struct high_order_point *, const struct loop_response *,
                                      struct high_order_point *),
                       double complex a, double sd_a, double complex b, double sd_b,
                       const struct loop_response *loop, double *said)
{
    struct high_order_point first = point(a, sd_a), second = point(b, sd_b), out, moved;
    double sum = 0;
    TEST_ASSERT_EQUAL(ERR_OK, of(&first, &second, loop, &out));
    *said = (double)out.sd;
    for (int k = 0; k < 16; k++)
        for (int l = 0; l < 16; l++) {
            first = point(a + sd_a * cexp(I * 0.3927 * k), 0);
            second = point(b + sd_b * cexp(I * 0.3927 * l), 0);
            TEST_ASSERT_EQUAL(ERR_OK, of(&first, &second, loop, &moved));
            double d = distance(&moved, (double)out.value.re + I * (double)out.value.im);
            sum += d * d;
        }
    return sqrt(sum / 256);
}

static void standard_deviations_are_what_moving_both_parts_moves(void)
{
    struct seen s = at(0, 2, 1, 0);
    double said, small = 2e-3;
    double complex ratio = s.gd / s.gp, tracking = s.gp * s.cr * s.s;
    double is = moved_by(sensitivity_from_ratio, s.gp, small, ratio, 2 * small, &s.loop, &said);
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * is, is, said);
    is = moved_by(sensitivity_from_ratio, s.gp, small, ratio, 0, &s.loop, &said);
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * is, is, said);
    is = moved_by(ratio_from_input, tracking, small, -ratio * tracking, 2 * small, &s.loop, &said);
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * is, is, said);
}

static void what_would_divide_by_nothing_is_refused(void)
{
    struct seen s = at(0, 2, 1, 0);
    struct high_order_point none = point(0, 0), sd = point(1, 0), out;
    struct loop_response open = {0};
    TEST_ASSERT_EQUAL(ERR_SINGULAR, ratio_from_process(&none, &sd, &s.loop, &out));
    TEST_ASSERT_EQUAL(ERR_SINGULAR, ratio_from_tracking(&none, &sd, &s.loop, &out));
    TEST_ASSERT_EQUAL(ERR_SINGULAR, ratio_from_input(&none, &sd, &s.loop, &out));
    TEST_ASSERT_EQUAL(ERR_SINGULAR, ratio_from_input(&sd, &sd, &open, &out));
    TEST_ASSERT_EQUAL(ERR_SINGULAR, process_from_tracking(&sd, &open, &out));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_construction_gives_the_ratio);
    RUN_TEST(with_a_setpoint_weight_as_well);
    RUN_TEST(with_a_feedforward_that_runs_as_well);
    RUN_TEST(without_the_lost_minus_sign_it_would_be_turned);
    RUN_TEST(the_sensitivity_is_that_of_the_digest);
    RUN_TEST(standard_deviations_follow_from_those_of_the_parts);
    RUN_TEST(standard_deviations_are_what_moving_both_parts_moves);
    RUN_TEST(what_would_divide_by_nothing_is_refused);
    return UNITY_END();
}
