/* interact/difference_response.[ch], interact/ina.[ch]; built in float and in double. eps is REAL_EPSILON, kappa the condition number of
 * F G.
 *
 * Contract, against numpy on Kotyk and Machacek's column in z and on two plants with dead times in s:
 *   response in z    within (na + nb + 8) eps (sum |b| + |f| (1 + sum |a|))/|A_ii|
 *   inverse array    within (16 n + 4 omega L) eps kappa of its largest element, L the longest dead time
 *   ALIGN            no other column or angle is nearer by more than 64 eps kappa
 */
#include <complex.h>
#include <math.h>
#include <stdio.h>

#include "interact/difference_response.h"
#include "interact/ina.h"
#include "interact_plants.h"
#include "kotyk_model.h"
#include "random_matrix.h"
#include "unity.h"

#define EPS     ((double)REAL_EPSILON)
#define NUMBERS 68

static struct known_plant known;
static struct difference_model model;
static struct cmatrix f, h, inverse;
static struct matrix g;
static struct ina_work work;
static struct ina_align_work align;

void setUp(void)
{
    kotyk_model(&model);
}
void tearDown(void) {}

static double complex of(struct cplx z)
{
    return (double)z.re + (double)z.im * I;
}

/* drawn() of tests/reference/ina_reference.py */
static void draw_compensator(uint8_t n)
{
    struct random_source r = {n};
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(n, &g));
    for (unsigned i = 0; i < n; i++)
        for (unsigned j = 0; j < n; j++)
            g.value[i][j] += (real_t)(0.25 * random_fraction(&r));
}

static double size_of_polynomials(double complex response, unsigned i, unsigned j, double omega)
{
    double complex back = cexp(-I * omega * (double)model.period_s);
    double complex a = 1.0 + (double)model.a[i][0] * back + (double)model.a[i][1] * back * back;
    double b = fabs((double)model.b[i][j][0]) + fabs((double)model.b[i][j][1]);
    double sum = 1.0 + fabs((double)model.a[i][0]) + fabs((double)model.a[i][1]);
    return (b + cabs(response) * sum) / cabs(a);
}

static void responses_of_a_sampled_plant_are_those_of_numpy(void)
{
    FILE *file = csv_open("reference/ina.csv");
    double v[NUMBERS], worst = 0.0;
    unsigned seen = 0;
    while (csv_row(file, v, NUMBERS)) {
        if (v[0] > 0.0)
            continue;
        TEST_ASSERT_EQUAL_INT(ERR_OK, difference_response(&model, (real_t)v[2], &f));
        for (unsigned k = 0; k < 4; k++) {
            double complex want = v[4 + 2 * k] + v[5 + 2 * k] * I;
            double error = cabs(of(f.value[k / 2][k % 2]) - want);
            worst = fmax(worst, error / size_of_polynomials(want, k / 2, k % 2, v[2]));
        }
        seen++;
    }
    fclose(file);
    printf("responses in z: worst %.2f eps\n", worst / EPS);
    TEST_ASSERT_EQUAL_UINT(18, seen);
    TEST_ASSERT_TRUE(worst <= 12 * EPS);
}

/* F and G of a row of the table; the longest dead time. */
static double begin_row(const double *v)
{
    double longest = 0.0;
    if (v[0] > 0.0) {
        known_plant((unsigned)v[0], &known);
        interact_response(&known.plant, NULL, (real_t)v[2], &f);
        for (unsigned i = 0; i < f.rows; i++)
            for (unsigned j = 0; j < f.cols; j++)
                longest = fmax(longest, (double)known.plant.element[i][j].dead_time_s);
    } else {
        TEST_ASSERT_EQUAL_INT(ERR_OK, difference_response(&model, (real_t)v[2], &f));
    }
    if (v[1] > 1.0)
        draw_compensator(f.rows);
    else if (v[1] > 0.0)
        kotyk_compensator(&g);
    else
        TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(f.rows, &g));
    return longest;
}

