/* num/polynomial.[ch]; built in float and in double. eps is REAL_EPSILON.
 *
 * Contract
 *   determinant, adjugate   200 random matrices of each size: adj m = det I within 64 eps of the sum of the terms' magnitudes,
 *                           det within 32 eps of it of that by Leibniz' formula in double (in the double build by permutations
 *                           in long double)
 *   zeros                   148 polynomials of degrees up to 31 against 240 bits (tests/reference/polynomial_reference.py): each
 *                           within 2 n (4 n + 1) eps cond, twice what a value within its rounding allows; cond = sum|c||x|^k/|p'|
 *   radii                   each disc holds a zero, and each zero is in one
 *   refusals                sizes, too many coefficients, NaN, infinity, the zero polynomial
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "csv.h"
#include "num/polynomial.h"
#include "random_matrix.h"
#include "unity.h"

#define EPS ((double)REAL_EPSILON)

static struct polynomial_matrix m, adj, product;
static struct polynomial_minors work;
static struct polynomial p, q, det;
static struct polynomial_roots roots;

void setUp(void) {}
void tearDown(void) {}

static void set(struct polynomial *to, unsigned n, const double *c)
{
    real_t r[POLYNOMIAL_MOST];
    for (unsigned k = 0; k < n; k++)
        r[k] = (real_t)c[k];
    polynomial_set(to, r, n);
}
#define SET(to, ...)                                                                               \
    set(to, sizeof((double[]){__VA_ARGS__}) / sizeof(double), (double[]){__VA_ARGS__})

static void draw_matrix(struct random_source *r, unsigned n, unsigned coefficients)
{
    m.rows = m.cols = (uint8_t)n;
    for (unsigned i = 0; i < n; i++)
        for (unsigned j = 0; j < n; j++) {
            m.value[i][j].n = (uint8_t)coefficients;
            for (unsigned k = 0; k < coefficients; k++)
                m.value[i][j].value[k] = (real_t)random_fraction(r);
        }
}

/* ---- products ---- */

static void a_product_is_added_with_its_scale(void)
{
    static const double wanted[] = {3, 7, 11, 14, -12};
    struct polynomial a, b;
    SET(&p, 1, 1, 1);
    SET(&a, 1, 2, 3);
    SET(&b, 1, 1, -2);
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_add_product(&p, (real_t)2, &a, &b));
    TEST_ASSERT_EQUAL_UINT8(5, p.n);
    static const double plain[] = {1, 3, 3, -1, -6};
    for (unsigned k = 0; k < 5; k++)
        TEST_ASSERT_TRUE((double)p.value[k] == 2 * plain[k] + (k < 3 ? 1 : 0));
    TEST_ASSERT_TRUE(wanted[0] == (double)p.value[0]);
    TEST_ASSERT_TRUE(wanted[4] == (double)p.value[4]);
}

static void more_coefficients_than_there_is_room_for_are_refused(void)
{
    p.n = 0;
    q.n = det.n = 17;
    memset(q.value, 0, sizeof q.value);
    memset(det.value, 0, sizeof det.value);
    TEST_ASSERT_EQUAL(ERR_FULL, polynomial_add_product(&p, (real_t)1, &q, &det));
    q.n = 16;
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_add_product(&p, (real_t)1, &q, &det));
    TEST_ASSERT_EQUAL_UINT8(POLYNOMIAL_MOST, p.n);
    q.n = 0;
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_add_product(&p, (real_t)1, &q, &det));
}

static void delay_degree_and_value_are_read_off(void)
{
    SET(&p, 0, 0, 2, -3, 0);
    TEST_ASSERT_EQUAL_UINT(2, polynomial_delay(&p));
    TEST_ASSERT_TRUE((double)polynomial_value(&p, (real_t)2) == 2 * 4 - 3 * 8);
    TEST_ASSERT_TRUE((double)polynomial_size(&p) == 5);
    polynomial_trim(&p);
    polynomial_advance(&p, 2);
    TEST_ASSERT_EQUAL_UINT8(2, p.n);
    TEST_ASSERT_TRUE((double)p.value[0] == 2 && (double)p.value[1] == -3);
    polynomial_advance(&p, 9);
    TEST_ASSERT_EQUAL_UINT8(0, p.n);
    TEST_ASSERT_TRUE((double)polynomial_value(&p, (real_t)2) == 0);
}

static void matrices_whose_sizes_do_not_fit_have_no_product(void)
{
    struct random_source r = {3};
    draw_matrix(&r, 3, 2);
    adj = m;
    adj.rows = 2;
    TEST_ASSERT_EQUAL(ERR_RANGE, polynomial_matrix_multiply(&m, &adj, &product));
    TEST_ASSERT_EQUAL(ERR_RANGE, polynomial_determinant(&adj, &work, &det));
    TEST_ASSERT_EQUAL(ERR_RANGE, polynomial_adjugate(&adj, &work, &product));
}

/* ---- determinant and adjugate ---- */

