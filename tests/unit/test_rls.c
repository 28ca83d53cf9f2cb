/* Recursive least squares, in the number format of the build, beside a dense one in double that is written out here from the
 * equations of docs/methods/self-tuning.md (Folami 1989, 8.40 to 8.53, A5.1).
 *
 * Contract: parameters within 2e-4 of the dense ones after 300 samples, v and the trace within 1 %: each sample may round P by
 * n steps of 2^-24, and the data here are conditioned to 1e3. */
#include <math.h>
#include <stdalign.h>
#include <stdio.h>
#include <string.h>

#include "identify/rls.h"
#include "random_source.h"
#include "unity.h"

#define N    4
#define SEED 20261124u

static alignas(8) char memory[4096];
static struct rls *const rls = (struct rls *)(void *)memory;
static struct random_source source;
static float p0[RLS_MAX];
static struct rls_settings settings;

struct dense {
    double theta[N], p[N][N], v, size[N], size_of_error;
    unsigned sized;
};

static struct dense dense;

void setUp(void)
{
    source.state = SEED;
    settings = (struct rls_settings){.n = N,
                                     .forget = 0.98f,
                                     .forget_least = 0.2f,
                                     .sigma0 = 0.01f,
                                     .memory = 1,
                                     .trace = 40,
                                     .rate = 0.2f,
                                     .p0 = p0};
    for (unsigned i = 0; i < RLS_MAX; i++)
        p0[i] = 10;
    memset(&dense, 0, sizeof dense);
    for (unsigned i = 0; i < N; i++)
        dense.p[i][i] = 10;
}

void tearDown(void) {}

static double uniform(void)
{
    return (double)(random_next(&source) >> 11) / 9007199254740992.0 * 2 - 1;
}

static void begin(void)
{
    num_t theta[RLS_MAX];
    for (unsigned i = 0; i < RLS_MAX; i++)
        theta[i] = num_zero();
    TEST_ASSERT_EQUAL(ERR_OK, rls_check(&settings, NULL, NULL));
    TEST_ASSERT_LESS_OR_EQUAL(sizeof memory, rls_bytes(settings.n));
    rls_init(rls, &settings, theta);
}

static double dense_trace(void)
{
    double trace = 0;
    for (unsigned i = 0; i < N; i++)
        trace += dense.p[i][i];
    return trace;
}

static void solve_dense(const double *x, double *y)
{
    double a[N][N + 1];
    for (unsigned i = 0; i < N; i++) {
        memcpy(a[i], dense.p[i], sizeof dense.p[i]);
        a[i][N] = x[i];
    }
    for (unsigned k = 0; k < N; k++)
        for (unsigned i = k + 1; i < N; i++)
            for (unsigned j = N + 1; j-- > k;)
                a[i][j] -= a[k][j] * a[i][k] / a[k][k];
    for (unsigned i = N; i-- > 0;) {
        y[i] = a[i][N];
        for (unsigned j = i + 1; j < N; j++)
            y[i] -= a[i][j] * y[j];
        y[i] /= a[i][i];
    }
}

/* phi'P phi, and P phi. */
static double form(const double *phi, double *p_phi)
{
    double sum = 0;
    for (unsigned i = 0; i < N; i++) {
        p_phi[i] = 0;
        for (unsigned j = 0; j < N; j++)
            p_phi[i] += dense.p[i][j] * phi[j];
        sum += p_phi[i] * phi[i];
    }
    return sum;
}

static void dense_grow(const double *phi)
{
    double w[N], sum = 0, square = 0, c;
    solve_dense(phi, w);
    for (unsigned i = 0; i < N; i++) {
        sum += w[i] * phi[i];
        square += phi[i] * phi[i];
    }
    c = (1 - (double)settings.forget) / (double)settings.forget / sum;
    c = fmax(0, fmin(c, ((double)settings.trace - dense_trace()) / square));
    for (unsigned i = 0; i < N; i++)
        for (unsigned j = 0; j < N; j++)
            dense.p[i][j] += c * phi[i] * phi[j];
}

/* Part of the squared error, in units of its own, that v loses where the trace is 1. */
static double dense_sizes(const double *phi, double error)
{
    double share = (1 - (double)settings.forget) / (double)settings.forget;
    dense.sized += dense.sized < 200;
    dense.size_of_error += (error * error - dense.size_of_error) / dense.sized;
    for (unsigned i = 0; i < N; i++)
        dense.size[i] += (phi[i] * phi[i] - dense.size[i]) / dense.sized;
    return N * share * share / dense.size_of_error;
}