static void inverse_arrays_are_those_of_numpy(void)
{
    FILE *file = csv_open("reference/ina.csv");
    double v[NUMBERS], worst = 0.0;
    unsigned seen = 0;
    while (csv_row(file, v, NUMBERS)) {
        double longest = begin_row(v);
        unsigned n = f.rows;
        TEST_ASSERT_EQUAL_INT(ERR_OK, ina_inverse(&f, &g, &work, &inverse));
        const double *want = v + 4 + 2 * n * n;
        double error = 0.0, largest = 0.0;
        for (unsigned k = 0; k < n * n; k++) {
            double complex exact = want[2 * k] + want[2 * k + 1] * I;
            error = fmax(error, cabs(of(inverse.value[k / n][k % n]) - exact));
            largest = fmax(largest, cabs(exact));
        }
        worst = fmax(worst, error / (largest * v[3] * (16.0 * n + 4.0 * v[2] * longest)));
        seen++;
    }
    fclose(file);
    printf("inverse arrays: worst %.3f of what is allowed\n", worst / EPS);
    TEST_ASSERT_EQUAL_UINT(38, seen);
    TEST_ASSERT_TRUE(worst <= EPS);
}

static void a_frequency_past_half_the_rate_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, difference_response(&model, (real_t)0.0262, &f));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, difference_response(&model, (real_t)-1e-9, &f));
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, difference_response(&model, (real_t)NAN, &f));
    model.na = 9;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, difference_response(&model, 0, &f));
}

static void an_integrator_has_no_response_at_0(void)
{
    model.a[1][0] = -1;
    model.a[1][1] = 0;
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, difference_response(&model, 0, &f));
    TEST_ASSERT_EQUAL_INT(ERR_OK, difference_response(&model, (real_t)1e-4, &f));
}

/* Largest ratios of two rows, then of two columns, over 400 points from near 0 to half the rate. */
static void worst_ratios(double worst[4])
{
    for (unsigned k = 0; k < 4; k++)
        worst[k] = 0.0;
    for (unsigned k = 0; k < 400; k++) {
        double x = 1e-3 + (3.14159265 - 1e-3) * k / 399.0;
        real_t ratio[4];
        TEST_ASSERT_EQUAL_INT(ERR_OK, difference_response(&model, (real_t)(x / KOTYK_PERIOD), &f));
        TEST_ASSERT_EQUAL_INT(ERR_OK, ina_inverse(&f, &g, &work, &inverse));
        (void)ina_dominance(&inverse, INA_BY_ROWS, NULL, ratio);
        (void)ina_dominance(&inverse, INA_BY_COLUMNS, NULL, ratio + 2);
        for (unsigned m = 0; m < 4; m++)
            worst[m] = fmax(worst[m], (double)ratio[m]);
    }
}

static void kotyk_and_machaceks_column_alone_is_not_dominant(void)
{
    double worst[4];
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(2, &g));
    worst_ratios(worst);
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 0.609, worst[0]);
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 1.271, worst[1]);
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 0.861, worst[2]);
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 0.362, worst[3]);
}

static void with_their_compensator_it_is(void)
{
    double worst[4];
    kotyk_compensator(&g);
    worst_ratios(worst);
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 0.197, worst[0]);
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 0.424, worst[1]);
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 0.238, worst[2]);
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 0.141, worst[3]);
}

static void two_row_operations_make_their_compensator(void)
{
    struct ina_operation first = {INA_ADD, 1, 0, REAL_C(-0.64)};
    struct ina_operation second = {INA_ADD, 0, 1, REAL_C(-0.33)};
    struct matrix want;
    kotyk_compensator(&want);
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(2, &g));
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_operate(&g, &first));
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_operate(&g, &second));
    for (unsigned k = 0; k < 4; k++)
        TEST_ASSERT_DOUBLE_WITHIN(2 * EPS, (double)want.value[k / 2][k % 2],
                                  (double)g.value[k / 2][k % 2]);
}

/* Rows of the inverse array after an operation on G, against those of before with the operation done to them. */
static void operate_on_both(struct ina_operation operation, double complex e[4][4])
{
    static struct cmatrix before;
    known_plant(PLANT_LUYBEN_4X4, &known);
    interact_response(&known.plant, NULL, REAL_C(1e-3), &f);
    draw_compensator(4);
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_inverse(&f, &g, &work, &before));
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_operate(&g, &operation));
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_inverse(&f, &g, &work, &inverse));
    for (unsigned i = 0; i < 4; i++)
        for (unsigned j = 0; j < 4; j++) {
            double complex sum = 0.0;
            double size = 0.0;
            for (unsigned k = 0; k < 4; k++) {
                sum += e[i][k] * of(before.value[k][j]);
                size += cabs(of(before.value[k][j]));
            }
            TEST_ASSERT_DOUBLE_WITHIN(4096 * EPS * size, 0.0, cabs(sum - of(inverse.value[i][j])));
        }
}

