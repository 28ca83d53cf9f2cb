/* Over-parameterised models, in the number format of the build.
 *
 * Contract: over 100,000 samples in closed loop with 22 and with 35 parameters, forgetting 0.999, the frequency response (and
 * for 22 the ratio) stays within 1e-3 of the largest response of the same recursion in double on the same numbers, and all of D stays
 * positive. Without noise, on a plant that the model can be, the response is the plant's within 2e-3. */
#include <complex.h>
#include <math.h>
#include <stdalign.h>
#include <stdio.h>
#include <string.h>

#include "identify/high_order.h"
#include "siddha_loop.h"
#include "unity.h"

#define SCALE 0.1 /* of the loop's signals, to fractions of span */
#define W     6   /* frequencies: 0.5, 1.6 ... 6 rad/s */

static alignas(8) char memory[8192];
static struct high_order *const h = (struct high_order *)(void *)memory;
static struct high_order_settings settings;
static struct siddha_loop loop;

void setUp(void)
{
    settings = (struct high_order_settings){.forgetting = RLS_CONSTANT,
                                            .forget = 0.999f,
                                            .forget_least = 0.5f,
                                            .memory = 1,
                                            .sigma0 = 1,
                                            .trace = 1e9f,
                                            .p0 = 1e4f};
}

void tearDown(void) {}

static double frequency(unsigned i)
{
    return 0.5 + 1.1 * i;
}

static void begin(const struct high_order_shape *shape)
{
    TEST_ASSERT_EQUAL(ERR_OK, high_order_check(shape, &settings, NULL, NULL));
    TEST_ASSERT_LESS_OR_EQUAL(sizeof memory, high_order_bytes(shape));
    high_order_init(h, shape, &settings);
}

/* ---- against the same in double ---- */

struct dense {
    unsigned n;
    double theta[RLS_MAX], p[RLS_MAX][RLS_MAX];
    double y[RLS_MAX], u[HIGH_ORDER_INPUTS][HIGH_ORDER_DELAY_MOST];
    uint32_t past;
};

static struct dense dense;

static void dense_begin(const struct high_order_shape *s)
{
    memset(&dense, 0, sizeof dense);
    dense.n = high_order_parameters(s);
    for (unsigned i = 0; i < dense.n; i++)
        dense.p[i][i] = settings.p0;
}

static void dense_learn(const double *phi, double y)
{
    double g[RLS_MAX] = {0}, alpha = settings.forget, e = y;
    for (unsigned i = 0; i < dense.n; i++) {
        g[i] = 0;
        for (unsigned j = 0; j < dense.n; j++)
            g[i] += dense.p[i][j] * phi[j];
        alpha += g[i] * phi[i];
        e -= phi[i] * dense.theta[i];
    }
    for (unsigned i = 0; i < dense.n; i++) {
        dense.theta[i] += g[i] / alpha * e;
        for (unsigned j = 0; j < dense.n; j++)
            dense.p[i][j] = (dense.p[i][j] - g[i] * g[j] / alpha) / settings.forget;
    }
    for (unsigned i = 0; i < dense.n;
         i++) /* kept symmetric, which the dense form is not by itself */
        for (unsigned j = 0; j < i; j++)
            dense.p[i][j] = dense.p[j][i] = 0.5 * (dense.p[i][j] + dense.p[j][i]);
}

static void dense_step(const struct high_order_shape *s, double y, const double *u)
{
    double phi[RLS_MAX] = {0};
    unsigned at = 0, most = s->na;
    for (unsigned j = 0; j < s->inputs && j < HIGH_ORDER_INPUTS; j++) {
        memmove(dense.u[j] + 1, dense.u[j], (HIGH_ORDER_DELAY_MOST - 1) * sizeof(double));
        dense.u[j][0] = u[j];
        most = s->delay[j] + s->nb[j] > (int)most ? (unsigned)(s->delay[j] + s->nb[j]) : most;
    }
    for (unsigned i = 0; i < s->na; i++)
        phi[at++] = -dense.y[i];
    for (unsigned j = 0; j < s->inputs; j++)
        for (unsigned i = 0; i < s->nb[j]; i++)
            phi[at++] = dense.u[j][s->delay[j] + i];
    if (dense.past++ >= most)
        dense_learn(phi, y);
    memmove(dense.y + 1, dense.y, (RLS_MAX - 1) * sizeof(double));
    dense.y[0] = y;
}

