/* num/matrix.[ch], num/cmatrix.[ch], num/svd.[ch]; built in float and in double.
 * kappa is the condition number, eps REAL_EPSILON.
 *
 * Contract (300 random matrices up to 16 x 16 against numpy: uniform, graded over 2^15, rank deficient)
 *   inverse, pseudo-inverse     |A X A - A| <= 8 eps kappa |A| (16 by SVD); X A X and symmetry of A X, X A too
 *   determinant                 sign exact while kappa < 0.02/eps; logarithm within 16 n eps (1 + kappa)
 *   singular values             within 20 eps of the largest
 *   U and V                     orthogonal to 20 eps; U S V' = A to 20 eps |A|
 *   rank                        exact where the gap is not in the rounding
 *   refusals                    size, NaN, infinity, singular
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "csv.h"
#include "num/cmatrix.h"
#include "num/svd.h"
#include "random_matrix.h"
#include "unity.h"

#define EPS ((double)REAL_EPSILON)

static struct matrix a, x, y, z;
static struct svd svd;
static struct lu lu;
static struct pseudo_inverse_work work;
static struct cmatrix ca, cx;
static struct clu clu;
static struct cpseudo_inverse_work cwork;

void setUp(void) {}
void tearDown(void) {}

static double largest(const struct matrix *m)
{
    double most = 0.0;
    for (unsigned i = 0; i < m->rows; i++)
        for (unsigned j = 0; j < m->cols; j++)
            most = fmax(most, fabs((double)m->value[i][j]));
    return most;
}

static double difference(const struct matrix *m, const struct matrix *n)
{
    double most = 0.0;
    TEST_ASSERT_EQUAL_UINT8(m->rows, n->rows);
    TEST_ASSERT_EQUAL_UINT8(m->cols, n->cols);
    for (unsigned i = 0; i < m->rows; i++)
        for (unsigned j = 0; j < m->cols; j++)
            most = fmax(most, fabs((double)m->value[i][j] - (double)n->value[i][j]));
    return most;
}

/* Largest departure of the columns of m from orthogonal ones of length 1. */
static double unorthogonal(const struct matrix *m)
{
    double most = 0.0;
    for (unsigned k = 0; k < m->cols; k++)
        for (unsigned l = 0; l < m->cols; l++) {
            double sum = k == l ? -1.0 : 0.0;
            for (unsigned i = 0; i < m->rows; i++)
                sum += (double)m->value[i][k] * (double)m->value[i][l];
            most = fmax(most, fabs(sum));
        }
    return most;
}

struct reference {
    uint64_t seed;
    unsigned rows, cols, kind, count, rank;
    double sign, log_det, s[MATRIX_MAX], kappa;
};

static int next(FILE *f, struct reference *r)
{
    double v[22];
    if (!csv_row(f, v, 22))
        return 0;
    *r = (struct reference){
        (uint64_t)v[0], (unsigned)v[1], (unsigned)v[2], (unsigned)v[3], 0, 0, v[4], v[5], {0},
        INFINITY};
    r->count = r->rows < r->cols ? r->rows : r->cols;
    for (unsigned k = 0; k < MATRIX_MAX; k++) {
        r->s[k] = v[6 + k];
        r->rank += r->s[k] > 0.0;
    }
    if (r->rank == r->count)
        r->kappa = r->s[0] / r->s[r->count - 1];
    TEST_ASSERT_EQUAL_UINT(r->kind, random_matrix(r->seed, &a));
    TEST_ASSERT_EQUAL_UINT(r->rows, a.rows);
    TEST_ASSERT_EQUAL_UINT(r->cols, a.cols);
    return 1;
}

