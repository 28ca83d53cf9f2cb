/* Models from records, on the column of Kotyk and Machacek (1995) and beside results that an independent model in double has
 * written (tests/reference/arx_reference.py).
 *
 * Contract, float and double: theta of least squares within 6 (columns) REAL_EPSILON times what rounding by 1 in rows moves
 * it by (the column `moved` of arx_cases.csv, to first order; twice that is allowed), its standard deviation to 1e-3. Those
 * of passes end when a pass changes theta by a thousandth of its standard deviation: theta within 0.02 sd, sd to 2 %. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "csv.h"
#include "kotyk_record.h"
#include "unity.h"

#define CASE_MOST 12

static struct arx_work work;
static struct arx_fit fit, other;
static const struct arx_orders two = {.na = 2, .first = {1, 1}, .last = {2, 2}};

void setUp(void)
{
    memset(&work, 0xA5, sizeof work);
}

void tearDown(void) {}

/* ---- beside the independent model ---- */

static real_t read_u[400], read_y[400];

static struct arx_data read_record(void)
{
    struct arx_data data = {.outputs = 2, .inputs = 2, .u = read_u, .y = read_y};
    FILE *f = csv_open("reference/arx_data.csv");
    double row[4];
    for (size_t n = 0; n < 400 && csv_row(f, row, 4); n += 2, data.samples++)
        for (size_t i = 0; i < 2; i++) {
            read_u[n + i] = (real_t)row[i];
            read_y[n + i] = (real_t)row[2 + i];
        }
    fclose(f);
    return data;
}

static void expect_case(const struct arx_data *data, const double *row, unsigned number)
{
    struct arx_orders o = {.na = (uint8_t)row[2],
                           .first = {(uint8_t)row[3], (uint8_t)row[5]},
                           .last = {(uint8_t)row[4], (uint8_t)row[6]},
                           .nc = (uint8_t)row[7],
                           .constant = row[8] != 0};
    const double *theta = row + 9, *sd = theta + CASE_MOST, *moved = sd + CASE_MOST;
    enum arx_method method = (enum arx_method)row[0];
    size_t n = arx_parameters(&o, 2);
    char message[64];
    TEST_ASSERT_EQUAL(ERR_OK, arx_orders_check(&o, 2, NULL, NULL));
    TEST_ASSERT_EQUAL(ERR_OK,
                      arx_fit(data, (uint8_t)row[1], &o, method, 0, data->samples, &work, &fit));
    (void)snprintf(message, sizeof message, "case %u has not settled", number);
    TEST_ASSERT_TRUE_MESSAGE(fit.settled, message);
    for (size_t i = 0; i < n; i++) {
        double bound = method == ARX_LS ? 2 * 6 * (double)(n + 1) * (double)REAL_EPSILON * moved[i]
                                        : 0.02 * sd[i];
        (void)snprintf(message, sizeof message, "case %u, parameter %zu", number, i);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(bound, theta[i], (double)fit.theta[i], message);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE((method == ARX_LS ? 1e-3 : 0.02) * sd[i], sd[i],
                                          (double)fit.sd[i], message);
    }
}

static void test_every_method_gives_what_the_independent_model_gives(void)
{
    const struct arx_data data = read_record();
    double row[9 + 3 * CASE_MOST];
    unsigned cases = 0;
    FILE *f = csv_open("reference/arx_cases.csv");
    TEST_ASSERT_EQUAL_UINT32(200, data.samples);
    while (csv_row(f, row, 9 + 3 * CASE_MOST))
        expect_case(&data, row, cases++);
    fclose(f);
    TEST_ASSERT_EQUAL(9, cases);
}

/* ---- the paper's column ---- */

/* theta of the paper for an output, in the order of phi. */
static void papers(size_t output, double *theta)
{
    const struct difference_model m = kotyk_column();
    for (size_t k = 0; k < 2; k++) {
        theta[k] = (double)m.a[output][k];
        theta[2 + k] = (double)m.b[output][0][k];
        theta[4 + k] = (double)m.b[output][1][k];
    }
}