/* Coefficient k of the determinant and of the sum of its terms' magnitudes, over all permutations. */
static void leibniz(long double value[POLYNOMIAL_MOST], long double size[POLYNOMIAL_MOST])
{
    unsigned n = m.rows, count = n == 1 ? 1 : n == 2 ? 4 : n == 3 ? 27 : 256;
    for (unsigned k = 0; k < POLYNOMIAL_MOST; k++)
        value[k] = size[k] = 0;
    for (unsigned code = 0; code < count; code++) {
        unsigned column[4], left = code, used = 0;
        for (unsigned i = 0; i < n; i++, left /= n)
            used |= 1u << (column[i] = left % n);
        if (used != (1u << n) - 1)
            continue;
        double sign = 1;
        for (unsigned i = 0; i < n; i++)
            for (unsigned j = i + 1; j < n; j++)
                if (column[i] > column[j])
                    sign = -sign;
        long double term[POLYNOMIAL_MOST] = {sign}, magnitude[POLYNOMIAL_MOST] = {1};
        unsigned length = 1;
        for (unsigned i = 0; i < n; i++) {
            const struct polynomial *f = &m.value[i][column[i]];
            long double next[POLYNOMIAL_MOST] = {0}, next_size[POLYNOMIAL_MOST] = {0};
            for (unsigned a = 0; a < length; a++)
                for (unsigned b = 0; b < f->n; b++) {
                    next[a + b] += term[a] * (long double)f->value[b];
                    next_size[a + b] += magnitude[a] * fabsl((long double)f->value[b]);
                }
            length += f->n - 1u;
            memcpy(term, next, sizeof term);
            memcpy(magnitude, next_size, sizeof magnitude);
        }
        for (unsigned k = 0; k < length; k++) {
            value[k] += term[k];
            size[k] += magnitude[k];
        }
    }
}

static void a_determinant_is_the_sum_over_all_permutations(void)
{
    struct random_source r = {17};
    long double value[POLYNOMIAL_MOST], size[POLYNOMIAL_MOST];
    double worst = 0;
    for (unsigned n = 1; n <= 4; n++)
        for (unsigned draw = 0; draw < 200; draw++) {
            draw_matrix(&r, n, 1 + random_below(&r, 8));
            TEST_ASSERT_EQUAL(ERR_OK, polynomial_determinant(&m, &work, &det));
            leibniz(value, size);
            for (unsigned k = 0; k < POLYNOMIAL_MOST; k++) {
                long double got = k < det.n ? (long double)det.value[k] : 0;
                TEST_ASSERT_TRUE(fabsl(got - value[k]) <= 32 * (long double)EPS * size[k]);
                if (size[k] > 0)
                    worst = fmax(worst, (double)(fabsl(got - value[k]) / size[k]) / EPS);
            }
        }
    printf("determinant: %.2g eps of its terms\n", worst);
}

static void an_adjugate_times_the_matrix_is_the_determinant(void)
{
    struct random_source r = {18};
    long double value[POLYNOMIAL_MOST], size[POLYNOMIAL_MOST];
    for (unsigned n = 1; n <= 4; n++)
        for (unsigned draw = 0; draw < 200; draw++) {
            draw_matrix(&r, n, 1 + random_below(&r, 8));
            TEST_ASSERT_EQUAL(ERR_OK, polynomial_adjugate(&m, &work, &adj));
            TEST_ASSERT_EQUAL(ERR_OK, polynomial_matrix_multiply(&adj, &m, &product));
            TEST_ASSERT_EQUAL(ERR_OK, polynomial_determinant(&m, &work, &det));
            leibniz(value, size);
            long double most = 0;
            for (unsigned k = 0; k < POLYNOMIAL_MOST; k++)
                most = size[k] > most ? size[k] : most;
            for (unsigned i = 0; i < n; i++)
                for (unsigned j = 0; j < n; j++)
                    for (unsigned k = 0; k < product.value[i][j].n; k++) {
                        long double wanted = i == j && k < det.n ? (long double)det.value[k] : 0;
                        /* Off the diagonal stand other terms than the determinant's, of elements of up to 1 as well. */
                        TEST_ASSERT_TRUE(fabsl((long double)product.value[i][j].value[k] -
                                               wanted) <= 64 * (long double)EPS * (most + 24 * 8));
                    }
        }
}

static void what_cancels_is_no_coefficient(void)
{
    m.rows = m.cols = 2;
    SET(&m.value[0][0], 0.1, 0.3);
    SET(&m.value[0][1], 0.2, 0.7);
    SET(&m.value[1][0], 0.3, 0.9);
    SET(&m.value[1][1], 0.6, 2.1);
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_determinant(&m, &work, &det));
    TEST_ASSERT_EQUAL_UINT8(0, det.n);
}

static void what_lies_outside_the_size_is_not_read(void)
{
    struct random_source r = {20};
    draw_matrix(&r, 4, 31);
    for (unsigned i = 0; i < 3; i++)
        for (unsigned j = 0; j < 3; j++)
            m.value[i][j].n = 3;
    m.rows = m.cols = 3;
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_determinant(&m, &work, &det));
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_adjugate(&m, &work, &adj));
    TEST_ASSERT_EQUAL_UINT8(7, det.n);
}

