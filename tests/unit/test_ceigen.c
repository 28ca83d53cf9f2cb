/* num/ceigen.[ch]; built in float and in double. eps is REAL_EPSILON.
 *
 * Contract, against numpy on 200 matrices to 16 x 16, a third of them with rows from 1 up to 2^15:
 *   eigenvalue   within 16 n eps |A| cond, |A| the Frobenius norm and cond the eigenvalue's condition number
 */
#include <math.h>
#include <stdio.h>

#include "csv.h"
#include "num/ceigen.h"
#include "random_matrix.h"
#include "unity.h"

#define EPS     ((double)REAL_EPSILON)
#define NUMBERS 50

static struct cmatrix a;
static struct cplx values[MATRIX_MAX];

void setUp(void) {}
void tearDown(void) {}

/* complex_matrix() of tests/reference/ina_reference.py; returns the Frobenius norm. */
static double complex_matrix(uint64_t seed)
{
    static double re[16][16], im[16][16];
    struct random_source r = {seed};
    a.rows = a.cols = (uint8_t)(1 + random_below(&r, 16));
    double norm = 0.0;
    for (unsigned i = 0; i < a.rows; i++)
        for (unsigned j = 0; j < a.cols; j++) {
            double times = seed % 3 == 0 ? ldexp(1.0, (int)i) : 1.0;
            re[i][j] = random_fraction(&r) * times;
            im[i][j] = random_fraction(&r) * times;
        }
    for (unsigned i = 0; i < a.rows; i++)
        for (unsigned j = 0; j < a.cols; j++) {
            bool hermitian = seed % 4 == 0;
            double x = hermitian ? 0.5 * (re[i][j] + re[j][i]) : re[i][j];
            double y = hermitian ? 0.5 * (im[i][j] - im[j][i]) : im[i][j];
            a.value[i][j] = cplx((real_t)x, (real_t)y);
            norm += x * x + y * y;
        }
    return sqrt(norm);
}

static void eigenvalues_of_random_matrices_are_those_of_numpy(void)
{
    FILE *f = csv_open("reference/ceigen.csv");
    double v[NUMBERS], worst = 0.0;
    unsigned seen = 0;
    while (csv_row(f, v, NUMBERS)) {
        double norm = complex_matrix((uint64_t)v[0]);
        unsigned n = a.rows;
        TEST_ASSERT_EQUAL_UINT((unsigned)v[1], n);
        TEST_ASSERT_EQUAL_INT(ERR_OK, ceigen_values(&a, values));
        bool used[16] = {false};
        for (unsigned i = 0; i < n; i++) {
            const double *want = v + 2 + 3 * i;
            unsigned nearest = 0;
            double best = INFINITY;
            for (unsigned j = 0; j < n; j++) {
                double apart =
                    hypot((double)values[j].re - want[0], (double)values[j].im - want[1]);
                if (!used[j] && apart < best) {
                    best = apart;
                    nearest = j;
                }
            }
            used[nearest] = true;
            worst = fmax(worst, best / (n * norm * want[2]));
        }
        seen++;
    }
    fclose(f);
    printf("eigenvalues: worst %.2f n eps |A| cond\n", worst / EPS);
    TEST_ASSERT_EQUAL_UINT(200, seen);
    TEST_ASSERT_TRUE(worst <= 16 * EPS);
}

static void begin_square(uint8_t n)
{
    a.rows = a.cols = n;
    for (unsigned i = 0; i < n; i++)
        for (unsigned j = 0; j < n; j++)
            a.value[i][j] = cplx(0, 0);
}

static void eigenvalues_of_zero_are_zero(void)
{
    begin_square(4);
    TEST_ASSERT_EQUAL_INT(ERR_OK, ceigen_values(&a, values));
    for (unsigned i = 0; i < 4; i++)
        TEST_ASSERT_TRUE(fabs((double)values[i].re) + fabs((double)values[i].im) <= 0.0);
}

/* Every shift that looks at the last corner alone is 0 here, and a round with it gives the matrix back. */
static void a_cycle_of_units_does_not_go_round_for_ever(void)
{
    for (uint8_t n = 2; n <= 16; n++) {
        begin_square(n);
        for (unsigned i = 0; i < n; i++)
            a.value[(i + 1) % n][i] = cplx(1, 0);
        TEST_ASSERT_EQUAL_INT(ERR_OK, ceigen_values(&a, values));
        for (unsigned i = 0; i < n; i++)
            TEST_ASSERT_DOUBLE_WITHIN(16 * n * n * EPS, 1.0,
                                      hypot((double)values[i].re, (double)values[i].im));
    }
}

static void eigenvalues_of_a_jordan_block_are_near_the_one_it_has(void)
{
    begin_square(3);
    for (unsigned i = 0; i < 3; i++) {
        a.value[i][i] = cplx(2, 1);
        if (i < 2)
            a.value[i + 1][i] = cplx(1, 0);
    }
    TEST_ASSERT_EQUAL_INT(ERR_OK, ceigen_values(&a, values));
    for (unsigned i = 0; i < 3; i++) /* the cube root of the error */
        TEST_ASSERT_DOUBLE_WITHIN(cbrt(16 * 3 * 5 * EPS), 0.0,
                                  hypot((double)values[i].re - 2.0, (double)values[i].im - 1.0));
}

static void sizes_far_from_1_neither_overflow_nor_vanish(void)
{
    static const double sizes[] = {1e-14, 1e14};
    for (unsigned k = 0; k < 2; k++) {
        begin_square(2);
        a.value[0][1] = cplx((real_t)sizes[k], 0);
        a.value[1][0] = cplx((real_t)(4 * sizes[k]), 0);
        TEST_ASSERT_EQUAL_INT(ERR_OK, ceigen_values(&a, values));
        for (unsigned i = 0; i < 2; i++)
            TEST_ASSERT_DOUBLE_WITHIN(32 * EPS * 4 * sizes[k], 2 * sizes[k],
                                      fabs((double)values[i].re));
    }
}

static void what_is_not_square_or_no_number_is_refused(void)
{
    begin_square(3);
    a.cols = 2;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, ceigen_values(&a, values));
    begin_square(3);
    a.value[2][1] = cplx((real_t)NAN, 0);
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, ceigen_values(&a, values));
}

static void values_follow_those_of_the_point_before(void)
{
    const struct cplx before[3] = {{0, 0}, {1, 1}, {5, 0}};
    struct cplx now[3] = {{4, 0}, {(real_t)0.25, 0}, {1, 2}};
    ceigen_follow(before, now, 3);
    TEST_ASSERT_EQUAL_DOUBLE(0.25, (double)now[0].re);
    TEST_ASSERT_EQUAL_DOUBLE(2, (double)now[1].im);
    TEST_ASSERT_EQUAL_DOUBLE(4, (double)now[2].re);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(eigenvalues_of_random_matrices_are_those_of_numpy);
    RUN_TEST(eigenvalues_of_zero_are_zero);
    RUN_TEST(a_cycle_of_units_does_not_go_round_for_ever);
    RUN_TEST(eigenvalues_of_a_jordan_block_are_near_the_one_it_has);
    RUN_TEST(sizes_far_from_1_neither_overflow_nor_vanish);
    RUN_TEST(what_is_not_square_or_no_number_is_refused);
    RUN_TEST(values_follow_those_of_the_point_before);
    return UNITY_END();
}