static void test_least_squares_of_both_inputs_at_once_recovers_the_papers_model(void)
{
    const struct arx_data data = kotyk_record(1023, 0, 1);
    double wanted[6];
    for (uint8_t i = 0; i < 2; i++) {
        TEST_ASSERT_EQUAL(ERR_OK, arx_fit(&data, i, &two, ARX_LS, 0, 1023, &work, &fit));
        papers(i, wanted);
        for (int k = 0; k < 6; k++) {
            /* A sample is rounded to REAL_EPSILON of the sizes in it, below 1, as is a row by each of 7 rotations; errors of
             * samples are independent, so they move theta by its spread, and they have not all their worst: 6 times. */
            double spread = (double)(fit.sd[k] / real_sqrt(fit.variance));
            TEST_ASSERT_DOUBLE_WITHIN(6 * 7 * (double)REAL_EPSILON * spread, wanted[k],
                                      (double)fit.theta[k]);
        }
    }
}

static double worst_error(const struct arx_fit *f, size_t output)
{
    double wanted[6], worst = 0;
    papers(output, wanted);
    for (int k = 0; k < 6; k++)
        worst = fmax(worst, fabs((double)f->theta[k] - wanted[k]));
    return worst;
}

static void test_noise_of_a_measurement_biases_least_squares_and_not_instruments(void)
{
    const struct arx_data data = kotyk_record(KOTYK_SAMPLES, REAL_C(0.02), 3);
    for (uint8_t i = 0; i < 2; i++) {
        TEST_ASSERT_EQUAL(ERR_OK, arx_fit(&data, i, &two, ARX_LS, 0, KOTYK_SAMPLES, &work, &fit));
        TEST_ASSERT_EQUAL(ERR_OK, arx_fit(&data, i, &two, ARX_IV, 0, KOTYK_SAMPLES, &work, &other));
        double wanted[6];
        papers(i, wanted);
        TEST_ASSERT_TRUE(fabs((double)fit.theta[0] - wanted[0]) > 6 * (double)fit.sd[0]);
        for (int k = 0; k < 6; k++) /* sd is that of white e: of C = A the errors are no larger */
            TEST_ASSERT_DOUBLE_WITHIN(4 * (double)other.sd[k], wanted[k], (double)other.theta[k]);
    }
}

static void test_extended_least_squares_with_the_noises_own_order_has_less_bias(void)
{
    const struct arx_data data = kotyk_record(KOTYK_SAMPLES, REAL_C(0.02), 3);
    struct arx_orders o = two;
    o.nc = 2; /* noise of a measurement: C = A */
    for (uint8_t i = 0; i < 2; i++) {
        TEST_ASSERT_EQUAL(ERR_OK, arx_fit(&data, i, &two, ARX_LS, 0, KOTYK_SAMPLES, &work, &fit));
        TEST_ASSERT_EQUAL(ERR_OK, arx_fit(&data, i, &o, ARX_ELS, 0, KOTYK_SAMPLES, &work, &other));
        TEST_ASSERT_TRUE(worst_error(&other, i) < worst_error(&fit, i));
    }
}

static void test_a_constant_beside_extended_least_squares_settles_at_the_level(void)
{
    for (uint64_t seed = 1; seed <= 6; seed++) {
        const struct arx_data data = kotyk_record(1000, REAL_C(0.01), seed);
        struct arx_orders o = two;
        o.nc = 2;
        o.constant = true;
        for (int k = 0; k < 1000; k++)
            kotyk_y[k][0] += REAL_C(0.5);
        TEST_ASSERT_EQUAL(ERR_OK, arx_fit(&data, 0, &o, ARX_ELS, 0, 1000, &work, &fit));
        TEST_ASSERT_TRUE(fit.settled);
        double at_one = 1 + (double)(fit.theta[0] + fit.theta[1]);
        /* the level is known as well as the mean of the noise */
        TEST_ASSERT_DOUBLE_WITHIN(4 * 0.01 / sqrt(1000), 0.5, (double)fit.theta[8] / at_one);
    }
}