static double complex dense_sum(unsigned from, unsigned n, unsigned delay, double w)
{
    double complex sum = 0;
    for (unsigned k = 0; k < n; k++)
        sum += dense.theta[from + k] * cexp(-I * w * SIDDHA_TS * (delay + k));
    return sum;
}

static double complex dense_response(const struct high_order_shape *s, unsigned j, double w)
{
    unsigned from = s->na + (j ? s->nb[0] : 0u);
    return dense_sum(from, s->nb[j], s->delay[j], w) / (1 + dense_sum(0, s->na, 1, w));
}

static void compare_on_long_record(const struct high_order_shape *s, bool joint)
{
    double worst = 0, worst_ratio = 0, largest = 0, largest_ratio = 0;
    float least = 1, most = 0;
    begin(s);
    dense_begin(s);
    siddha_begin(&loop, 0, 0.05, 7);
    for (long k = 0; k < 100000; k++) {
        double t = (double)k * SIDDHA_TS, d = siddha_square(t, 15);
        loop.regime = (int)(k / 4000 % SIDDHA_CASES);
        siddha_step(&loop, joint ? siddha_square(t, 20) : 0, d);
        num_t y = num_from_float((float)(SCALE * loop.y));
        num_t u[2] = {num_from_float((float)(SCALE * (joint ? loop.u_now : d))),
                      num_from_float((float)(SCALE * d))};
        const double exact[2] = {num_to_float(u[0]), num_to_float(u[1])};
        (void)high_order_step(h, y, u, true);
        dense_step(s, num_to_float(y), exact);
        if (k % 1000 != 999 || k < 3000)
            continue;
        float lo, hi;
        rls_d_extremes(high_order_rls(h), &lo, &hi);
        least = lo < least ? lo : least;
        most = hi > most ? hi : most;
        for (unsigned i = 0; i < W; i++) {
            struct high_order_point p;
            double w = frequency(i);
            double complex is = dense_response(s, joint, w);
            TEST_ASSERT_EQUAL(ERR_OK, high_order_response(h, joint, (real_t)(w * SIDDHA_TS), &p));
            worst = fmax(worst, cabs(p.value.re + I * p.value.im - is));
            largest = fmax(largest, cabs(is));
            if (!joint)
                continue;
            is = is / dense_response(s, 0, w);
            TEST_ASSERT_EQUAL(ERR_OK, high_order_ratio(h, (real_t)(w * SIDDHA_TS), &p));
            worst_ratio = fmax(worst_ratio, cabs(p.value.re + I * p.value.im - is));
            largest_ratio = fmax(largest_ratio, cabs(is));
        }
    }
    printf("%u parameters, 100000 samples: response off by %.2g of %.2g, ratio by %.2g of %.2g; D "
           "%.3g "
           "to %.3g, clamped %u times\n",
           high_order_parameters(s), worst, largest, worst_ratio, largest_ratio, (double)least,
           (double)most, (unsigned)rls_clamped(high_order_rls(h)));
    TEST_ASSERT_TRUE(worst <= 1e-3 * largest);
    TEST_ASSERT_TRUE(worst_ratio <= 1e-3 * fmax(largest_ratio, 1));
    TEST_ASSERT_TRUE(least > 0);
    TEST_ASSERT_EQUAL_UINT32(0, rls_clamped(high_order_rls(h)));
}

static void joint_model_is_that_of_double_on_a_long_record(void)
{
    compare_on_long_record(&high_order_siddha_joint, true);
}

static void sensitivity_model_is_that_of_double_on_a_long_record(void)
{
    compare_on_long_record(&high_order_siddha_sensitivity, false);
}

/* ---- what it finds ---- */

static void run_loop(const struct high_order_shape *shape, int regime, double noise, long samples,
                     bool learn)
{
    begin(shape);
    siddha_begin(&loop, regime, noise, 3);
    for (long k = 0; k < samples; k++) {
        double t = (double)k * SIDDHA_TS, d = siddha_square(t, 15);
        siddha_step(&loop, siddha_square(t, 20), d);
        num_t u[2] = {num_from_float((float)(SCALE * loop.u_now)),
                      num_from_float((float)(SCALE * d))};
        (void)high_order_step(h, num_from_float((float)(SCALE * loop.y)), u, learn);
    }
}

