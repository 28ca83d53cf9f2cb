/* Models in discrete time.
 *
 * Contract, float and double: gains at rest within (na + nb + 2) REAL_EPSILON (sum |b|/|A(1)| + |gain| (1 + sum |a|)/|A(1)|)
 * of those in double, coefficients rounded to real_t included; a step within (na + inputs nb + 1) REAL_EPSILON times the sum of
 * the magnitudes of its terms. */
#include <math.h>
#include <string.h>

#include "kotyk_model.h"
#include "unity.h"

static struct difference_model model;
static const char *field, *wanted;

void setUp(void)
{
    model = kotyk_column();
    field = wanted = "";
}

void tearDown(void) {}

static void refused(enum err err, const char *name)
{
    TEST_ASSERT_EQUAL(err, difference_check(&model, &field, &wanted));
    TEST_ASSERT_EQUAL_STRING(name, field);
    TEST_ASSERT_NOT_EQUAL('\0', wanted[0]);
}

static void test_the_column_of_the_paper_is_accepted(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, difference_check(&model, NULL, NULL));
}

static void test_a_size_that_does_not_fit_is_refused_by_name(void)
{
    model.outputs = 5;
    refused(ERR_RANGE, "outputs");
    model = kotyk_column();
    model.inputs = 0;
    refused(ERR_RANGE, "inputs");
    model = kotyk_column();
    model.na = 5;
    refused(ERR_RANGE, "na");
    model = kotyk_column();
    model.nb = 0;
    refused(ERR_RANGE, "nb");
    model.nb = 9;
    refused(ERR_RANGE, "nb");
}

static void test_a_model_without_denominator_is_accepted(void)
{
    model.na = 0;
    TEST_ASSERT_EQUAL(ERR_OK, difference_check(&model, NULL, NULL));
}

static void test_a_period_of_nothing_is_refused(void)
{
    model.period_s = 0;
    refused(ERR_RANGE, "period_s");
    model.period_s = REAL_C(1.1e6);
    refused(ERR_RANGE, "period_s");
    model.period_s = (real_t)INFINITY;
    refused(ERR_NOT_FINITE, "period_s");
}

static void test_a_coefficient_that_is_no_number_is_refused(void)
{
    model.a[1][1] = (real_t)NAN;
    refused(ERR_NOT_FINITE, "a");
    model = kotyk_column();
    model.b[1][1][1] = (real_t)-INFINITY;
    refused(ERR_NOT_FINITE, "b");
}

static void test_what_lies_behind_the_orders_is_not_looked_at(void)
{
    model.a[1][2] = model.b[1][1][2] = model.b[2][0][0] = (real_t)NAN;
    TEST_ASSERT_EQUAL(ERR_OK, difference_check(&model, NULL, NULL));
}

/* Coefficients of the paper in double. */
static const double a[2][2] = {{-0.80338, 0.02616}, {-1.06726, 0.14709}};
static const double b[2][2][2] = {{{0.03851, -0.00386}, {-0.01062, -0.00192}},
                                  {{0.01262, 0.00316}, {-0.01990, 0.00157}}};

static void test_gains_at_rest_are_within_the_contract(void)
{
    real_t gain[DIFFERENCE_MOST][DIFFERENCE_MOST];
    TEST_ASSERT_EQUAL(ERR_OK, difference_gain(&model, gain));
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            double at_one = 1 + a[i][0] + a[i][1], exact = (b[i][j][0] + b[i][j][1]) / at_one;
            double sizes = fabs(b[i][j][0]) + fabs(b[i][j][1]) +
                           fabs(exact) * (1 + fabs(a[i][0]) + fabs(a[i][1]));
            TEST_ASSERT_DOUBLE_WITHIN(6 * (double)REAL_EPSILON * sizes / at_one, exact,
                                      (double)gain[i][j]);
        }
}

static void test_gains_at_rest_are_the_papers(void)
{
    static const double digest[2][2] = {{0.15553, -0.05629}, {0.19767, -0.22961}};
    real_t gain[DIFFERENCE_MOST][DIFFERENCE_MOST];
    TEST_ASSERT_EQUAL(ERR_OK, difference_gain(&model, gain));
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) /* told with five decimals */
            TEST_ASSERT_DOUBLE_WITHIN(0.5e-5 + 1e-6, digest[i][j], (double)gain[i][j]);
}

static void test_an_output_that_integrates_has_no_gain(void)
{
    real_t gain[DIFFERENCE_MOST][DIFFERENCE_MOST] = {{7}};
    model.a[1][0] = REAL_C(-1.3);
    model.a[1][1] = REAL_C(0.3);
    TEST_ASSERT_EQUAL(ERR_SINGULAR, difference_gain(&model, gain));
    TEST_ASSERT_TRUE(gain[0][0] == REAL_C(7.0));
}