static void singular_values_of_random_matrices_are_those_of_numpy(void)
{
    FILE *f = csv_open("reference/algebra.csv");
    struct reference r;
    double worst = 0.0, worst_u = 0.0, worst_a = 0.0;
    unsigned rows = 0, sweeps = 0;
    while (next(f, &r)) {
        TEST_ASSERT_EQUAL_INT(ERR_OK, svd_decompose(&svd, &a));
        sweeps = svd.sweeps > sweeps ? svd.sweeps : sweeps;
        double scale = r.s[0] > 0.0 ? r.s[0] : 1.0;
        for (unsigned k = 0; k < r.count; k++)
            worst = fmax(worst, fabs(r.s[k] - (double)svd.s[k]) / scale);
        worst_u = fmax(worst_u, fmax(unorthogonal(&svd.u), unorthogonal(&svd.v)));
        TEST_ASSERT_EQUAL_UINT8(a.rows, svd.u.rows);
        TEST_ASSERT_EQUAL_UINT8(a.cols, svd.v.rows);
        for (unsigned i = 0; i < a.rows; i++)
            for (unsigned j = 0; j < a.cols; j++) {
                double sum = -(double)a.value[i][j];
                for (unsigned k = 0; k < r.count; k++)
                    sum += (double)svd.u.value[i][k] * (double)svd.s[k] * (double)svd.v.value[j][k];
                worst_a = fmax(worst_a, fabs(sum) / scale);
            }
        rows++;
    }
    fclose(f);
    printf("svd: worst %.1f eps (values), %.1f (orthogonality), %.1f (product), %u sweeps\n",
           worst / EPS, worst_u / EPS, worst_a / EPS, sweeps);
    TEST_ASSERT_EQUAL_UINT(300, rows);
    TEST_ASSERT_TRUE(worst <= 20 * EPS);
    TEST_ASSERT_TRUE(worst_u <= 20 * EPS);
    TEST_ASSERT_TRUE(worst_a <= 20 * EPS);
}

static void ranks_of_products_of_whole_numbers_are_found(void)
{
    FILE *f = csv_open("reference/algebra.csv");
    struct reference r;
    unsigned seen = 0;
    while (next(f, &r)) {
        if (r.kind != 2 || r.rank == 0 || r.s[r.rank - 1] < 200 * EPS * r.s[0])
            continue;
        TEST_ASSERT_EQUAL_INT(ERR_OK, svd_decompose(&svd, &a));
        TEST_ASSERT_EQUAL_UINT(r.rank, svd_rank(&svd, 0));
        TEST_ASSERT_EQUAL_INT(r.rank < r.count, isinf((double)svd_condition(&svd)));
        for (unsigned k = r.rank; k < a.cols; k++) /* the null space of A */
            for (unsigned i = 0; i < a.rows; i++) {
                double sum = 0.0;
                for (unsigned j = 0; j < a.cols; j++)
                    sum += (double)a.value[i][j] * (double)svd.v.value[j][k];
                TEST_ASSERT_DOUBLE_WITHIN(40 * EPS * r.s[0], 0.0, sum);
            }
        for (unsigned k = r.rank; k < a.rows; k++) /* and of its transpose */
            for (unsigned j = 0; j < a.cols; j++) {
                double sum = 0.0;
                for (unsigned i = 0; i < a.rows; i++)
                    sum += (double)a.value[i][j] * (double)svd.u.value[i][k];
                TEST_ASSERT_DOUBLE_WITHIN(40 * EPS * r.s[0], 0.0, sum);
            }
        seen++;
    }
    fclose(f);
    TEST_ASSERT_GREATER_THAN_UINT(40, seen);
}