static double dense_sized_trace(void)
{
    double trace = 0;
    for (unsigned i = 0; i < N; i++)
        trace += dense.p[i][i] * dense.size[i];
    return trace;
}

static double dense_factor(const double *phi, double error, double zeta)
{
    double surprise = error * error / (1 + zeta), v = (double)settings.forget;
    switch (settings.forgetting) {
    case RLS_FORTESCUE:
        v = 1 - surprise / (double)settings.sigma0;
        break;
    case RLS_YDSTIE:
        v = (double)settings.memory / ((double)settings.memory + surprise);
        break;
    case RLS_YDSTIE_TRACE:
        surprise *= dense_sizes(phi, error);
        v = dense_sized_trace() / (dense_sized_trace() + surprise);
        break;
    case RLS_BOUNDED:
        v = fmax(v, fmin(1, dense_trace() / (double)settings.trace));
        break;
    default:
        return v;
    }
    return fmax(v, (double)settings.forget_least);
}

static void dense_step(const double *phi, double y)
{
    double p_phi[N], error = y, zeta, v, noise;
    for (unsigned i = 0; i < N; i++)
        error -= phi[i] * dense.theta[i];
    zeta = form(phi, p_phi);
    v = noise = dense_factor(phi, error, zeta);
    if (settings.forgetting == RLS_DIRECTIONAL) {
        dense_grow(phi);
        zeta = form(phi, p_phi);
    }
    if (settings.forgetting == RLS_DIRECTIONAL || settings.forgetting == RLS_HELD_TRACE)
        noise = 1;
    for (unsigned i = 0; i < N; i++) {
        dense.theta[i] += p_phi[i] * error / (noise + zeta);
        for (unsigned j = 0; j < N; j++)
            dense.p[i][j] = (dense.p[i][j] - p_phi[i] * p_phi[j] / (noise + zeta)) / noise;
    }
    if (settings.forgetting == RLS_HELD_TRACE)
        v = dense_trace() / (double)settings.trace;
    for (unsigned i = 0; i < N && settings.forgetting == RLS_HELD_TRACE; i++)
        for (unsigned j = 0; j < N; j++)
            dense.p[i][j] /= v;
    if (settings.forgetting == RLS_RESET && dense_trace() < (double)settings.trace / 100)
        for (unsigned i = 0; i < N; i++)
            for (unsigned j = 0; j < N; j++)
                dense.p[i][j] = i == j ? (double)settings.trace / N : 0;
    dense.v = v;
}

static const double truth[N] = {0.8, -0.3, 0.5, 0.05};

/* A sample for both; the last regressor is 1. Gains change in the middle. */
static void sample(unsigned t, double noise)
{
    double phi[N], y = noise * uniform();
    num_t x[N], target;
    for (unsigned i = 0; i < N; i++) {
        float value = (float)(i == N - 1 ? 1 : uniform());
        x[i] = num_from_float(value);
        phi[i] = (double)num_to_float(x[i]);
        y += phi[i] * truth[i] * (t > 150 && i == 1 ? 2 : 1);
    }
    target = num_from_float((float)y);
    dense_step(phi, (double)num_to_float(target));
    (void)rls_step(rls, x, target, true);
}

static void every_rule_of_forgetting_is_the_dense_one(void)
{
    for (unsigned rule = RLS_CONSTANT; rule <= RLS_BOUNDED; rule++) {
        setUp();
        settings.forgetting = (uint8_t)rule;
        begin();
        for (unsigned t = 0; t < 300; t++) {
            sample(t, 0.01);
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.01 * dense.v, dense.v, (double)rls_forgot(rls),
                                              "v");
        }
        for (unsigned i = 0; i < N; i++)
            TEST_ASSERT_DOUBLE_WITHIN(2e-4, dense.theta[i],
                                      (double)num_to_float(rls_theta(rls, i)));
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * dense_trace(), dense_trace(), (double)rls_trace(rls));
        printf("rule %u: trace %.4g, dense %.4g\n", rule, (double)rls_trace(rls), dense_trace());
    }
}