static void test_a_pulse_brings_out_the_coefficients_one_a_period(void)
{
    struct difference_state state = {0};
    model.na = 0;
    for (int k = 0; k < 4; k++) {
        real_t u[2] = {k == 0 ? REAL_C(1.0) : 0, 0}, y[2];
        difference_step(&model, &state, u, y);
        real_t first = k < 2 ? model.b[0][0][k] : 0, second = k < 2 ? model.b[1][0][k] : 0;
        TEST_ASSERT_TRUE(y[0] == first && y[1] == second);
    }
}

static void test_dead_time_is_leading_zeros(void)
{
    struct difference_state state = {0};
    memset(model.b, 0, sizeof model.b);
    model.nb = DIFFERENCE_B_MOST;
    model.na = 0;
    model.b[0][1][DIFFERENCE_B_MOST - 1] = REAL_C(2.0);
    real_t u[2] = {0, REAL_C(3.0)}, y[2];
    for (int k = 1; k < DIFFERENCE_B_MOST; k++) {
        difference_step(&model, &state, u, y);
        TEST_ASSERT_TRUE(y[0] == REAL_C(0.0));
        u[1] = 0;
    }
    difference_step(&model, &state, u, y);
    TEST_ASSERT_TRUE(y[0] == REAL_C(6.0));
}

static void test_steps_are_within_the_contract(void)
{
    struct difference_state state = {0};
    double was_u[2][2] = {{0}}; /* of each input, newest first */
    for (int k = 0; k < 50; k++) {
        real_t u[2] = {(real_t)((k * 7) % 5 - 2), (real_t)((k * 3) % 7 - 3)}, y[2];
        double was_y[2][2]; /* what the model itself had, so that errors do not add up */
        for (int i = 0; i < 2; i++) {
            was_u[i][1] = was_u[i][0];
            was_u[i][0] = (double)u[i];
            was_y[i][0] = (double)state.y[i][0];
            was_y[i][1] = (double)state.y[i][1];
        }
        difference_step(&model, &state, u, y);
        for (int i = 0; i < 2; i++) {
            double exact = 0, sizes = 0;
            for (int m = 0; m < 2; m++) {
                double terms[3] = {-a[i][m] * was_y[i][m], b[i][0][m] * was_u[0][m],
                                   b[i][1][m] * was_u[1][m]};
                for (int t = 0; t < 3; t++) {
                    exact += terms[t];
                    sizes += fabs(terms[t]);
                }
            }
            TEST_ASSERT_DOUBLE_WITHIN(7 * (double)REAL_EPSILON * sizes, exact, (double)y[i]);
        }
    }
}

static void test_a_step_settles_at_the_gain(void)
{
    struct difference_state state = {0};
    real_t gain[DIFFERENCE_MOST][DIFFERENCE_MOST], u[2] = {1, 2}, y[2];
    TEST_ASSERT_EQUAL(ERR_OK, difference_gain(&model, gain));
    for (int k = 0; k < 300; k++)
        difference_step(&model, &state, u, y);
    for (int i = 0; i < 2; i++) {
        double at_one = 1 + a[i][0] + a[i][1];
        double now = (double)(gain[i][0] + 2 * gain[i][1]), terms = 0, gains = 0;
        for (int j = 0; j < 2; j++) {
            double sum = fabs(b[i][j][0]) + fabs(b[i][j][1]);
            terms += (j + 1) * sum;
            gains += (j + 1) * fabs((double)gain[i][j]) * (1 + fabs(a[i][0]) + fabs(a[i][1]));
        }
        double of_step = 7 * (terms + fabs(now) * (fabs(a[i][0]) + fabs(a[i][1])));
        /* what a step rounds comes back 1/A(1) times; and what the gains may be wrong by */
        TEST_ASSERT_DOUBLE_WITHIN((of_step + 6 * (terms + gains)) / at_one * (double)REAL_EPSILON,
                                  now, (double)y[i]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_column_of_the_paper_is_accepted);
    RUN_TEST(test_a_size_that_does_not_fit_is_refused_by_name);
    RUN_TEST(test_a_model_without_denominator_is_accepted);
    RUN_TEST(test_a_period_of_nothing_is_refused);
    RUN_TEST(test_a_coefficient_that_is_no_number_is_refused);
    RUN_TEST(test_what_lies_behind_the_orders_is_not_looked_at);
    RUN_TEST(test_gains_at_rest_are_within_the_contract);
    RUN_TEST(test_gains_at_rest_are_the_papers);
    RUN_TEST(test_an_output_that_integrates_has_no_gain);
    RUN_TEST(test_a_pulse_brings_out_the_coefficients_one_a_period);
    RUN_TEST(test_dead_time_is_leading_zeros);
    RUN_TEST(test_steps_are_within_the_contract);
    RUN_TEST(test_a_step_settles_at_the_gain);
    return UNITY_END();
}
