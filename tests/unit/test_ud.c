/* Covariances as U D U', in the number format of the build, beside two references in double: the dense formulas, and the
 * square-root form of T. O. Folami (1989), appendix A5.1, whose subscripts are those that the digest of it was checked with.
 *
 * Contract, both formats: each element P_ij within RELATIVE * (number of updates) * n of sqrt(P_ii P_jj); so small a step of
 * rounding each update may add. The dense reference itself is good to 1e-12 there. */
#include <math.h>
#include <string.h>

#include "num/scaled_inline.h"
#include "num/ud.h"
#include "num/ud_num.h"
#include "random_source.h"
#include "unity.h"

#define SIZE 24
#define RELATIVE                                                                                   \
    3e-7 /* two and a half steps of float; Q7.24's columns have 2^-25 of their largest */
#define SEED 20261123u

static struct random_source source;
static ud_cell_t ud[SIZE * (SIZE + 1) / 2 + 2 * SIZE];
static double dense[SIZE][SIZE], root[SIZE][SIZE];

void setUp(void)
{
    source.state = SEED;
}

void tearDown(void) {}

static double uniform(void)
{
    return (double)(random_next(&source) >> 11) / 9007199254740992.0 * 2 - 1;
}

static scaled_t scaled(double x)
{
    return scaled_from_float((float)x);
}

static void begin(size_t n, const double *p)
{
    scaled_t diagonal[SIZE];
    memset(dense, 0, sizeof dense);
    memset(root, 0, sizeof root);
    for (size_t i = 0; i < n; i++) {
        diagonal[i] = scaled(p[i]);
        dense[i][i] = (double)scaled_to_float(diagonal[i]);
        root[i][i] = sqrt(dense[i][i]);
    }
    ud_num_set_diagonal(ud, n, diagonal);
}

/* (P - P phi phi'P / alpha) / v; gain gets P phi / alpha. */
static double dense_correct(size_t n, const double *phi, double v, double *gain)
{
    double alpha = v, p_phi[SIZE];
    for (size_t i = 0; i < n; i++) {
        p_phi[i] = 0;
        for (size_t j = 0; j < n; j++)
            p_phi[i] += dense[i][j] * phi[j];
    }
    for (size_t i = 0; i < n; i++)
        alpha += phi[i] * p_phi[i];
    for (size_t i = 0; i < n; i++) {
        gain[i] = p_phi[i] / alpha;
        for (size_t j = 0; j < n; j++)
            dense[i][j] = (dense[i][j] - p_phi[i] * p_phi[j] / alpha) / v;
    }
    return alpha;
}

/* P = S S' (Folami A5.1). */
static void root_correct(size_t n, const double *phi, double v)
{
    double s[SIZE] = {0}, before = v;
    for (size_t j = 0; j < n; j++) {
        double f = 0, now;
        for (size_t i = 0; i <= j; i++)
            f += root[i][j] * phi[i];
        now = before + f * f;
        for (size_t i = 0; i <= j; i++) {
            double old = root[i][j];
            root[i][j] = sqrt(before) * (old - f * s[i] / before) / (sqrt(now) * sqrt(v));
            s[i] += old * f;
        }
        before = now;
    }
}

static double rooted(size_t n, size_t i, size_t j)
{
    double sum = 0;
    for (size_t k = 0; k < n; k++)
        sum += root[i][k] * root[j][k];
    return sum;
}

static void check_covariance(size_t n, unsigned updates, double relative)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            double got = (double)scaled_to_float(ud_num_element(ud, n, i, j));
            double scale = sqrt(dense[i][i] * dense[j][j]);
            TEST_ASSERT_DOUBLE_WITHIN(relative * (updates + 1u) * (double)n * scale, dense[i][j],
                                      got);
        }
}

static void update(size_t n, const double *phi, double v)
{
    num_t x[SIZE];
    memset(x, 0, sizeof x);
    scaled_t f[SIZE], g[SIZE], r = scaled(v);
    double exact[SIZE], gain[SIZE], v_taken = (double)scaled_to_float(r);
    for (size_t i = 0; i < n; i++) {
        x[i] = num_from_float((float)phi[i]);
        exact[i] = (double)num_to_float(x[i]);
    }
    ud_num_project(ud, n, x, f, g);
    scaled_t variance = ud_num_variance(f, g, n);
    scaled_t alpha = ud_num_correct(ud, n, f, g, r, scaled_div(scaled(1), r));
    double largest = 0;
    root_correct(n, exact, v_taken);
    double alpha_dense = dense_correct(n, exact, v_taken, gain);
    for (size_t i = 0; i < n; i++)
        largest = fmax(largest, fabs(gain[i]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * alpha_dense, alpha_dense, (double)scaled_to_float(alpha));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * alpha_dense, alpha_dense - v_taken,
                              (double)scaled_to_float(variance));
    for (size_t i = 0; i < n; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * largest, gain[i],
                                  (double)scaled_to_float(scaled_div(g[i], alpha)));
}