/* Digest, claim 5. */
static void the_factor_of_ydsties_rule_with_the_trace_is_a_factor_and_comes_to_1(void)
{
    settings.forgetting = RLS_YDSTIE_TRACE;
    settings.forget_least = 0.01f;
    for (double start = 1e-3; start < 1e8; start *= 10) {
        num_t phi[N], target = num_from_float(1);
        for (unsigned i = 0; i < N; i++) {
            p0[i] = (float)start;
            phi[i] = num_from_float(0.1f);
        }
        begin();
        (void)rls_step(rls, phi, target, true);
        double v = (double)rls_forgot(rls), trace = N * start * 0.01, share = 0.02 / 0.98;
        TEST_ASSERT_TRUE(v > 0 && v <= 1);
        /* The first error is as large as errors are. */
        double wanted = trace / (trace + N * share * share / (1 + 0.04 * start));
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, fmax(0.01, wanted), v);
    }
}

/* The same data with y in other units, and each regressor in units of its own; P(0) is in theirs. */
static void ydsties_rule_with_the_trace_forgets_alike_in_all_units(void)
{
    static const double unit[3][N] = {{1, 1, 1, 1}, {0.1, 1, 4, 0.5}, {1, 0.25, 0.25, 1}};
    static const double of_y[3] = {1, 0.05, 2};
    double v[3][200];
    settings.forgetting = RLS_YDSTIE_TRACE;
    for (unsigned k = 0; k < 3; k++) {
        source.state = SEED;
        for (unsigned i = 0; i < N; i++)
            p0[i] = (float)(100 / unit[k][i] / unit[k][i]);
        begin();
        for (unsigned t = 0; t < 200; t++) {
            num_t phi[N];
            double y = 0.05 * uniform();
            for (unsigned i = 0; i < N; i++) {
                double x = uniform();
                phi[i] = num_from_float((float)(x * unit[k][i]));
                y += x * truth[i] * (t > 100 && i == 1 ? 2 : 1);
            }
            (void)rls_step(rls, phi, num_from_float((float)(y * of_y[k])), true);
            v[k][t] = (double)rls_forgot(rls);
            TEST_ASSERT_DOUBLE_WITHIN(0.005, v[0][t], v[k][t]);
        }
    }
}

/* Where errors are as they have been, v is `forget` in the mean; a change is forgotten faster. */
static void ydsties_rule_with_the_trace_forgets_as_much_as_forget_says(void)
{
    double sum = 0, least = 1;
    settings.forgetting = RLS_YDSTIE_TRACE;
    begin();
    for (unsigned t = 0; t < 2000; t++) {
        num_t phi[N];
        double y = 0.02 * uniform();
        for (unsigned i = 0; i < N; i++) {
            double x = uniform();
            phi[i] = num_from_float((float)x);
            y += x * truth[i] * (t >= 1900 && i == 1 ? 3 : 1);
        }
        (void)rls_step(rls, phi, num_from_float((float)y), true);
        double v = (double)rls_forgot(rls);
        if (t >= 900 && t < 1900)
            sum += v / 1000;
        else if (t >= 1900)
            least = fmin(least, v);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.005, (double)settings.forget, sum);
    TEST_ASSERT_TRUE(least < 0.9);
}

/* Digest, claim 6: theta - hi is multiplied by 1 - mu a sample. */
static void simplified_correction_below_1_never_crosses_the_bound_above_1_it_crosses_at_once(void)
{
    static const float rates[] = {0.15f, 0.5f, 0.99f, 1.5f, 1.9f};
    for (unsigned k = 0; k < sizeof rates / sizeof *rates; k++) {
        float lo[N] = {0}, hi[N] = {0};
        num_t theta[N], phi[N];
        setUp();
        settings.correction = RLS_CORRECT_SPC;
        settings.rate = rates[k];
        lo[1] = -1;
        hi[1] = 0.5f;
        settings.lo = lo;
        settings.hi = hi;
        for (unsigned i = 0; i < N; i++)
            theta[i] = phi[i] = num_zero();
        theta[1] = num_from_float(2.5f);
        TEST_ASSERT_EQUAL(ERR_OK, rls_check(&settings, NULL, NULL));
        rls_init(rls, &settings, theta);
        double excess = 2;
        for (unsigned t = 0; t < 20; t++) {
            (void)rls_step(rls, phi, num_zero(), true); /* no data */
            excess *= 1 - (double)rates[k];
            if (excess < 0) /* it is inside now */
                break;
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.5 + excess, (double)num_to_float(rls_theta(rls, 1)));
        }
        if (rates[k] > 1)
            TEST_ASSERT_TRUE(num_to_float(rls_theta(rls, 1)) < 0.5f);
        TEST_ASSERT_EQUAL_FLOAT(0, num_to_float(rls_theta(rls, 0)));
    }
}

