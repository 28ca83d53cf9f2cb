/* The law of the self-tuner on linear plants whose parameters it knows, in the number format of the build.
 *
 * Contract: an MV within 2e-4 span of the exact law's (one-sample gains of 0.05 and up: rounding of y and theta by 6e-8, divided by
 * the gain, a hundred times over). */
#include <math.h>
#include <stdio.h>

#include "gmv_bench.h"
#include "unity.h"

#define MV_WITHIN 2e-4

static struct gmv_bench b;

void setUp(void)
{
    memset(&b, 0, sizeof b);
    b.config = gmv_plain_config(1);
}

void tearDown(void) {}

static const double none[GMV_LOOPS] = {0, 0};

static double error_now(double w)
{
    return w - b.plant.y[0];
}

/* One loop, y(t+1) = a y + g u. Digest of Folami (1989), 5.3.2: f0 = (a - p)/(1 - p), g0 = b/(1 - p). */
static void one_loop(enum gmv_form form, double a, double g, double tau_s)
{
    double p = tau_s > 0 ? exp(-30 / tau_s) : 0;
    b.config = gmv_plain_config(1);
    b.config.shape.form = (uint8_t)form;
    b.config.shape.bias = GMV_BIAS_NONE;
    b.config.tau_p_s[0] = (float)tau_s;
    b.config.theta[0][0] = (float)((a - p) / (1 - p));
    b.config.theta[0][1] = (float)(g / (1 - p));
    b.plant = (struct gmv_plant){.a = {a}, .b = {{g}}, .k = {{1}}};
    gmv_bench_begin(&b, 0);
}

static void with_exact_parameters_the_loop_is_first_order_with_the_time_constant_of_p(void)
{
    static const double taus[] = {0, 30, 65};
    for (unsigned form = 0; form < 2; form++)
        for (unsigned k = 0; k < 3; k++) {
            double w[GMV_LOOPS] = {0.1}, p = taus[k] > 0 ? exp(-30 / taus[k]) : 0;
            one_loop((enum gmv_form)form, 0.8, -0.4, taus[k]);
            gmv_bench_step(&b, none, none, false);
            for (unsigned t = 0; t < 40; t++) {
                double before = b.plant.y[0];
                gmv_bench_step(&b, w, none, false);
                TEST_ASSERT_DOUBLE_WITHIN(1e-5, p * before + (1 - p) * w[0], b.plant.y[0]);
            }
        }
}

/* In its very first step, before which the plant is taken to have been where it is. */
static void at_rest_away_from_zero_no_mv_moves(void)
{
    for (unsigned form = 0; form < 2; form++) {
        const double w[GMV_LOOPS] = {0.4};
        one_loop((enum gmv_form)form, 0.8, -0.4, 30);
        b.plant.y[0] = w[0];
        gmv_bench_begin(&b, -0.2);
        for (unsigned t = 0; t < 5; t++) {
            gmv_bench_step(&b, w, none, false);
            TEST_ASSERT_DOUBLE_WITHIN(MV_WITHIN, -0.2, (double)num_to_float(b.u[0]));
        }
    }
}

/* The oldest value is that of an MV with a long delay to the other loop's PV. */
static void what_is_remembered_reaches_back_to_the_oldest_mv_of_any_regression(void)
{
    for (unsigned loop = 0; loop < GMV_LOOPS; loop++) {
        struct gmv_shape shape = gmv_plain_config(2).shape;
        shape.nb = 2;
        shape.delay[loop][1 - loop] = 9;
        TEST_ASSERT_TRUE(gmv_reach(&shape) >= 9 + 1 + 1); /* delay, nb - 1, difference over k */
    }
    struct gmv_shape shape = gmv_plain_config(1).shape;
    shape.delay[0][0] = 9;
    TEST_ASSERT_TRUE(gmv_reach(&shape) >= 9 + 9);
}