/* Penrose's four conditions; kappa in place of the matrix's own scale. */
static double penrose(double kappa)
{
    double scale = largest(&a) * largest(&x), worst;
    TEST_ASSERT_EQUAL_INT(ERR_OK, matrix_multiply(&a, &x, &y));
    double asymmetry = 0.0;
    for (unsigned i = 0; i < y.rows; i++)
        for (unsigned j = 0; j < y.rows; j++)
            asymmetry = fmax(asymmetry, fabs((double)y.value[i][j] - (double)y.value[j][i]));
    TEST_ASSERT_EQUAL_INT(ERR_OK, matrix_multiply(&y, &a, &z));
    worst = difference(&z, &a) / largest(&a);
    TEST_ASSERT_EQUAL_INT(ERR_OK, matrix_multiply(&x, &a, &y));
    for (unsigned i = 0; i < y.rows; i++)
        for (unsigned j = 0; j < y.rows; j++)
            asymmetry = fmax(asymmetry, fabs((double)y.value[i][j] - (double)y.value[j][i]));
    TEST_ASSERT_EQUAL_INT(ERR_OK, matrix_multiply(&y, &x, &z));
    worst = fmax(worst, difference(&z, &x) / largest(&x));
    (void)scale;
    return fmax(worst, asymmetry) / kappa;
}

static void inverses_satisfy_penrose_within_the_condition_number(void)
{
    FILE *f = csv_open("reference/algebra.csv");
    struct reference r;
    double worst = 0.0, worst_svd = 0.0;
    unsigned seen = 0;
    while (next(f, &r)) {
        if (r.kind == 2 || r.kappa > 0.02 / EPS)
            continue;
        TEST_ASSERT_EQUAL_INT(ERR_OK, matrix_pseudo_inverse(&a, &work, &x));
        worst = fmax(worst, penrose(r.kappa));
        TEST_ASSERT_EQUAL_INT(ERR_OK, svd_decompose(&svd, &a));
        TEST_ASSERT_EQUAL_INT(ERR_OK, svd_pseudo_inverse(&svd, r.count, &x));
        worst_svd = fmax(worst_svd, penrose(r.kappa));
        seen++;
    }
    fclose(f);
    printf("pseudo-inverse: worst %.2f eps kappa (elimination), %.2f (svd), %u matrices\n",
           worst / EPS, worst_svd / EPS, seen);
    TEST_ASSERT_GREATER_THAN_UINT(120, seen);
    TEST_ASSERT_TRUE(worst <= 8 * EPS);
    TEST_ASSERT_TRUE(worst_svd <= 16 * EPS);
}

static void determinants_have_the_sign_and_size_of_numpy(void)
{
    FILE *f = csv_open("reference/algebra.csv");
    struct reference r;
    unsigned seen = 0;
    while (next(f, &r)) {
        if (r.sign == 0.0 || r.kappa > 0.02 / EPS)
            continue;
        int sign;
        real_t log_magnitude;
        TEST_ASSERT_EQUAL_INT(ERR_OK, lu_factor(&a, &lu));
        lu_determinant(&lu, &sign, &log_magnitude);
        TEST_ASSERT_EQUAL_INT((int)r.sign, sign);
        TEST_ASSERT_DOUBLE_WITHIN(16 * EPS * r.rows * (1 + r.kappa), r.log_det,
                                  (double)log_magnitude);
        seen++;
    }
    fclose(f);
    TEST_ASSERT_GREATER_THAN_UINT(8, seen);
}

static void a_solution_may_replace_its_right_hand_side(void)
{
    a = (struct matrix){3, 3, {{0, 2, 1}, {4, 0, 0}, {1, 1, 8}}};
    real_t b[3] = {7, 4, 27}; /* of x = 1, 2, 3 */
    TEST_ASSERT_EQUAL_INT(ERR_OK, lu_factor(&a, &lu));
    lu_solve(&lu, b, b);
    for (int k = 0; k < 3; k++)
        TEST_ASSERT_DOUBLE_WITHIN(8 * EPS, k + 1.0, (double)b[k]);
}