/* Folami 8.51: theta - alpha P f, which moves what is not bounded as well once P has cross terms. */
static void full_correction_uses_the_covariance_of_before(void)
{
    float lo[N] = {0}, hi[N] = {0};
    settings.correction = RLS_CORRECT_PC;
    settings.rate = 0.15f;
    settings.forget = 1;
    lo[1] = 0.2f;
    hi[1] = 0.9f; /* the data says -0.3 */
    settings.lo = lo;
    settings.hi = hi;
    begin();
    for (unsigned t = 0; t < 50; t++) {
        double theta[N], f = 0, p_f[N];
        for (unsigned i = 0; i < N; i++)
            p_f[i] = dense.p[i][1];
        memcpy(theta, dense.theta, sizeof theta);
        f = theta[1] > 0.9 ? theta[1] - 0.9 : (theta[1] < 0.2 ? theta[1] - 0.2 : 0);
        sample(t, 0);
        for (unsigned i = 0; i < N; i++)
            dense.theta[i] -= 0.15 * p_f[i] * f;
    }
    for (unsigned i = 0; i < N; i++)
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, dense.theta[i], (double)num_to_float(rls_theta(rls, i)));
}

static void a_correction_too_strong_for_p0_is_refused_with_what_would_be_right(void)
{
    const char *field = NULL, *wanted = NULL;
    settings.correction = RLS_CORRECT_PC;
    settings.rate = 0.25f; /* times 10 is not below 2 */
    TEST_ASSERT_EQUAL(ERR_RANGE, rls_check(&settings, &field, &wanted));
    TEST_ASSERT_EQUAL_STRING("correct_rate", field);
    settings.rate = 0.15f;
    TEST_ASSERT_EQUAL(ERR_OK, rls_check(&settings, &field, &wanted));
    settings.forget = NAN;
    TEST_ASSERT_EQUAL(ERR_RANGE, rls_check(&settings, &field, &wanted));
    TEST_ASSERT_EQUAL_STRING("forget", field);
}

static void an_outlier_counts_as_the_largest_error_allowed(void)
{
    num_t phi[N];
    settings.error_most = 0.1f;
    begin();
    for (unsigned i = 0; i < N; i++)
        phi[i] = num_from_float(i == 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 50,
                              (double)num_to_float(rls_step(rls, phi, num_from_float(50), true)));
    /* P = 10, v = 0.98 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 10 / 10.98 * 0.1, (double)num_to_float(rls_theta(rls, 0)));
}

/* One direction, little of it: without the bound P would come to (1 - v)/phi^2 = 2e6 along it. */
static void directional_forgetting_lets_p_grow_to_its_trace_and_no_further(void)
{
    num_t phi[N];
    settings.forgetting = RLS_DIRECTIONAL;
    settings.trace = 500;
    begin();
    for (unsigned i = 0; i < N; i++)
        phi[i] = num_from_float(i == 0 ? 1e-4f : 0);
    float most = 0;
    for (unsigned t = 0; t < 2000; t++) {
        (void)rls_step(rls, phi, num_zero(), true);
        most = fmaxf(most, rls_trace(rls));
    }
    TEST_ASSERT_FLOAT_WITHIN(0.5f, 500, most);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 10, rls_covariance(rls, 1, 1));
}

static void what_lies_in_the_dead_zone_changes_neither_parameters_nor_covariance(void)
{
    num_t phi[N];
    settings.dead_zone = 3;
    begin();
    for (unsigned t = 0; t < 400; t++)
        sample(t, 0.1);
    float trace = rls_trace(rls), theta = num_to_float(rls_theta(rls, 0));
    for (unsigned i = 0; i < N; i++)
        phi[i] = num_from_float(0.5f);
    num_t small = num_add(rls_predict(rls, phi), num_from_float(0.01f));
    for (unsigned t = 0; t < 20; t++)
        (void)rls_step(rls, phi, small, true);
    TEST_ASSERT_EQUAL_FLOAT(trace, rls_trace(rls));
    TEST_ASSERT_EQUAL_FLOAT(theta, num_to_float(rls_theta(rls, 0)));
}