static void test_a_constant_takes_up_the_level_of_the_outputs(void)
{
    const struct arx_data data = kotyk_record(1023, 0, 1);
    struct arx_orders o = two;
    o.constant = true;
    for (int k = 0; k < 1023; k++)
        kotyk_y[k][0] += REAL_C(0.5);
    TEST_ASSERT_EQUAL(ERR_OK, arx_fit(&data, 0, &o, ARX_LS, 0, 1023, &work, &fit));
    double wanted[6];
    papers(0, wanted);
    double spread = (double)(fit.sd[6] / real_sqrt(fit.variance));
    TEST_ASSERT_DOUBLE_WITHIN(6 * 8 * (double)REAL_EPSILON * spread,
                              0.5 * (1 + wanted[0] + wanted[1]), (double)fit.theta[6]);
}

/* ---- how well a model does ---- */

static void test_the_papers_model_predicts_and_simulates_its_own_record(void)
{
    const struct arx_data data = kotyk_record(1023, 0, 1);
    struct arx_judgement judged;
    TEST_ASSERT_EQUAL(ERR_OK, arx_fit(&data, 1, &two, ARX_LS, 0, 700, &work, &fit));
    TEST_ASSERT_EQUAL(ERR_OK, arx_judge(&data, 1, &fit, 700, 1023, &judged));
    TEST_ASSERT_EQUAL_UINT32(321, judged.rows);
    double e = 100 * (double)REAL_EPSILON; /* errors of theta and of samples, 1/A(1) times */
    TEST_ASSERT_TRUE((double)judged.step_squares < e * e);
    TEST_ASSERT_TRUE((double)judged.simulated_squares < 13 * 13 * e * e);
    TEST_ASSERT_TRUE((double)judged.squares > 1e-3);
}

static void test_a_model_of_nothing_leaves_all_of_the_output(void)
{
    const struct arx_data data = kotyk_record(1023, 0, 1);
    struct arx_judgement judged;
    memset(&fit, 0, sizeof fit);
    fit.orders = two;
    TEST_ASSERT_EQUAL(ERR_OK, arx_judge(&data, 0, &fit, 0, 1023, &judged));
    double sum = 0, squares = 0;
    for (int k = 2; k < 1023; k++) {
        sum += (double)kotyk_y[k][0];
        squares += (double)kotyk_y[k][0] * (double)kotyk_y[k][0];
    }
    double exact = squares / 1021, about = exact - sum / 1021 * (sum / 1021);
    double rounding = 1021 * (double)REAL_EPSILON * exact;
    TEST_ASSERT_DOUBLE_WITHIN(rounding, exact, (double)judged.step_squares);
    TEST_ASSERT_DOUBLE_WITHIN(rounding, exact, (double)judged.simulated_squares);
    TEST_ASSERT_DOUBLE_WITHIN(2 * rounding, about, (double)judged.squares);
}

static void test_fits_of_both_outputs_are_a_model(void)
{
    struct arx_fit fits[2] = {
        {.orders = {.na = 1, .first = {2, 0}, .last = {3, 0}}, .theta = {REAL_C(-0.5), 2, 3}},
        {.orders = {.na = 2, .first = {1, 4}, .last = {1, 4}},
         .theta = {REAL_C(-0.9), REAL_C(0.1), 5, 7}}};
    struct difference_model m;
    arx_model(fits, 2, 2, 60, &m);
    TEST_ASSERT_EQUAL(ERR_OK, difference_check(&m, NULL, NULL));
    TEST_ASSERT_EQUAL(2, m.na);
    TEST_ASSERT_EQUAL(4, m.nb);
    TEST_ASSERT_TRUE(m.b[0][0][0] == REAL_C(0.0) && m.b[0][0][1] == REAL_C(2.0));
    TEST_ASSERT_TRUE(m.b[0][0][2] == REAL_C(3.0) && m.b[0][1][0] == REAL_C(0.0));
    TEST_ASSERT_TRUE(m.b[1][0][0] == REAL_C(5.0) && m.b[1][1][3] == REAL_C(7.0));
    TEST_ASSERT_TRUE(m.a[0][1] == REAL_C(0.0) && m.a[1][1] == REAL_C(0.1));
}