static void a_matrix_with_what_is_no_number_has_no_determinant(void)
{
    struct random_source r = {19};
    draw_matrix(&r, 4, 8);
    m.value[3][2].value[7] = (real_t)NAN;
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, polynomial_determinant(&m, &work, &det));
    m.value[3][2].value[7] = (real_t)INFINITY;
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, polynomial_adjugate(&m, &work, &adj));
    draw_matrix(&r, 4, 9);
    TEST_ASSERT_EQUAL(ERR_FULL, polynomial_determinant(&m, &work, &det));
}

/* ---- zeros ---- */

static double condition(unsigned n, const double *c, double re, double im)
{
    double size = 0, r = hypot(re, im), sre = 0, sim = 0;
    for (unsigned k = n + 1; k-- > 1;) {
        double next = sre * re - sim * im + k * c[k];
        sim = sre * im + sim * re;
        sre = next;
    }
    for (unsigned k = n + 1; k-- > 0;)
        size = size * r + fabs(c[k]);
    return size / hypot(sre, sim);
}

static void zeros_are_those_of_240_bits_and_their_radii_hold(void)
{
    FILE *f = csv_open("reference/polynomial_roots.csv");
    double v[2 + 32 + 62];
    unsigned rows = 0, most_sweeps = 0;
    while (csv_row(f, v, 2 + 32 + 62)) {
        unsigned kind = (unsigned)v[0], n = (unsigned)v[1];
        const double *c = v + 2, *zero = v + 34;
        char what[64];
        snprintf(what, sizeof what, "row %u, kind %u, degree %u", rows, kind, n);
        set(&p, n + 1, c);
        TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, polynomial_find_roots(&p, &roots), what);
        TEST_ASSERT_EQUAL_UINT8_MESSAGE(n, roots.n, what);
        most_sweeps = roots.sweeps > most_sweeps ? roots.sweeps : most_sweeps;
        for (unsigned k = 0; k < n; k++) {
            double nearest = INFINITY, own = INFINITY;
            bool held = false;
            for (unsigned j = 0; j < n; j++) {
                double away = hypot((double)roots.value[j].re - zero[2 * k],
                                    (double)roots.value[j].im - zero[2 * k + 1]);
                nearest = fmin(nearest, away);
                held = held || away <= (double)roots.radius[j];
                own = fmin(own, hypot((double)roots.value[k].re - zero[2 * j],
                                      (double)roots.value[k].im - zero[2 * j + 1]));
            }
            TEST_ASSERT_TRUE_MESSAGE(held, what);
            TEST_ASSERT_TRUE_MESSAGE(own <= (double)roots.radius[k], what);
            if (kind != 2)
                TEST_ASSERT_TRUE_MESSAGE(nearest <=
                                             2.0 * n * (4 * n + 1) * EPS *
                                                 condition(n, c, zero[2 * k], zero[2 * k + 1]),
                                         what);
        }
        rows++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL_UINT(148, rows);
    printf("zeros: at most %u sweeps\n", most_sweeps);
}

static void zeros_at_0_come_last_and_exactly(void)
{
    SET(&p, 0, 0, -1, 2, 0);
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_find_roots(&p, &roots));
    TEST_ASSERT_EQUAL_UINT8(3, roots.n);
    TEST_ASSERT_DOUBLE_WITHIN(4 * EPS, 0.5, (double)roots.value[0].re);
    TEST_ASSERT_TRUE((double)roots.value[1].re == 0 && (double)roots.radius[2] == 0);
}

static void a_constant_has_none_and_nothing_has_no_answer(void)
{
    SET(&p, 3);
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_find_roots(&p, &roots));
    TEST_ASSERT_EQUAL_UINT8(0, roots.n);
    SET(&p, 0, 0);
    TEST_ASSERT_EQUAL(ERR_RANGE, polynomial_find_roots(&p, &roots));
    SET(&p, 1, NAN);
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, polynomial_find_roots(&p, &roots));
    p.n = POLYNOMIAL_MOST + 1;
    TEST_ASSERT_EQUAL(ERR_RANGE, polynomial_find_roots(&p, &roots));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_product_is_added_with_its_scale);
    RUN_TEST(more_coefficients_than_there_is_room_for_are_refused);
    RUN_TEST(delay_degree_and_value_are_read_off);
    RUN_TEST(matrices_whose_sizes_do_not_fit_have_no_product);
    RUN_TEST(a_determinant_is_the_sum_over_all_permutations);
    RUN_TEST(an_adjugate_times_the_matrix_is_the_determinant);
    RUN_TEST(what_cancels_is_no_coefficient);
    RUN_TEST(what_lies_outside_the_size_is_not_read);
    RUN_TEST(a_matrix_with_what_is_no_number_has_no_determinant);
    RUN_TEST(zeros_are_those_of_240_bits_and_their_radii_hold);
    RUN_TEST(zeros_at_0_come_last_and_exactly);
    RUN_TEST(a_constant_has_none_and_nothing_has_no_answer);
    return UNITY_END();
}