static void adding_to_a_row_adds_to_that_row_of_the_inverse(void)
{
    double complex e[4][4] = {{1}, {0, 1}, {0, 0.5, 1}, {0, 0, 0, 1}};
    operate_on_both((struct ina_operation){INA_ADD, 2, 1, REAL_C(0.5)}, e);
}

static void scaling_a_row_scales_that_row_of_the_inverse(void)
{
    double complex e[4][4] = {{1}, {0, 1}, {0, 0, 1}, {0, 0, 0, -4}};
    operate_on_both((struct ina_operation){INA_SCALE, 3, 0, REAL_C(-4.0)}, e);
}

static void swapping_rows_swaps_those_of_the_inverse(void)
{
    double complex e[4][4] = {{0, 0, 0, 1}, {0, 1}, {0, 0, 1}, {1}};
    operate_on_both((struct ina_operation){INA_SWAP, 3, 0, 0}, e);
}

static void operations_that_make_no_sense_are_refused_and_leave_the_compensator(void)
{
    static const struct ina_operation refused[] = {{INA_ADD, 2, 0, 1},
                                                   {INA_ADD, 0, 2, 1},
                                                   {INA_ADD, 1, 1, 1},
                                                   {INA_SWAP, 1, 1, 0},
                                                   {INA_SCALE, 2, 0, 1},
                                                   {INA_SCALE, 0, 0, 0},
                                                   {INA_SCALE, 0, 0, (real_t)2e6},
                                                   {INA_ADD, 0, 1, (real_t)NAN}};
    for (unsigned k = 0; k < sizeof refused / sizeof refused[0]; k++) {
        TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(2, &g));
        TEST_ASSERT_EQUAL_INT(ERR_RANGE, ina_operate(&g, &refused[k]));
        TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)g.value[0][0]);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)g.value[0][1]);
    }
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, ina_identity(0, &g));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, ina_identity(INA_MOST + 1, &g));
}

static void radii_are_sums_off_the_diagonal(void)
{
    h.rows = h.cols = 2;
    h.value[0][0] = cplx(0, 2);
    h.value[0][1] = cplx(3, 4);
    h.value[1][0] = cplx(0, -1);
    h.value[1][1] = cplx(0, 0);
    real_t radius[2], ratio[2];
    TEST_ASSERT_TRUE(isinf((double)ina_dominance(&h, INA_BY_ROWS, radius, ratio)));
    TEST_ASSERT_EQUAL_DOUBLE(5.0, (double)radius[0]);
    TEST_ASSERT_EQUAL_DOUBLE(2.5, (double)ratio[0]);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)radius[1]);
    (void)ina_dominance(&h, INA_BY_COLUMNS, radius, ratio);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)radius[0]);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, (double)ratio[0]);
}

static void a_plant_that_has_no_inverse_or_is_not_square_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(2, &g));
    f.rows = f.cols = 2;
    for (unsigned k = 0; k < 4; k++)
        f.value[k / 2][k % 2] = cplx(1, 1);
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, ina_inverse(&f, &g, &work, &inverse));
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, ina_align(&f, &align, &g));
    f.cols = 3;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, ina_inverse(&f, &g, &work, &inverse));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, ina_align(&f, &align, &g));
    f.cols = 2;
    f.value[1][1].im = (real_t)INFINITY;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, ina_direct(&f, &g, &h));
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(3, &g));
    f.value[1][1].im = 0;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, ina_direct(&f, &g, &h));
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(2, &g));
    g.value[1][0] = (real_t)NAN;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, ina_direct(&f, &g, &h));
}

static void at_rest_align_is_the_inverse(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, difference_response(&model, 0, &f));
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_align(&f, &align, &g));
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_direct(&f, &g, &h));
    for (unsigned k = 0; k < 4; k++)
        TEST_ASSERT_DOUBLE_WITHIN(64 * EPS, k == 0 || k == 3 ? 1.0 : 0.0,
                                  cabs(of(h.value[k / 2][k % 2])));
}