/* ---- what is refused ---- */

static void test_inputs_that_move_together_are_refused(void)
{
    const struct arx_data data = kotyk_record(1023, REAL_C(0.02), 1);
    for (int k = 0; k < 1023; k++)
        kotyk_u[k][1] = -kotyk_u[k][0];
    TEST_ASSERT_EQUAL(ERR_SINGULAR, arx_fit(&data, 0, &two, ARX_LS, 0, 1023, &work, &fit));
    TEST_ASSERT_EQUAL(ERR_SINGULAR, arx_fit(&data, 0, &two, ARX_IV, 0, 1023, &work, &fit));
}

static void test_a_record_shorter_than_its_model_is_refused(void)
{
    const struct arx_data data = kotyk_record(100, REAL_C(0.02), 1);
    TEST_ASSERT_EQUAL(ERR_EMPTY, arx_fit(&data, 0, &two, ARX_LS, 0, 9, &work, &fit));
    TEST_ASSERT_EQUAL(ERR_OK, arx_fit(&data, 0, &two, ARX_LS, 0, 10, &work, &fit));
    TEST_ASSERT_EQUAL(ERR_EMPTY, arx_fit(&data, 0, &two, ARX_LS, 0, 101, &work, &fit));
}

static void test_a_sample_that_is_no_number_is_refused(void)
{
    const struct arx_data data = kotyk_record(100, 0, 1);
    TEST_ASSERT_EQUAL(ERR_OK, arx_check(&data));
    kotyk_y[99][1] = (real_t)NAN;
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, arx_check(&data));
    kotyk_y[99][1] = REAL_C(2e12);
    TEST_ASSERT_EQUAL(ERR_RANGE, arx_check(&data));
}

static void test_orders_out_of_range_are_refused_by_name(void)
{
    const char *field = "", *wanted = "";
    struct arx_orders o = two;
    o.na = 5;
    TEST_ASSERT_EQUAL(ERR_RANGE, arx_orders_check(&o, 2, &field, &wanted));
    TEST_ASSERT_EQUAL_STRING("na", field);
    o = two;
    o.nc = 5;
    TEST_ASSERT_EQUAL(ERR_RANGE, arx_orders_check(&o, 2, &field, &wanted));
    TEST_ASSERT_EQUAL_STRING("nc", field);
    o = two;
    o.first[1] = 3;
    TEST_ASSERT_EQUAL(ERR_RANGE, arx_orders_check(&o, 2, &field, &wanted));
    TEST_ASSERT_EQUAL_STRING("first, last", field);
    o = (struct arx_orders){0};
    TEST_ASSERT_EQUAL(ERR_RANGE, arx_orders_check(&o, 2, &field, &wanted));
    TEST_ASSERT_EQUAL_STRING("na, last, constant", field);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_method_gives_what_the_independent_model_gives);
    RUN_TEST(test_least_squares_of_both_inputs_at_once_recovers_the_papers_model);
    RUN_TEST(test_noise_of_a_measurement_biases_least_squares_and_not_instruments);
    RUN_TEST(test_extended_least_squares_with_the_noises_own_order_has_less_bias);
    RUN_TEST(test_a_constant_beside_extended_least_squares_settles_at_the_level);
    RUN_TEST(test_a_constant_takes_up_the_level_of_the_outputs);
    RUN_TEST(test_the_papers_model_predicts_and_simulates_its_own_record);
    RUN_TEST(test_a_model_of_nothing_leaves_all_of_the_output);
    RUN_TEST(test_fits_of_both_outputs_are_a_model);
    RUN_TEST(test_inputs_that_move_together_are_refused);
    RUN_TEST(test_a_record_shorter_than_its_model_is_refused);
    RUN_TEST(test_a_sample_that_is_no_number_is_refused);
    RUN_TEST(test_orders_out_of_range_are_refused_by_name);
    return UNITY_END();
}
