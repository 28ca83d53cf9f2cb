/* identify/shape_response.[ch], against tests/reference/shape_reference.py.
 *
 * Contract (both scalar types)
 *   response to edges of 0.05     5e-5 of the largest response in float, 1e-10 in double, for one lag, two lags as near as they
 *                                 may be, damping from 0.1, and an integrator; measured: 3.1e-5 and 4e-12
 *   derivative by the dead time   1e-3 of its largest value (the reference is a difference)
 */
#include <math.h>
#include <string.h>

#include "csv.h"
#include "identify/record.h"
#include "identify/response.h"
#include "identify/shape_response.h"
#include "unity.h"

static real_t model[RECORD_POINTS], change[RECORD_POINTS], by_dead[RECORD_POINTS];

void setUp(void) {}
void tearDown(void) {}

static double largest(const real_t *values, uint32_t n)
{
    double top = 0.0;
    for (uint32_t i = 0; i < n; i++)
        top = fmax(top, fabs((double)values[i]));
    return top;
}

static void responses_are_those_of_the_reference(void)
{
    FILE *f = csv_open("reference/shape_response.csv");
    double v[30], worst = 0.0, worst_slope = 0.0;
    int n = 0;
    while (csv_row(f, v, 30)) {
        struct excitation u;
        struct shape_modes m;
        excitation_clear(&u);
        u.edges = 3;
        for (int j = 0; j < 3; j++) {
            u.edge[j].sample = (uint32_t)v[6 + 2 * j];
            u.edge[j].change = (real_t)v[7 + 2 * j];
        }
        uint32_t points = (uint32_t)v[5];
        const struct shape_column columns[2] = {{model, 1, (real_t)v[2], false},
                                                {by_dead, 1, (real_t)v[2], true}};
        shape_modes_find((real_t)v[0], (real_t)v[1], &m);
        shape_response(&u, &m, (real_t)v[3], (uint32_t)v[4], points, columns, 2);
        /* The integrator stands for itself: what is seen of it is a small part of its gain. */
        double top = fmax(largest(model, points), 0.01);
        double top_slope = fmax(largest(by_dead, points), 1e-4);
        for (int k = 0; k < 6; k++) {
            uint32_t i = (uint32_t)v[12 + 3 * k];
            worst = fmax(worst, fabs((double)model[i] - v[13 + 3 * k]) / top);
            worst_slope = fmax(worst_slope, fabs((double)by_dead[i] - v[14 + 3 * k]) / top_slope);
        }
        n++;
    }
    fclose(f);
    char text[120];
    snprintf(text, sizeof text, "%d cases, worst: %.2g of the response, %.2g of its derivative", n,
             worst, worst_slope);
    TEST_MESSAGE(text);
    TEST_ASSERT_EQUAL_INT(64, n);
    TEST_ASSERT_TRUE(worst < (sizeof(real_t) > 4 ? 1e-10 : 5e-5));
    TEST_ASSERT_TRUE(worst_slope < 1e-3);
}

static struct excitation double_step(void)
{
    struct excitation u;
    TEST_ASSERT_EQUAL_INT(ERR_OK, excitation_double_step(&u, 3, 100, 100, (real_t)0.05));
    return u;
}

static void one_lag_is_that_of_the_fit_of_one_lag(void)
{
    struct excitation u = double_step();
    static const double lags[] = {0.0, 0.3, 4.0, 60.0, 5000.0};
    for (unsigned k = 0; k < sizeof lags / sizeof lags[0]; k++) {
        struct shape_modes m;
        const struct shape_column columns[2] = {{model, 1, 0, false}, {by_dead, 1, 0, true}};
        real_t plain[RECORD_POINTS], plain_dead[RECORD_POINTS];
        shape_modes_find((real_t)lags[k], 0, &m);
        shape_response(&u, &m, (real_t)7.3, 4, 100, columns, 2);
        response_model(&u, (real_t)lags[k], (real_t)7.3, 4, 100, plain, plain_dead);
        for (uint32_t i = 0; i < 100; i++) {
            TEST_ASSERT_DOUBLE_WITHIN(3e-7, (double)plain[i], (double)model[i]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)plain_dead[i], (double)by_dead[i]);
        }
    }
}

static void a_zero_adds_its_part_of_the_derivative(void)
{
    struct excitation u = double_step();
    struct shape_modes m;
    real_t whole[RECORD_POINTS];
    const struct shape_column columns[3] = {
        {model, 1, 0, false}, {change, 0, 1, false}, {whole, 2, -30, false}};
    shape_modes_find(50, 400, &m);
    shape_response(&u, &m, (real_t)2.5, 4, 100, columns, 3);
    for (uint32_t i = 0; i < 100; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.0 * (double)model[i] - 30.0 * (double)change[i],
                                  (double)whole[i]);
}

static void what_is_to_come_is_one_less_the_step_response(void)
{
    static const double squares[] = {0.0, 100.0, 400.0, 624.0, 2500.0, 40000.0};
    for (unsigned k = 0; k < sizeof squares / sizeof squares[0]; k++) {
        struct excitation u = {.edges = 1, .edge = {{0, 1}}};
        struct shape_modes m;
        const struct shape_column column = {model, 1, 20, false};
        shape_modes_find(50, (real_t)squares[k], &m);
        shape_response(&u, &m, 0, 1, 128, &column, 1);
        for (uint32_t i = 1; i < 128; i += 9)
            TEST_ASSERT_DOUBLE_WITHIN(2e-5, 1.0 - (double)model[i],
                                      (double)shape_response_to_come(&m, (real_t)i, 20));
    }
}

static void nothing_comes_before_the_dead_time_is_over(void)
{
    struct excitation u = double_step();
    struct shape_modes m;
    const struct shape_column column = {model, 1, 40, false};
    shape_modes_find(10, 400, &m);
    shape_response(&u, &m, 30, 4, 100, &column, 1);
    for (uint32_t i = 0; i < 8; i++) /* samples 0 to 31; the first that answers is 34 */
        TEST_ASSERT_TRUE(model[i] >= 0 && model[i] <= 0);
    TEST_ASSERT_TRUE(model[8] > 0);
    shape_response(&u, &m, 5000, 4, 100, &column, 1);
    TEST_ASSERT_TRUE(largest(model, 100) <= 0.0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(responses_are_those_of_the_reference);
    RUN_TEST(one_lag_is_that_of_the_fit_of_one_lag);
    RUN_TEST(a_zero_adds_its_part_of_the_derivative);
    RUN_TEST(what_is_to_come_is_one_less_the_step_response);
    RUN_TEST(nothing_comes_before_the_dead_time_is_over);
    return UNITY_END();
}