static void an_update_is_the_dense_formulas(void)
{
    static const size_t sizes[] = {1, 2, 3, 4, 6, 9, 12, 24};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        size_t n = sizes[k];
        double p[SIZE], phi[SIZE];
        for (size_t i = 0; i < n; i++)
            p[i] = pow(10, 2 * uniform());
        begin(n, p);
        for (unsigned t = 0; t < 100; t++) {
            for (size_t i = 0; i < n; i++)
                phi[i] = uniform();
            update(n, phi, t % 3 ? 0.98 : 1);
        }
        check_covariance(n, 100, RELATIVE);
    }
}

/* P(0) = 1e8 beside noise of 1, which is within what an estimator may be told: the first measurements take eight decades from
 * P, and the dense reference in double keeps 1e-16 times 1e9 of it, still below the contract. */
static void a_covariance_far_above_the_noise_costs_no_digits(void)
{
    static const size_t sizes[] = {2, 3, 6, 9, 12, 24};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        size_t n = sizes[k];
        double p[SIZE], phi[SIZE];
        for (size_t i = 0; i < n; i++)
            p[i] = 1e8;
        begin(n, p);
        for (unsigned t = 0; t < 50; t++) {
            for (size_t i = 0; i < n; i++)
                phi[i] = uniform();
            update(n, phi, 0.98);
        }
        check_covariance(n, 50, RELATIVE);
    }
}

static void the_square_root_form_of_the_source_is_the_same_update(void)
{
    const size_t n = 4;
    double p[SIZE] = {10, 10, 10, 10}, phi[SIZE];
    begin(n, p);
    for (unsigned t = 0; t < 60; t++) {
        for (size_t i = 0; i < n; i++)
            phi[i] = uniform();
        update(n, phi, 0.9);
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < n; j++)
                TEST_ASSERT_DOUBLE_WITHIN(1e-9 * sqrt(dense[i][i] * dense[j][j]), dense[i][j],
                                          rooted(n, i, j));
    }
    check_covariance(n, 60, RELATIVE);
}

static void an_addition_of_rank_one_is_the_dense_one(void)
{
    const size_t n = 6;
    double p[SIZE] = {1, 10, 0.1, 1, 5, 2}, phi[SIZE];
    begin(n, p);
    for (unsigned t = 0; t < 30; t++) {
        scaled_t v[SIZE];
        double c = 0.5 + 0.4 * uniform();
        for (size_t i = 0; i < n; i++) {
            phi[i] = uniform();
            v[i] = scaled(phi[i]);
        }
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < n; j++)
                dense[i][j] += (double)scaled_to_float(scaled(c)) * (double)(float)phi[i] *
                               (double)(float)phi[j];
        ud_num_add(ud, n, scaled(c), v);
    }
    check_covariance(n, 30, RELATIVE);
}

/* Tests num/ud.h alone, as estimators in float use it. Columns and vectors go in pairs, so every place is a case of its own. */
static void additions_to_one_or_two_variances_are_the_dense_ones(void)
{
    static real_t plain[SIZE * (SIZE + 1) / 2], v[2 * SIZE];
    for (size_t at = 0; at < SIZE; at++)
        for (int two = 0; two < (at > 0 ? 2 : 1); two++) {
            for (size_t j = 0, k = 0; j < SIZE; j++)
                for (size_t i = 0; i <= j; i++, k++)
                    plain[k] = (real_t)(i == j ? 1.5 + uniform() : 0.3 * uniform());
            for (size_t i = 0; i < SIZE; i++)
                for (size_t j = 0; j < SIZE; j++)
                    dense[i][j] = (double)ud_element(plain, SIZE, i, j);
            dense[at][at] += 0.75;
            if (two) {
                dense[at - 1][at - 1] += 0.5;
                ud_add_pair(plain, at, REAL_C(0.75), REAL_C(0.5), v);
            } else {
                ud_add_at(plain, at, REAL_C(0.75), v);
            }
            for (size_t i = 0; i < SIZE; i++)
                for (size_t j = 0; j < SIZE; j++)
                    TEST_ASSERT_DOUBLE_WITHIN(RELATIVE * SIZE * sqrt(dense[i][i] * dense[j][j]),
                                              dense[i][j], (double)ud_element(plain, SIZE, i, j));
        }
}