static void normalised_data_give_the_step_of_the_divided_sample(void)
{
    num_t phi[N], small[N];
    settings.normalise = true;
    begin();
    for (unsigned i = 0; i < N; i++)
        phi[i] = num_from_float((float)(4 - (int)i));
    (void)rls_step(rls, phi, num_from_float(2), true);
    float with = num_to_float(rls_theta(rls, 1));
    settings.normalise = false;
    begin();
    for (unsigned i = 0; i < N; i++)
        small[i] = num_from_float((float)(4 - (int)i) / 4);
    (void)rls_step(rls, small, num_from_float(0.5f), true);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, num_to_float(rls_theta(rls, 1)), with);
}

static void without_leave_to_learn_nothing_changes(void)
{
    num_t phi[N];
    begin();
    sample(0, 0);
    float trace = rls_trace(rls), theta = num_to_float(rls_theta(rls, 0));
    for (unsigned i = 0; i < N; i++)
        phi[i] = num_from_float(0.5f);
    (void)rls_step(rls, phi, num_from_float(3), false);
    TEST_ASSERT_EQUAL_FLOAT(trace, rls_trace(rls));
    TEST_ASSERT_EQUAL_FLOAT(theta, num_to_float(rls_theta(rls, 0)));
}

/* Digest, claim 9, on data like the source's: one loop at rest most of the time, f, g and a bias, forgetting. The covariance form is
 * written as it is printed, (I - K phi')P/v, in single precision; after how many samples is its P no longer positive? */
static void the_covariance_form_loses_its_sign_in_single_precision_udu_does_not(void)
{
    float p[3][3] = {{10, 0, 0}, {0, 10, 0}, {0, 0, 10}}, least, most;
    unsigned failed = 0;
    settings.n = 3;
    settings.forget = 0.9f;
    begin();
    for (unsigned t = 1; t <= 20000; t++) {
        float phi[3] = {(float)(0.5 + 1e-4 * uniform()), (float)(0.3 + 1e-4 * uniform()), 1};
        float p_phi[3], alpha = 0.9f, k[3];
        num_t x[3];
        for (unsigned i = 0; i < 3; i++) {
            x[i] = num_from_float(phi[i]);
            p_phi[i] = p[i][0] * phi[0] + p[i][1] * phi[1] + p[i][2] * phi[2];
        }
        for (unsigned i = 0; i < 3; i++)
            alpha += phi[i] * p_phi[i];
        for (unsigned i = 0; i < 3; i++)
            k[i] = p_phi[i] / alpha;
        for (unsigned i = 0; i < 3; i++)
            for (unsigned j = 0; j < 3; j++)
                p[i][j] = (p[i][j] - k[i] * p_phi[j]) / 0.9f;
        if (!failed && !(p[0][0] > 0 && p[1][1] > 0 && p[2][2] > 0 && alpha > 0))
            failed = t;
        (void)rls_step(rls, x, num_from_float(0.5f), true);
        rls_d_extremes(rls, &least, &most);
        TEST_ASSERT_TRUE(least > 0 && isfinite(most));
    }
    printf("covariance form in single precision: no longer positive after %u samples\n", failed);
    TEST_ASSERT_TRUE(failed > 0);
}

int main(void)
{
    UNITY_BEGIN();
    printf("seed %u\n", SEED);
    RUN_TEST(every_rule_of_forgetting_is_the_dense_one);
    RUN_TEST(the_factor_of_ydsties_rule_with_the_trace_is_a_factor_and_comes_to_1);
    RUN_TEST(ydsties_rule_with_the_trace_forgets_alike_in_all_units);
    RUN_TEST(ydsties_rule_with_the_trace_forgets_as_much_as_forget_says);
    RUN_TEST(simplified_correction_below_1_never_crosses_the_bound_above_1_it_crosses_at_once);
    RUN_TEST(full_correction_uses_the_covariance_of_before);
    RUN_TEST(a_correction_too_strong_for_p0_is_refused_with_what_would_be_right);
    RUN_TEST(an_outlier_counts_as_the_largest_error_allowed);
    RUN_TEST(directional_forgetting_lets_p_grow_to_its_trace_and_no_further);
    RUN_TEST(what_lies_in_the_dead_zone_changes_neither_parameters_nor_covariance);
    RUN_TEST(normalised_data_give_the_step_of_the_divided_sample);
    RUN_TEST(without_leave_to_learn_nothing_changes);
    RUN_TEST(the_covariance_form_loses_its_sign_in_single_precision_udu_does_not);
    return UNITY_END();
}