static void equilibrated_rows_and_columns_have_about_length_one(void)
{
    for (uint64_t seed = 1; seed <= 40; seed++) {
        real_t r[MATRIX_MAX], c[MATRIX_MAX];
        if (random_matrix(seed, &a) == 2)
            continue;
        matrix_equilibrate(&a, true, r, c);
        double along = sqrt((double)a.rows / a.cols); /* of a row where columns have length 1 */
        for (unsigned i = 0; i < a.rows; i++) {
            double sum = 0.0;
            for (unsigned j = 0; j < a.cols; j++)
                sum += pow((double)a.value[i][j] * (double)r[i] * (double)c[j], 2);
            TEST_ASSERT_DOUBLE_WITHIN(0.1 / along, 1.0 / along, sqrt(sum));
        }
        matrix_equilibrate(&a, false, r, c);
        for (unsigned i = 0; i < a.rows; i++) {
            int exponent;
            TEST_ASSERT_TRUE(frexp((double)r[i], &exponent) == 0.5);
        }
    }
}

/* A complex matrix is a real one of twice the size; here the Penrose conditions and det of a triangular product do. */
static void complex_inverses_satisfy_penrose(void)
{
    double worst = 0.0;
    for (uint64_t seed = 1; seed <= 60; seed++) {
        struct random_source r = {seed};
        ca.rows = (uint8_t)(1 + random_below(&r, MATRIX_MAX));
        ca.cols = (uint8_t)(1 + random_below(&r, MATRIX_MAX));
        if (ca.rows ==
            ca.cols) /* uniform square ones may be ill conditioned: their bound is another test's */
            ca.cols = (uint8_t)(ca.rows % MATRIX_MAX + 1);
        unsigned n = ca.rows < ca.cols ? ca.rows : ca.cols;
        for (unsigned i = 0; i < ca.rows; i++)
            for (unsigned j = 0; j < ca.cols; j++) /* a strong diagonal: kappa stays below 20 */
                ca.value[i][j] = cplx((real_t)(random_fraction(&r) + (i == j ? 12.0 : 0.0)),
                                      (real_t)random_fraction(&r));
        TEST_ASSERT_EQUAL_INT(ERR_OK, cmatrix_pseudo_inverse(&ca, &cwork, &cx));
        for (unsigned i = 0; i < n; i++) /* the short way round the product is I */
            for (unsigned j = 0; j < n; j++) {
                struct cplx sum = cplx(i == j ? -1 : 0, 0);
                for (unsigned k = 0; k < (ca.rows < ca.cols ? ca.cols : ca.rows); k++)
                    sum =
                        cplx_add(sum, ca.rows < ca.cols ? cplx_mul(ca.value[i][k], cx.value[k][j])
                                                        : cplx_mul(cx.value[i][k], ca.value[k][j]));
                worst = fmax(worst, (double)cplx_abs(sum));
            }
        for (unsigned i = 0; i < (ca.rows < ca.cols ? ca.cols : ca.rows);
             i++) /* the other is Hermitian */
            for (unsigned j = 0; j < i; j++) {
                struct cplx one = cplx(0, 0), other = cplx(0, 0);
                for (unsigned k = 0; k < n; k++) {
                    one =
                        cplx_add(one, ca.rows < ca.cols ? cplx_mul(cx.value[i][k], ca.value[k][j])
                                                        : cplx_mul(ca.value[i][k], cx.value[k][j]));
                    other = cplx_add(other, ca.rows < ca.cols
                                                ? cplx_mul(cx.value[j][k], ca.value[k][i])
                                                : cplx_mul(ca.value[j][k], cx.value[k][i]));
                }
                worst = fmax(worst, (double)cplx_abs(cplx_sub(one, cplx_conj(other))));
            }
    }
    printf("complex pseudo-inverse: worst %.1f eps\n", worst / EPS);
    TEST_ASSERT_TRUE(worst <= 40 * EPS);
}