/* Both first-order paths over a common denominator: two coefficients of A. */
static void without_noise_the_ratio_is_the_plants(void)
{
    const struct high_order_shape shape = {2, 2, {3, 14}, {12, 8}};
    settings.p0 = 1e6f;
    settings.forget = 1;
    for (int c = 0; c < SIDDHA_CASES; c++) {
        run_loop(&shape, c, 0, 6000, true);
        for (unsigned i = 0; i < W; i++) {
            struct high_order_point p;
            double w = frequency(i);
            TEST_ASSERT_EQUAL(ERR_OK, high_order_ratio(h, (real_t)(w * SIDDHA_TS), &p));
            TEST_ASSERT_TRUE(cabs(p.value.re + I * p.value.im - siddha_ratio(c, w)) < 2e-3);
            TEST_ASSERT_EQUAL(ERR_OK, high_order_response(h, 0, (real_t)(w * SIDDHA_TS), &p));
            TEST_ASSERT_TRUE(cabs(p.value.re + I * p.value.im - siddha_process(w)) < 4e-3);
        }
    }
}

/* A plant of the model's own kind with white e: what P says is what is seen. */
static void standard_deviations_are_right_where_the_noise_is_white(void)
{
    const struct high_order_shape shape = {2, 2, {2, 3}, {1, 1}};
    enum { RUNS = 300, SAMPLES = 800 };
    double squares[2] = {0}, said[2] = {0};
    settings.forget = 0.998f;
    for (unsigned run = 0; run < RUNS; run++) {
        double y[3] = {0}, u[3] = {0}, d[4] = {0};
        begin(&shape);
        siddha_begin(&loop, 0, 1, 100 + run);
        for (unsigned k = 0; k < SAMPLES; k++) {
            memmove(u + 1, u, 2 * sizeof u[0]);
            memmove(d + 1, d, 3 * sizeof d[0]);
            u[0] = 0.3 * siddha_normal(&loop);
            d[0] = 0.3 * siddha_normal(&loop);
            double now = 1.2 * y[0] - 0.4 * y[1] + 0.3 * u[1] + 0.2 * u[2] - 0.2 * d[1] -
                         0.1 * d[2] + 0.05 * d[3] + 0.02 * siddha_normal(&loop);
            num_t in[2] = {num_from_float((float)u[0]), num_from_float((float)d[0])};
            (void)high_order_step(h, num_from_float((float)now), in, true);
            y[1] = y[0];
            y[0] = now;
        }
        struct high_order_point p[2];
        double complex back = cexp(-0.3 * I), a = 1 - 1.2 * back + 0.4 * back * back;
        double complex of_u = 0.3 * back + 0.2 * back * back;
        double complex of_d = -0.2 * back - 0.1 * back * back + 0.05 * back * back * back;
        TEST_ASSERT_EQUAL(ERR_OK, high_order_response(h, 0, REAL_C(0.3), &p[0]));
        TEST_ASSERT_EQUAL(ERR_OK, high_order_ratio(h, REAL_C(0.3), &p[1]));
        const double complex is[2] = {of_u / a, of_d / of_u};
        for (unsigned i = 0; i < 2; i++) {
            double off = cabs(p[i].value.re + I * p[i].value.im - is[i]);
            squares[i] += off * off / RUNS;
            said[i] += p[i].sd * p[i].sd / RUNS;
        }
    }
    printf("white noise, %d runs: error r.m.s. over what was said: response %.3f, ratio %.3f\n",
           RUNS, sqrt(squares[0] / said[0]), sqrt(squares[1] / said[1]));
    for (unsigned i = 0; i < 2;
         i++) /* three standard deviations of 300 squares of two parts: 12 % */
        TEST_ASSERT_TRUE(fabs(sqrt(squares[i] / said[i]) - 1) < 0.12);
}

static void nothing_is_learnt_unless_asked(void)
{
    run_loop(&high_order_siddha_joint, 0, 0.05, 500, false);
    TEST_ASSERT_EQUAL_UINT32(0, high_order_samples(h));
    for (unsigned i = 0; i < 22; i++)
        TEST_ASSERT_TRUE(num_eq(rls_theta(high_order_rls(h), i), num_zero()));
}