/* Digest, claim 3: y(t) = 0.9 y(t-1) + u(t-1) + d. */
static void on_a_linear_plant_both_forms_serve_a_setpoint_alike(void)
{
    double iae[2] = {0, 0};
    for (unsigned form = 0; form < 2; form++) {
        one_loop((enum gmv_form)form, 0.9, 1, 0);
        gmv_bench_step(&b, none, none, false);
        for (unsigned t = 0; t < 100; t++) {
            double w[GMV_LOOPS] = {t / 25 % 2 ? -0.1 : 0.1};
            gmv_bench_step(&b, w, none, false);
            iae[form] += fabs(error_now(w[0]));
        }
    }
    printf("IAE of servo: positional %.6f, incremental %.6f\n", iae[0], iae[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, iae[0], iae[1]);
}

static void the_incremental_form_rejects_a_load_the_positional_one_keeps_an_offset_of_its_size(void)
{
    for (unsigned form = 0; form < 2; form++) {
        one_loop((enum gmv_form)form, 0.9, 1, 0);
        gmv_bench_step(&b, none, none, false);
        b.plant.d[0] = 0.05;
        for (unsigned t = 0; t < 50; t++)
            gmv_bench_step(&b, none, none, false);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, form == GMV_INCREMENTAL ? 0 : 0.05, b.plant.y[0]);
    }
}

/* Digest, claim 10. */
static void lambda_on_the_move_leaves_no_offset_a_scalar_lambda_does(void)
{
    const double w[GMV_LOOPS] = {0.1};
    for (unsigned weight = 0; weight < 2; weight++) {
        one_loop(GMV_POSITIONAL, 0.8, 0.4, 0);
        b.config.shape.weight = (uint8_t)weight;
        b.config.lambda[0] = 0.3f;
        gmv_bench_begin(&b, 0);
        for (unsigned t = 0; t < 200; t++)
            gmv_bench_step(&b, w, none, false);
        /* At rest 0.2 y = 0.4 u and 0.8 y + (0.4 + lambda) u = w. */
        double rest = weight == GMV_WEIGHT_SCALAR ? 0.1 / (0.8 + 0.7 / 2) : 0.1;
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, rest, b.plant.y[0]);
    }
}

static void two_loops(enum gmv_form form, const uint8_t delay[2][2])
{
    static const double a[2] = {0.7, 0.85}, g[2][2] = {{-0.3, 0.25}, {-0.2, 0.5}};
    b.config = gmv_plain_config(2);
    b.config.shape.form = (uint8_t)form;
    b.config.shape.bias = GMV_BIAS_NONE;
    for (unsigned i = 0; i < 2; i++) {
        b.plant.a[i] = a[i];
        b.config.theta[i][0] = (float)a[i];
        b.config.theta[i][1] = (float)g[i][i];
        b.config.theta[i][2] = (float)g[i][1 - i];
        for (unsigned j = 0; j < 2; j++) {
            b.plant.b[i][j] = g[i][j];
            b.plant.k[i][j] = b.config.shape.delay[i][j] = delay[i][j];
        }
    }
    gmv_bench_begin(&b, 0);
}

/* MD1, lambda 0: both outputs are at their setpoints a sample later, whatever the other one does. */
static void two_loops_with_delays_of_one_are_decoupled(void)
{
    static const uint8_t md1[2][2] = {{1, 1}, {1, 1}};
    for (unsigned form = 0; form < 2; form++) {
        two_loops((enum gmv_form)form, md1);
        gmv_bench_step(&b, none, none, false);
        for (unsigned t = 0; t < 60; t++) {
            double w[2] = {t / 10 % 2 ? 0.05 : -0.05, t / 15 % 2 ? -0.1 : 0.02};
            gmv_bench_step(&b, w, none, false);
            TEST_ASSERT_EQUAL(GMV_SOLVED, b.solved);
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, w[0], b.plant.y[0]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, w[1], b.plant.y[1]);
        }
    }
}

/* MD2: u1 = (R1 w1 - f11 y1 - g12 u2(t-1)) / g11 (digest 5.3.3; Folami 8.32). */
static void with_cross_delays_of_two_each_loop_is_solved_for_itself(void)
{
    static const uint8_t md2[2][2] = {{1, 2}, {2, 1}};
    two_loops(GMV_POSITIONAL, md2);
    for (unsigned t = 0; t < 40; t++) {
        double w[2] = {t / 10 % 2 ? 0.05 : -0.05, t / 15 % 2 ? -0.1 : 0.02}, y[2], u[2];
        for (unsigned i = 0; i < 2; i++) {
            y[i] = b.plant.y[i];
            u[i] = b.plant.u[i][0];
        }
        gmv_bench_step(&b, w, none, false);
        for (unsigned i = 0; i < 2; i++) {
            double exact =
                (w[i] - b.plant.a[i] * y[i] - b.plant.b[i][1 - i] * u[1 - i]) / b.plant.b[i][i];
            TEST_ASSERT_DOUBLE_WITHIN(MV_WITHIN, exact, (double)num_to_float(b.u[i]));
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, w[i], b.plant.y[i]);
        }
    }
}