static void columns_before_the_first_of_a_measurement_stay(void)
{
    static real_t plain[SIZE * (SIZE + 1) / 2], whole[SIZE * (SIZE + 1) / 2];
    real_t phi[SIZE], f[SIZE], g[SIZE], own[SIZE];
    for (size_t from = 0; from < SIZE; from++) {
        for (size_t j = 0, k = 0; j < SIZE; j++) {
            phi[j] = j < from ? 0 : (real_t)uniform();
            for (size_t i = 0; i <= j; i++, k++)
                whole[k] = plain[k] = (real_t)(i == j ? 1.5 + uniform() : 0.3 * uniform());
        }
        ud_project(plain, SIZE, phi, f, g);
        memcpy(own, g, sizeof own);
        real_t alpha = ud_correct(whole, SIZE, f, own, REAL_C(0.1), 1);
        TEST_ASSERT_TRUE(ud_correct_from(plain, SIZE, from, f, g, REAL_C(0.1), 1) == alpha);
        TEST_ASSERT_EQUAL_MEMORY(own, g, sizeof g);
        TEST_ASSERT_EQUAL_MEMORY(whole, plain, sizeof plain);
    }
}

/* Below it a quotient by D would not be a number with all its digits. */
static void an_addition_that_leaves_d_at_1e_30_or_less_is_left_out(void)
{
    static const struct {
        real_t c;
        bool counts;
    } added[] = {{REAL_C(1.5e-30), true}, {REAL_C(1e-30), false}, {REAL_C(0.7e-30), false}};
    for (unsigned i = 0; i < 3; i++) {
        real_t d = 0, v = 1;
        ud_add(&d, 1, added[i].c, &v);
        TEST_ASSERT_TRUE(d == (added[i].counts ? added[i].c : 0));
    }
}

static void products_and_solutions_are_those_of_the_dense_matrix(void)
{
    const size_t n = 9;
    double p[SIZE], phi[SIZE];
    for (size_t i = 0; i < n; i++)
        p[i] = 1;
    begin(n, p);
    for (unsigned t = 0; t < 20; t++) {
        for (size_t i = 0; i < n; i++)
            phi[i] = uniform();
        update(n, phi, 1);
    }
    scaled_t x[SIZE], y[SIZE], back[SIZE];
    double trace = 0;
    for (size_t i = 0; i < n; i++) {
        x[i] = scaled(uniform());
        trace += dense[i][i];
    }
    ud_num_multiply(ud, n, x, y);
    ud_num_solve(ud, n, y, back);
    for (size_t i = 0; i < n; i++) {
        double product = 0;
        for (size_t j = 0; j < n; j++)
            product += dense[i][j] * (double)scaled_to_float(x[j]);
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, product, (double)scaled_to_float(y[i]));
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, (double)scaled_to_float(x[i]),
                                  (double)scaled_to_float(back[i]));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * trace, trace, (double)scaled_to_float(ud_num_trace(ud, n)));
    ud_num_scale(ud, n, scaled(3));
    TEST_ASSERT_DOUBLE_WITHIN(3e-4 * trace, 3 * trace,
                              (double)scaled_to_float(ud_num_trace(ud, n)));
}

static void d_is_brought_into_its_range_and_what_is_inside_stays(void)
{
    const double p[SIZE] = {1e-6, 1, 1e6};
    scaled_t least, most;
    begin(3, p);
    for (size_t j = 0; j < 3; j++)
        TEST_ASSERT_EQUAL(j != 1, ud_num_clamp(ud, 3, j, scaled(1e-3), scaled(1e3)));
    ud_num_extremes(ud, 3, &least, &most);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1e-3, (double)scaled_to_float(least));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1e3, (double)scaled_to_float(most));
    TEST_ASSERT_FALSE(ud_num_clamp(ud, 3, 0, scaled(1e-3), scaled(1e3)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, (double)scaled_to_float(ud_num_element(ud, 3, 1, 1)));
}