/* The past is 22 samples of d. */
static void nothing_is_learnt_before_the_past_is_whole(void)
{
    run_loop(&high_order_siddha_joint, 0, 0.05, 22, true);
    TEST_ASSERT_EQUAL_UINT32(0, high_order_samples(h));
    run_loop(&high_order_siddha_joint, 0, 0.05, 23, true);
    TEST_ASSERT_EQUAL_UINT32(1, high_order_samples(h));
}

static double off_after_change(bool reset)
{
    struct high_order_point p;
    settings.forget = 0.9995f;
    run_loop(&high_order_siddha_joint, 0, 0.02, 6000, true);
    loop.regime = 8;
    if (reset)
        high_order_reset(h);
    for (long k = 0; k < 1200; k++) {
        double t = (double)k * SIDDHA_TS, d = siddha_square(t, 15);
        siddha_step(&loop, siddha_square(t, 20), d);
        num_t u[2] = {num_from_float((float)(SCALE * loop.u_now)),
                      num_from_float((float)(SCALE * d))};
        (void)high_order_step(h, num_from_float((float)(SCALE * loop.y)), u, true);
    }
    TEST_ASSERT_EQUAL(ERR_OK, high_order_ratio(h, REAL_C(0.1), &p));
    return cabs(p.value.re + I * p.value.im - siddha_ratio(8, 2));
}

static void a_reset_of_the_covariance_follows_a_change_sooner(void)
{
    double with = off_after_change(true), without = off_after_change(false);
    printf(
        "60 s after a change of regime, ratio at 2 rad/s off by %.3f with a reset, %.3f without\n",
        with, without);
    TEST_ASSERT_TRUE(with < 0.5 * without);
}

/* ---- what is refused ---- */

static void refuses(const struct high_order_shape *shape, const char *field)
{
    const char *which = "", *wanted = "";
    TEST_ASSERT_EQUAL(ERR_RANGE, high_order_check(shape, &settings, &which, &wanted));
    TEST_ASSERT_EQUAL_STRING(field, which);
    TEST_ASSERT_TRUE(wanted[0] != 0);
}

static void what_cannot_be_is_refused_by_name(void)
{
    refuses(&(struct high_order_shape){5, 0, {3, 3}, {1, 1}}, "inputs");
    refuses(&(struct high_order_shape){5, 3, {3, 3}, {1, 1}}, "inputs");
    refuses(&(struct high_order_shape){5, 2, {3, 0}, {1, 1}}, "nb");
    refuses(&(struct high_order_shape){5, 1, {3, 0}, {98, 0}}, "delay");
    refuses(&(struct high_order_shape){30, 2, {3, 3}, {1, 1}}, "na");
    TEST_ASSERT_EQUAL(ERR_OK,
                      high_order_check(&high_order_siddha_sensitivity, &settings, NULL, NULL));
    settings.p0 = NAN;
    refuses(&high_order_siddha_joint, "p0");
    settings.p0 = 100;
    settings.forget = 0.4f;
    refuses(&high_order_siddha_joint, "forget");
}

static void a_response_that_is_not_there_is_refused(void)
{
    struct high_order_point p;
    begin(&high_order_siddha_joint);
    TEST_ASSERT_EQUAL(ERR_SINGULAR,
                      high_order_ratio(h, REAL_C(0.1), &p)); /* nothing is known of B */
    TEST_ASSERT_EQUAL(ERR_RANGE, high_order_response(h, 2, REAL_C(0.1), &p));
    TEST_ASSERT_EQUAL(ERR_RANGE, high_order_response(h, 0, REAL_C(3.2), &p));
    TEST_ASSERT_EQUAL(ERR_RANGE, high_order_response(h, 0, REAL_C(0.0), &p));
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, high_order_response(h, 0, (real_t)NAN, &p));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(joint_model_is_that_of_double_on_a_long_record);
    RUN_TEST(sensitivity_model_is_that_of_double_on_a_long_record);
    RUN_TEST(without_noise_the_ratio_is_the_plants);
    RUN_TEST(standard_deviations_are_right_where_the_noise_is_white);
    RUN_TEST(nothing_is_learnt_unless_asked);
    RUN_TEST(nothing_is_learnt_before_the_past_is_whole);
    RUN_TEST(a_reset_of_the_covariance_follows_a_change_sooner);
    RUN_TEST(what_cannot_be_is_refused_by_name);
    RUN_TEST(a_response_that_is_not_there_is_refused);
    return UNITY_END();
}