/* Digest, claim 8: the source solved Eq. 8.30 by Newton's method to 1e-6 in fewer than 6 iterations. */
static void the_joint_law_is_what_newtons_method_comes_to(void)
{
    static const uint8_t md1[2][2] = {{1, 1}, {1, 1}};
    const double lambda[2] = {-0.2, 0.3};
    two_loops(GMV_POSITIONAL, md1);
    b.config.lambda[0] = (float)lambda[0];
    b.config.lambda[1] = (float)lambda[1];
    gmv_bench_begin(&b, 0);
    for (unsigned t = 0; t < 30; t++) {
        double w[2] = {0.05, t / 8 % 2 ? -0.1 : 0.02}, y[2], before[2], u[2];
        for (unsigned i = 0; i < 2; i++) {
            y[i] = b.plant.y[i];
            u[i] = before[i] = b.plant.u[i][0];
        }
        unsigned iterations = 0;
        for (double moved = 1; moved > 1e-6 && iterations < 6; iterations++) {
            double r[2], j[2][2], det;
            for (unsigned i = 0; i < 2; i++) {
                r[i] = b.plant.a[i] * y[i] + b.plant.b[i][0] * u[0] + b.plant.b[i][1] * u[1] +
                       lambda[i] * (u[i] - before[i]) - w[i];
                for (unsigned k = 0; k < 2; k++)
                    j[i][k] = b.plant.b[i][k] + (i == k ? lambda[i] : 0);
            }
            det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
            double step[2] = {(r[0] * j[1][1] - r[1] * j[0][1]) / det,
                              (r[1] * j[0][0] - r[0] * j[1][0]) / det};
            u[0] -= step[0];
            u[1] -= step[1];
            moved = fmax(fabs(step[0]), fabs(step[1]));
        }
        TEST_ASSERT_LESS_THAN(6, iterations);
        gmv_bench_step(&b, w, none, false);
        for (unsigned i = 0; i < 2; i++)
            TEST_ASSERT_DOUBLE_WITHIN(MV_WITHIN, u[i], (double)num_to_float(b.u[i]));
    }
}

/* One MV stands at its limit; the other keeps the equation of its own loop. */
static void where_one_mv_is_at_its_limit_the_other_is_solved_with_it_there(void)
{
    static const uint8_t md1[2][2] = {{1, 1}, {1, 1}};
    const double w[2] = {0.2, 0.1};
    two_loops(GMV_POSITIONAL, md1);
    b.range.lo[0] = num_from_float(-0.1f);
    b.range.hi[0] = num_from_float(0.1f);
    gmv_bench_step(&b, w, none, false);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.1, (double)num_to_float(b.u[0]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, w[1], b.plant.y[1]);
}

static void a_member_in_manual_stays_and_the_other_makes_up_for_it(void)
{
    static const uint8_t md1[2][2] = {{1, 1}, {1, 1}};
    const double w[2] = {0.2, 0.1};
    two_loops(GMV_INCREMENTAL, md1);
    gmv_bench_step(&b, none, none, false);
    b.acting = 2;
    b.range.fixed[0] = num_from_float(0.07f);
    gmv_bench_step(&b, w, none, false);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.07, (double)num_to_float(b.u[0]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, w[1], b.plant.y[1]);
}