static void complex_elimination_solves_and_its_determinant_is_that_of_the_real_form(void)
{
    for (uint64_t seed = 1; seed <= 60; seed++) {
        struct random_source r = {seed};
        unsigned n = 1 + random_below(&r, MATRIX_MAX / 2);
        ca.rows = ca.cols = (uint8_t)n;
        a.rows = a.cols = (uint8_t)(2 * n);
        struct cplx b[MATRIX_MAX], solution[MATRIX_MAX];
        for (unsigned i = 0; i < n; i++) {
            for (unsigned j = 0; j < n; j++) {
                ca.value[i][j] = cplx((real_t)random_fraction(&r), (real_t)random_fraction(&r));
                if (i == j)
                    ca.value[i][j].re += (real_t)(n);
                a.value[i][j] = a.value[n + i][n + j] = ca.value[i][j].re;
                a.value[n + i][j] = ca.value[i][j].im;
                a.value[i][n + j] = -ca.value[i][j].im;
            }
            b[i] = cplx((real_t)random_fraction(&r), (real_t)random_fraction(&r));
        }
        struct cplx direction;
        real_t log_magnitude, real_log_magnitude;
        int sign;
        TEST_ASSERT_EQUAL_INT(ERR_OK, clu_factor(&ca, &clu));
        TEST_ASSERT_EQUAL_INT(ERR_OK, lu_factor(&a, &lu));
        clu_determinant(&clu, &direction, &log_magnitude);
        lu_determinant(&lu, &sign, &real_log_magnitude);
        TEST_ASSERT_EQUAL_INT(1, sign); /* det of the real form is |det|^2 */
        TEST_ASSERT_DOUBLE_WITHIN(400 * EPS, (double)real_log_magnitude,
                                  2.0 * (double)log_magnitude);
        TEST_ASSERT_DOUBLE_WITHIN(8 * EPS, 1.0, (double)cplx_abs(direction));
        clu_solve(&clu, b, solution);
        for (unsigned i = 0; i < n; i++) {
            struct cplx sum = b[i];
            for (unsigned j = 0; j < n; j++)
                sum = cplx_sub(sum, cplx_mul(ca.value[i][j], solution[j]));
            TEST_ASSERT_DOUBLE_WITHIN(40 * EPS, 0.0, (double)cplx_abs(sum));
        }
    }
}

/* Rows in an order that asks for exchanges. */
static void a_complex_matrix_is_inverted_in_its_place_and_so_is_its_diagonal(void)
{
    for (uint64_t seed = 1; seed <= 60; seed++) {
        struct random_source r = {seed};
        unsigned n = 1 + random_below(&r, MATRIX_MAX);
        ca.rows = ca.cols = (uint8_t)n;
        for (unsigned i = 0; i < n; i++)
            for (unsigned j = 0; j < n; j++) {
                ca.value[i][j] = cplx((real_t)random_fraction(&r), (real_t)random_fraction(&r));
                if (j == (i * 5 + 3) % n && (n % 5 != 0))
                    ca.value[i][j].im += (real_t)(2 * n);
                else if (n % 5 == 0 && i == j)
                    ca.value[i][j].re += (real_t)(2 * n);
            }
        cx = ca;
        struct cplx diagonal[MATRIX_MAX];
        TEST_ASSERT_EQUAL_INT(ERR_OK, cmatrix_invert_own(cx.value, (uint8_t)n));
        memcpy(clu.value, ca.value, sizeof clu.value);
        TEST_ASSERT_EQUAL_INT(ERR_OK, clu_factor_own(&clu, (uint8_t)n));
        clu_inverse_diagonal(&clu, diagonal);
        for (unsigned i = 0; i < n; i++) {
            for (unsigned j = 0; j < n; j++) {
                struct cplx sum = cplx(i == j ? REAL_C(-1.0) : REAL_C(0.0), REAL_C(0.0));
                for (unsigned k = 0; k < n; k++)
                    sum = cplx_add(sum, cplx_mul(ca.value[i][k], cx.value[k][j]));
                TEST_ASSERT_DOUBLE_WITHIN(40 * EPS, 0.0, (double)cplx_abs(sum));
            }
            struct cplx miss = cplx_sub(diagonal[i], cx.value[i][i]);
            TEST_ASSERT_DOUBLE_WITHIN(40 * EPS, 0.0, (double)cplx_abs(miss));
        }
    }
}