/* Squared distance of column j of F G from the nearest exp(i a) e_j, in double. */
static double misfit(const double *column, unsigned j)
{
    double square = 1.0;
    double complex own = 0.0;
    for (unsigned i = 0; i < f.rows; i++) {
        double complex sum = 0.0;
        for (unsigned k = 0; k < f.rows; k++)
            sum += of(f.value[i][k]) * column[k];
        square += creal(sum * conj(sum));
        own = i == j ? sum : own;
    }
    return square - 2.0 * cabs(own);
}

static void no_other_column_is_better_aligned(void)
{
    known_plant(PLANT_LUYBEN_4X4, &known);
    struct random_source r = {7};
    for (unsigned trial = 0; trial < 4; trial++) {
        interact_response(&known.plant, NULL, (real_t)pow(10.0, -4.0 + trial), &f);
        TEST_ASSERT_EQUAL_INT(ERR_OK, ina_align(&f, &align, &g));
        for (unsigned j = 0; j < 4; j++) {
            double column[4], other[4];
            for (unsigned k = 0; k < 4; k++)
                column[k] = (double)g.value[k][j];
            double least = misfit(column, j);
            for (unsigned draw = 0; draw < 2000; draw++) {
                double by = pow(10.0, -(double)(draw % 6));
                for (unsigned k = 0; k < 4; k++)
                    other[k] = column[k] * (draw % 2 ? -1.0 : 1.0) +
                               by * fabs(column[k]) * random_fraction(&r);
                TEST_ASSERT_TRUE(misfit(other, j) >= least - 64 * EPS);
            }
        }
    }
}

static void normalising_makes_the_diagonal_1_where_it_is_not_next_to_nothing(void)
{
    kotyk_compensator(&g);
    g.value[0][1] = -2;
    g.value[1][1] = -4;
    TEST_ASSERT_TRUE(ina_normalise(&g));
    TEST_ASSERT_EQUAL_DOUBLE(0.5, (double)g.value[0][1]);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)g.value[1][1]);
    g.value[0][0] = REAL_C(-0.001);
    g.value[1][0] = -4;
    TEST_ASSERT_FALSE(ina_normalise(&g));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)g.value[1][0]);
    g.value[0][0] = g.value[1][0] = 0;
    TEST_ASSERT_FALSE(ina_normalise(&g));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)g.value[1][0]);
}

static void columns_of_small_elements_are_normalised_as_large_ones(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(2, &g));
    g.value[0][0] = g.value[1][1] = REAL_C(0.0009765625);
    g.value[0][1] = REAL_C(0.00048828125);
    TEST_ASSERT_TRUE(ina_normalise(&g));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)g.value[0][0]);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, (double)g.value[0][1]);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)g.value[1][1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(responses_of_a_sampled_plant_are_those_of_numpy);
    RUN_TEST(inverse_arrays_are_those_of_numpy);
    RUN_TEST(a_frequency_past_half_the_rate_is_refused);
    RUN_TEST(an_integrator_has_no_response_at_0);
    RUN_TEST(kotyk_and_machaceks_column_alone_is_not_dominant);
    RUN_TEST(with_their_compensator_it_is);
    RUN_TEST(two_row_operations_make_their_compensator);
    RUN_TEST(adding_to_a_row_adds_to_that_row_of_the_inverse);
    RUN_TEST(scaling_a_row_scales_that_row_of_the_inverse);
    RUN_TEST(swapping_rows_swaps_those_of_the_inverse);
    RUN_TEST(operations_that_make_no_sense_are_refused_and_leave_the_compensator);
    RUN_TEST(radii_are_sums_off_the_diagonal);
    RUN_TEST(a_plant_that_has_no_inverse_or_is_not_square_is_refused);
    RUN_TEST(at_rest_align_is_the_inverse);
    RUN_TEST(no_other_column_is_better_aligned);
    RUN_TEST(columns_of_small_elements_are_normalised_as_large_ones);
    RUN_TEST(normalising_makes_the_diagonal_1_where_it_is_not_next_to_nothing);
    return UNITY_END();
}