static void rows_too_much_alike_are_solved_one_by_one(void)
{
    static const uint8_t md1[2][2] = {{1, 1}, {1, 1}};
    const double w[2] = {0.01, -0.01};
    two_loops(GMV_POSITIONAL, md1);
    for (unsigned i = 0; i < 2; i++) {
        b.config.theta[i][1] = 0.5f;
        b.config.theta[i][2] = 0.499f;
    }
    gmv_bench_begin(&b, 0);
    gmv_bench_step(&b, w, none, false);
    TEST_ASSERT_EQUAL(GMV_ONE_BY_ONE, b.solved);
    TEST_ASSERT_DOUBLE_WITHIN(MV_WITHIN, 0.02, (double)num_to_float(b.u[0]));
    TEST_ASSERT_DOUBLE_WITHIN(MV_WITHIN, -0.02, (double)num_to_float(b.u[1]));
}

/* y(t+1) = 1.4 y(t) - 0.45 y(t-1) + 0.2 u(t-k+1) + 0.1 u(t-k), horizon k: the explicit design knows A and B, the implicit one
 * is given what the Diophantine equation makes of them. */
static void the_explicit_design_gives_the_mv_of_the_implicit_one(void)
{
    for (unsigned k = 1; k <= 3; k++) {
        const double a[2] = {1.4, -0.45}, g[2] = {0.2, 0.1};
        double e[3] = {1, 1.4, 1.4 * 1.4 - 0.45}, f[2];
        f[0] = (k == 1 ? a[0] : (k == 2 ? e[1] * a[0] + a[1] : e[2] * a[0] + e[1] * a[1]));
        f[1] = e[k - 1] * a[1];
        double u[2];
        for (unsigned way = 0; way < 2; way++) {
            struct gmv_shape *shape = &b.config.shape;
            b.config = gmv_plain_config(1);
            shape->na = 2;
            shape->nb = (uint8_t)(way == GMV_EXPLICIT ? 2 : k + 1);
            shape->way = (uint8_t)way;
            shape->form = GMV_INCREMENTAL;
            shape->delay[0][0] = (uint8_t)k;
            b.config.lambda[0] = 0.1f;
            for (unsigned l = 0; l < 2; l++)
                b.config.theta[0][l] = (float)(way == GMV_EXPLICIT ? a[l] : f[l]);
            for (unsigned l = 0; l < shape->nb; l++) {
                double product = 0;
                for (unsigned m = 0; m < k; m++)
                    product += l >= m && l - m < 2 ? e[m] * g[l - m] : 0;
                b.config.theta[0][2 + l] = (float)(way == GMV_EXPLICIT ? g[l] : product);
            }
            memset(&b.plant, 0, sizeof b.plant);
            gmv_bench_begin(&b, 0);
            double y1 = 0, sum = 0;
            for (unsigned t = 0; t < 30; t++) {
                const double w[GMV_LOOPS] = {t < 3 ? 0 : 0.1};
                double y = b.plant.y[0];
                gmv_bench_step(&b, w, none, false);
                b.plant.y[0] =
                    a[0] * y + a[1] * y1 + g[0] * b.plant.u[0][k - 1] + g[1] * b.plant.u[0][k];
                y1 = y;
                sum += (double)num_to_float(b.u[0]) * (t + 1);
            }
            u[way] = sum;
            TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.1, b.plant.y[0]);
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.05, u[0], u[1]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(with_exact_parameters_the_loop_is_first_order_with_the_time_constant_of_p);
    RUN_TEST(at_rest_away_from_zero_no_mv_moves);
    RUN_TEST(what_is_remembered_reaches_back_to_the_oldest_mv_of_any_regression);
    RUN_TEST(on_a_linear_plant_both_forms_serve_a_setpoint_alike);
    RUN_TEST(the_incremental_form_rejects_a_load_the_positional_one_keeps_an_offset_of_its_size);
    RUN_TEST(lambda_on_the_move_leaves_no_offset_a_scalar_lambda_does);
    RUN_TEST(two_loops_with_delays_of_one_are_decoupled);
    RUN_TEST(with_cross_delays_of_two_each_loop_is_solved_for_itself);
    RUN_TEST(the_joint_law_is_what_newtons_method_comes_to);
    RUN_TEST(where_one_mv_is_at_its_limit_the_other_is_solved_with_it_there);
    RUN_TEST(a_member_in_manual_stays_and_the_other_makes_up_for_it);
    RUN_TEST(rows_too_much_alike_are_solved_one_by_one);
    RUN_TEST(the_explicit_design_gives_the_mv_of_the_implicit_one);
    return UNITY_END();
}