static void the_determinant_of_a_complex_permutation_has_its_angle(void)
{
    /* rows swapped once: det = -(2i)(3)(e^{i}) */
    memset(&ca, 0, sizeof ca);
    ca.rows = ca.cols = 3;
    ca.value[0][1] = cplx(0, 2);
    ca.value[1][0] = cplx(3, 0);
    ca.value[2][2] = cplx((real_t)cos(1.0), (real_t)sin(1.0));
    struct cplx direction;
    real_t log_magnitude;
    TEST_ASSERT_EQUAL_INT(ERR_OK, clu_factor(&ca, &clu));
    clu_determinant(&clu, &direction, &log_magnitude);
    TEST_ASSERT_DOUBLE_WITHIN(4 * EPS, log(6.0), (double)log_magnitude);
    TEST_ASSERT_DOUBLE_WITHIN(4 * EPS, sin(1.0), (double)direction.re); /* -i e^{i} */
    TEST_ASSERT_DOUBLE_WITHIN(4 * EPS, -cos(1.0), (double)direction.im);
}

static void matrices_that_cannot_be_inverted_are_refused(void)
{
    a = (struct matrix){2, 2, {{1, 2}, {2, 4}}};
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, lu_factor(&a, &lu));
    a = (struct matrix){2, 2, {{1, 2}, {0, 0}}};
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, lu_factor(&a, &lu));
    a = (struct matrix){3, 2, {{1, 2}, {2, 4}, {3, 6}}};
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, matrix_pseudo_inverse(&a, &work, &x));
    a = (struct matrix){2, 3, {{0, 0, 0}, {2, 4, 1}}};
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, matrix_pseudo_inverse(&a, &work, &x));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, lu_factor(&a, &lu)); /* not square */
    ca = (struct cmatrix){2, 2, {{{0, 1}, {1, 0}}, {{-1, 0}, {0, 1}}}};
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, clu_factor(&ca, &clu));
    cx = ca;
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, cmatrix_invert_own(cx.value, 2));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, cmatrix_invert_own(cx.value, 0));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, cmatrix_invert_own(cx.value, 17));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, clu_factor_own(&clu, 0));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, clu_factor_own(&clu, 17));
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, cmatrix_pseudo_inverse(&ca, &cwork, &cx));
    a = (struct matrix){2, 2, {{0, 0}, {0, 0}}};
    TEST_ASSERT_EQUAL_INT(ERR_OK, svd_decompose(&svd, &a));
    TEST_ASSERT_EQUAL_UINT(0, svd_rank(&svd, 0));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, svd_pseudo_inverse(&svd, 1, &x));
}

static void sizes_and_elements_out_of_range_are_refused(void)
{
    static const real_t bad[] = {(real_t)NAN, (real_t)INFINITY, (real_t)-INFINITY, (real_t)1e20};
    for (unsigned k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        a = (struct matrix){2, 2, {{1, 2}, {bad[k], 1}}};
        TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, lu_factor(&a, &lu));
        TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, matrix_pseudo_inverse(&a, &work, &x));
        TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, svd_begin(&svd, &a));
        ca = (struct cmatrix){1, 1, {{{1, bad[k]}}}};
        TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, clu_factor(&ca, &clu));
        clu.value[0][0] = ca.value[0][0];
        TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, clu_factor_own(&clu, 1));
        TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, cmatrix_invert_own(ca.value, 1));
        TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, cmatrix_pseudo_inverse(&ca, &cwork, &cx));
    }
    a = (struct matrix){0, 2, {{0}}};
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, svd_begin(&svd, &a));
    a = (struct matrix){2, 17, {{0}}};
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, matrix_check(&a));
    x = (struct matrix){3, 2, {{0}}};
    y = (struct matrix){3, 2, {{0}}};
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, matrix_multiply(&x, &y, &z));
}

