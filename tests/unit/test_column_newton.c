/* Newton matrices of columns against differences of the rates, with flows and holdups held. */
#include "columns/column_newton.h"
#include "test_columns.h"
#include "unity.h"

#include <math.h>
#include <string.h>

#define STAGES 10
#define N      20 /* states */

static struct column_config config;
static struct column column;
static struct column_fault fault;
static struct column_newton *newton;
static double x[N], rates[N];

void setUp(void)
{
    newton = NULL;
}

void tearDown(void)
{
    column_newton_destroy(newton);
}

static void make(double efficiency)
{
    struct column_inputs inputs = ternary_inputs();
    config = ternary_config(COLUMN_HOLDUP_VOLUMETRIC);
    config.efficiency = efficiency;
    ternary_profile(x, 0);
    TEST_ASSERT_EQUAL(ERR_OK, column_init(&column, &config, &fault));
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
    TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
    newton = column_newton_create(&config);
    TEST_ASSERT_NOT_NULL(newton);
}

/* Rates with the flows and holdups of the base point, summed up as the model's header says. A stage whose liquid
 * is negative takes as much from the stage below. */
static void held_rates(const struct column *base, const double *at, double *out)
{
    struct column moved = *base;
    TEST_ASSERT_EQUAL(ERR_OK, column_evaluate(&moved, at));
    for (size_t s = 0; s < STAGES; s++)
        for (size_t j = 0; j < 2; j++) {
            double here = at[2 * s + j];
            double sum = -base->vapour_flow[s] * (moved.vapour[3 * s + j] - here);
            if (s < STAGES - 1)
                sum += fmax(base->liquid[s + 1], 0.0) * (at[2 * s + 2 + j] - here);
            if (s > 0 && s < STAGES - 1)
                sum += fmax(-base->liquid[s], 0.0) * (at[2 * s - 2 + j] - here);
            if (s > 0)
                sum += base->vapour_flow[s - 1] * (moved.vapour[3 * s - 3 + j] - here);
            if (s + 1 == config.feed_stage)
                sum += base->flows.feed * (base->inputs.feed_fraction[j] - here);
            out[2 * s + j] = sum / base->holdup[s];
        }
}

/* The largest element of b - (a I + c J) solve(b), relative to b, over unit vectors b. */
static double residue(double a, double c)
{
    double worst = 0.0;
    column_newton_read(newton, &column, x);
    TEST_ASSERT_TRUE(column_newton_factor(newton, a, c));
    for (int k = 0; k < N; k++) {
        double b[N] = {0}, v[N], above[N], below[N], at[N], largest = 0.0;
        b[k] = 1.0;
        column_newton_solve(newton, b, v);
        for (int i = 0; i < N; i++)
            largest = fmax(largest, fabs(v[i]));
        double h = 1e-6 / largest;
        for (int i = 0; i < N; i++)
            at[i] = x[i] + h * v[i];
        held_rates(&column, at, above);
        for (int i = 0; i < N; i++)
            at[i] = x[i] - h * v[i];
        held_rates(&column, at, below);
        for (int i = 0; i < N; i++) {
            double image = a * v[i] + c * (above[i] - below[i]) / (2 * h);
            worst = fmax(worst, fabs(image - b[i]));
        }
    }
    return worst;
}

static void solutions_solve_the_equations_with_every_efficiency(void)
{
    static const double efficiency[] = {1.0, 0.9, 0.5, 0.1};
    for (int i = 0; i < 4; i++) {
        make(efficiency[i]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, residue(1.0, -3.0));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, residue(1.0, -1e-3));
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, residue(0.0, 3600.0)); /* the steady state's */
        column_newton_destroy(newton);
        newton = NULL;
    }
}

static void liquid_that_is_drawn_upwards_is_in_the_equations(void)
{
    make(0.7);
    column.liquid[5] = -0.3 * column.liquid[5];
    column.liquid[6] = -0.1 * column.liquid[6];
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, residue(1.0, -3.0));
}

static void right_hand_side_and_solution_may_be_one_array(void)
{
    make(0.7);
    double b[N], v[N];
    for (int i = 0; i < N; i++)
        b[i] = sin(1.0 + i);
    column_newton_read(newton, &column, x);
    TEST_ASSERT_TRUE(column_newton_factor(newton, 1.0, -2.0));
    column_newton_solve(newton, b, v);
    column_newton_solve(newton, b, b);
    TEST_ASSERT_EQUAL_MEMORY(v, b, sizeof b);
}

static void a_copy_solves_the_same_equations(void)
{
    make(0.7);
    struct column_newton *copy = column_newton_create(&config);
    TEST_ASSERT_NOT_NULL(copy);
    double b[N], v[2][N];
    for (int i = 0; i < N; i++)
        b[i] = cos(1.0 + i);
    column_newton_read(newton, &column, x);
    column_newton_copy(newton, copy);
    TEST_ASSERT_TRUE(column_newton_factor(newton, 1.0, -2.0));
    TEST_ASSERT_TRUE(column_newton_factor(copy, 1.0, -2.0));
    column_newton_solve(newton, b, v[0]);
    column_newton_solve(copy, b, v[1]);
    TEST_ASSERT_EQUAL_MEMORY(v[0], v[1], sizeof b);
    column_newton_destroy(copy);
}

static void a_singular_matrix_and_one_that_is_no_number_are_refused(void)
{
    make(0.7);
    struct column_inputs none = ternary_inputs(); /* nothing flows: J = 0 */
    none.feed_flow = none.heat = none.reflux_flow = 0;
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &none, &fault));
    TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
    column_newton_read(newton, &column, x);
    TEST_ASSERT_FALSE(column_newton_factor(newton, 0.0, 1.0));
    TEST_ASSERT_TRUE(column_newton_factor(newton, 1.0, -1.0));
    TEST_ASSERT_FALSE(column_newton_factor(newton, NAN, -1.0));
    TEST_ASSERT_FALSE(column_newton_factor(newton, 1.0, 0.0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(solutions_solve_the_equations_with_every_efficiency);
    RUN_TEST(liquid_that_is_drawn_upwards_is_in_the_equations);
    RUN_TEST(right_hand_side_and_solution_may_be_one_array);
    RUN_TEST(a_copy_solves_the_same_equations);
    RUN_TEST(a_singular_matrix_and_one_that_is_no_number_are_refused);
    return UNITY_END();
}