/* Regressors a thousand times apart, two of them always together: D has to stay positive, whatever rounding does. */
static void d_stays_positive_on_stiff_data_that_excite_little(void)
{
    const size_t n = 6;
    num_t phi[SIZE];
    scaled_t f[SIZE], g[SIZE], least, most, diagonal[SIZE], one = scaled(1);
    for (size_t i = 0; i < n; i++)
        diagonal[i] = scaled(10);
    ud_num_set_diagonal(ud, n, diagonal);
    for (unsigned t = 0; t < 200000; t++) {
        double a = uniform(), b = 1e-3 * uniform();
        const double x[] = {a, a, b, b + 1e-6 * uniform(), 1, 1};
        for (size_t i = 0; i < n; i++)
            phi[i] = num_from_float((float)x[i]);
        ud_num_project(ud, n, phi, f, g);
        (void)ud_num_correct(ud, n, f, g, one, one);
        ud_num_extremes(ud, n, &least, &most);
        TEST_ASSERT_TRUE(scaled_lt(scaled(0), least));
        TEST_ASSERT_TRUE(scaled_lt(most, scaled(11)));
    }
}

static void numbers_with_exponents_keep_their_digits(void)
{
    for (unsigned t = 0; t < 100000; t++) {
        double a = uniform() * pow(10, 12 * uniform()), b = uniform() * pow(10, 12 * uniform());
        scaled_t x = scaled(a), y = scaled(b);
        a = (double)scaled_to_float(x);
        b = (double)scaled_to_float(y);
        TEST_ASSERT_DOUBLE_WITHIN(2e-7 * fabs(a * b), a * b,
                                  (double)scaled_to_float(scaled_mul(x, y)));
        TEST_ASSERT_DOUBLE_WITHIN(2e-7 * fabs(a / b), a / b,
                                  (double)scaled_to_float(scaled_div(x, y)));
        TEST_ASSERT_DOUBLE_WITHIN(2e-7 * fmax(fabs(a), fabs(b)), a + b,
                                  (double)scaled_to_float(scaled_add(x, y)));
        TEST_ASSERT_DOUBLE_WITHIN(2e-7 * fmax(fabs(a), fabs(b)), a - b,
                                  (double)scaled_to_float(scaled_sub(x, y)));
        TEST_ASSERT_EQUAL(a < b, scaled_lt(x, y));
        if (fabs(a) < 100)
            TEST_ASSERT_DOUBLE_WITHIN(2e-7 * fmax(fabs(a), 0.5), a,
                                      (double)num_to_float(scaled_to_num(x)));
    }
}

/* Products are rounded down: -2^30 is a mantissa, 2^30 is none. */
static void the_sum_of_two_least_mantissas_is_a_number(void)
{
#ifdef REFLUX_FIXED_POINT
    scaled_t least = {-(1 << 30), 0}, sum = inline_add(least, least);
    TEST_ASSERT_TRUE(scaled_to_float(sum) == -0x1p31f);
    sum = inline_add(sum, sum);
    TEST_ASSERT_TRUE(scaled_to_float(sum) == -0x1p32f);
#endif
}

static void what_cannot_be_divided_is_as_large_as_can_be(void)
{
    TEST_ASSERT_TRUE(scaled_to_float(scaled_div(scaled(1), scaled(0))) > 1e38f);
    TEST_ASSERT_TRUE(scaled_to_float(scaled_div(scaled(-1), scaled(0))) < -1e38f);
    TEST_ASSERT_EQUAL_FLOAT(0, scaled_to_float(scaled_div(scaled(0), scaled(0))));
}

int main(void)
{
    UNITY_BEGIN();
    printf("seed %u\n", SEED);
    RUN_TEST(an_update_is_the_dense_formulas);
    RUN_TEST(a_covariance_far_above_the_noise_costs_no_digits);
    RUN_TEST(the_square_root_form_of_the_source_is_the_same_update);
    RUN_TEST(an_addition_of_rank_one_is_the_dense_one);
    RUN_TEST(additions_to_one_or_two_variances_are_the_dense_ones);
    RUN_TEST(columns_before_the_first_of_a_measurement_stay);
    RUN_TEST(an_addition_that_leaves_d_at_1e_30_or_less_is_left_out);
    RUN_TEST(products_and_solutions_are_those_of_the_dense_matrix);
    RUN_TEST(d_is_brought_into_its_range_and_what_is_inside_stays);
    RUN_TEST(d_stays_positive_on_stiff_data_that_excite_little);
    RUN_TEST(numbers_with_exponents_keep_their_digits);
    RUN_TEST(the_sum_of_two_least_mantissas_is_a_number);
    RUN_TEST(what_cannot_be_divided_is_as_large_as_can_be);
    return UNITY_END();
}