static void elements_of_up_to_1e15_are_taken(void)
{
    static const double sizes[] = {1e15, -1e15, 1.001e15, -1.001e15};
    for (unsigned k = 0; k < 4; k++) {
        enum err want = k < 2 ? ERR_OK : ERR_NOT_FINITE;
        a = (struct matrix){1, 2, {{1, (real_t)sizes[k]}}};
        TEST_ASSERT_EQUAL_INT(want, matrix_check(&a));
        ca = (struct cmatrix){1, 2, {{{1, 0}, {(real_t)sizes[k], 0}}}};
        TEST_ASSERT_EQUAL_INT(want, cmatrix_check(&ca));
        ca = (struct cmatrix){2, 1, {{{1, 0}}, {{0, (real_t)sizes[k]}}}};
        TEST_ASSERT_EQUAL_INT(want, cmatrix_check(&ca));
    }
}

/* Uses the largest sizes, not square: what is beyond the last row or column is not the matrix's. */
static void the_largest_matrices_stay_in_their_bounds(void)
{
    static const uint8_t sizes[][2] = {{MATRIX_MAX, 3}, {3, MATRIX_MAX}, {MATRIX_MAX, MATRIX_MAX}};
    for (unsigned k = 0; k < 3; k++) {
        struct random_source r = {77 + k};
        a.rows = ca.rows = sizes[k][0];
        a.cols = ca.cols = sizes[k][1];
        for (unsigned i = 0; i < a.rows; i++)
            for (unsigned j = 0; j < a.cols; j++) {
                a.value[i][j] = (real_t)(random_fraction(&r) + (i == j ? 9.0 : 0.0));
                ca.value[i][j] = cplx(a.value[i][j], (real_t)random_fraction(&r));
            }
        unsigned n = a.rows < a.cols ? a.rows : a.cols;
        TEST_ASSERT_EQUAL_INT(ERR_OK, matrix_pseudo_inverse(&a, &work, &x));
        TEST_ASSERT_EQUAL_INT(ERR_OK, cmatrix_pseudo_inverse(&ca, &cwork, &cx));
        for (unsigned i = 0; i < n; i++)
            for (unsigned j = 0; j < n; j++) { /* A+ A of a tall one, A A+ of a wide one */
                double sum = 0.0;
                struct cplx csum = cplx(0, 0);
                for (unsigned l = 0; l < (a.rows > a.cols ? a.rows : a.cols); l++) {
                    bool tall = a.rows >= a.cols;
                    sum += (double)(tall ? x.value[i][l] : a.value[i][l]) *
                           (double)(tall ? a.value[l][j] : x.value[l][j]);
                    csum = cplx_add(csum, cplx_mul(tall ? cx.value[i][l] : ca.value[i][l],
                                                   tall ? ca.value[l][j] : cx.value[l][j]));
                }
                TEST_ASSERT_DOUBLE_WITHIN(100 * EPS, i == j, sum);
                TEST_ASSERT_DOUBLE_WITHIN(100 * EPS, i == j, (double)csum.re);
                TEST_ASSERT_DOUBLE_WITHIN(100 * EPS, 0, (double)csum.im);
            }
    }
}

static void a_decomposition_is_made_of_single_sweeps(void)
{
    random_matrix(5, &a);
    TEST_ASSERT_EQUAL_INT(ERR_OK, svd_begin(&svd, &a));
    unsigned calls = 1;
    enum err err;
    while ((err = svd_step(&svd)) == ERR_BUSY)
        calls++;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    TEST_ASSERT_EQUAL_UINT(svd.sweeps, calls);
    TEST_ASSERT_EQUAL_INT(ERR_STATE, svd_step(&svd));
}

/* Put in order by their lengths, columns 0 and 3 pass one another in the first sweep, and all other pairs are orthogonal. */
static void columns_that_change_places_are_compared_nevertheless(void)
{
    a = (struct matrix){
        4, 4, {{1, 0, 0, 1}, {0, (real_t)1.25}, {0, 0, (real_t)0.5}, {0, 0, 0, (real_t)1.5}}};
    TEST_ASSERT_EQUAL_INT(ERR_OK, svd_decompose(&svd, &a));
    double root = sqrt(4.25 * 4.25 / 4 - 2.25);
    const double wanted[4] = {sqrt(2.125 + root), 1.25, sqrt(2.125 - root), 0.5};
    for (unsigned k = 0; k < 4; k++)
        TEST_ASSERT_DOUBLE_WITHIN(20 * EPS * wanted[0], wanted[k], (double)svd.s[k]);
    TEST_ASSERT_TRUE(unorthogonal(&svd.u) <= 20 * EPS);
}

static void extreme_scales_lose_no_accuracy(void)
{
    static const double scales[] = {1e-14, 1e14};
    for (unsigned k = 0; k < 2; k++) {
        a = (struct matrix){2, 2, {{2, 1}, {1, 2}}}; /* 3 and 1 */
        for (unsigned i = 0; i < 2; i++)
            for (unsigned j = 0; j < 2; j++)
                a.value[i][j] = (real_t)((double)a.value[i][j] * scales[k]);
        TEST_ASSERT_EQUAL_INT(ERR_OK, svd_decompose(&svd, &a));
        TEST_ASSERT_DOUBLE_WITHIN(20 * EPS * 3 * scales[k], 3 * scales[k], (double)svd.s[0]);
        TEST_ASSERT_DOUBLE_WITHIN(20 * EPS * 3 * scales[k], scales[k], (double)svd.s[1]);
        TEST_ASSERT_EQUAL_INT(ERR_OK, matrix_pseudo_inverse(&a, &work, &x));
        TEST_ASSERT_DOUBLE_WITHIN(8 * EPS / scales[k], 2.0 / 3.0 / scales[k],
                                  (double)x.value[0][0]);
    }
    /* columns 20 powers of ten apart, nearly parallel: the rotation is too small for its square */
    a = (struct matrix){2, 2, {{1, (real_t)1e-12}, {1, 0}}};
    TEST_ASSERT_EQUAL_INT(ERR_OK, svd_decompose(&svd, &a));
    TEST_ASSERT_DOUBLE_WITHIN(20 * EPS, sqrt(2.0), (double)svd.s[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1e-12 * sqrt(0.5), (double)svd.s[1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(singular_values_of_random_matrices_are_those_of_numpy);
    RUN_TEST(ranks_of_products_of_whole_numbers_are_found);
    RUN_TEST(inverses_satisfy_penrose_within_the_condition_number);
    RUN_TEST(determinants_have_the_sign_and_size_of_numpy);
    RUN_TEST(a_solution_may_replace_its_right_hand_side);
    RUN_TEST(equilibrated_rows_and_columns_have_about_length_one);
    RUN_TEST(complex_inverses_satisfy_penrose);
    RUN_TEST(complex_elimination_solves_and_its_determinant_is_that_of_the_real_form);
    RUN_TEST(a_complex_matrix_is_inverted_in_its_place_and_so_is_its_diagonal);
    RUN_TEST(the_determinant_of_a_complex_permutation_has_its_angle);
    RUN_TEST(matrices_that_cannot_be_inverted_are_refused);
    RUN_TEST(sizes_and_elements_out_of_range_are_refused);
    RUN_TEST(elements_of_up_to_1e15_are_taken);
    RUN_TEST(the_largest_matrices_stay_in_their_bounds);
    RUN_TEST(a_decomposition_is_made_of_single_sweeps);
    RUN_TEST(columns_that_change_places_are_compared_nevertheless);
    RUN_TEST(extreme_scales_lose_no_accuracy);
    return UNITY_END();
}
