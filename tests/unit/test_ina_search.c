/* interact/ina_search.[ch]; built in float and in double. */
#include <math.h>
#include <stdio.h>

#include "interact/difference_response.h"
#include "interact/ina_search.h"
#include "interact_plants.h"
#include "kotyk_model.h"
#include "unity.h"

#define POINTS 100

static struct known_plant known;
static struct cplx table[POINTS * INA_MOST * INA_MOST];
static struct ina_search search;
static struct ina_search_config config;
static struct matrix g;
static struct ina_work work;
static struct cmatrix f, inverse;

void setUp(void)
{
    ina_search_config_default(&config);
}
void tearDown(void) {}

static void add_point(unsigned point)
{
    struct matrix one;
    unsigned n = f.rows;
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(f.rows, &one));
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_inverse(&f, &one, &work, &inverse));
    for (unsigned m = 0; m < n * n; m++)
        table[point * n * n + m] = inverse.value[m / n][m % n];
}

static void tabulate_kotyk(void)
{
    struct difference_model model;
    kotyk_model(&model);
    for (unsigned k = 0; k < POINTS; k++) {
        double x = 1e-3 + (3.14159265 - 1e-3) * k / (POINTS - 1);
        TEST_ASSERT_EQUAL_INT(ERR_OK, difference_response(&model, (real_t)(x / KOTYK_PERIOD), &f));
        add_point(k);
    }
}

static void tabulate_plant(unsigned number)
{
    known_plant(number, &known);
    for (unsigned k = 0; k < POINTS; k++) {
        interact_response(&known.plant, NULL, (real_t)(1e-5 * pow(10.0, 3.0 * k / (POINTS - 1))),
                          &f);
        add_point(k);
    }
}

static void run_search(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_search_begin(&search, table, POINTS, &g, &config));
    enum err err;
    while ((err = ina_search_step(&search)) == ERR_BUSY)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
}

/* Largest ratio over the table with a compensator, by the other way: K F^-1 with K found anew. */
static double worst_with(const struct matrix *with, enum ina_by by)
{
    struct lu lu;
    struct matrix k;
    double worst = 0.0;
    unsigned n = with->rows;
    TEST_ASSERT_EQUAL_INT(ERR_OK, lu_factor(with, &lu));
    lu_inverse(&lu, &k);
    for (unsigned point = 0; point < POINTS; point++) {
        inverse.rows = inverse.cols = with->rows;
        for (unsigned m = 0; m < n * n; m++) {
            struct cplx sum = cplx(0, 0);
            for (unsigned a = 0; a < n; a++)
                sum = cplx_add(sum,
                               cplx_scale(table[point * n * n + a * n + m % n], k.value[m / n][a]));
            inverse.value[m / n][m % n] = sum;
        }
        worst = fmax(worst, (double)ina_dominance(&inverse, by, NULL, NULL));
    }
    return worst;
}

static void it_is_at_least_as_dominant_as_what_two_row_operations_gave(void)
{
    tabulate_kotyk();
    kotyk_compensator(&g);
    double theirs = worst_with(&g, INA_BY_ROWS);
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(2, &g));
    run_search();
    printf("by rows: %.3f, found %.3f in %u looks, theirs %.3f\n", (double)search.before,
           (double)search.after, (unsigned)search.looks, theirs);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1.271, (double)search.before);
    TEST_ASSERT_TRUE((double)search.after < 0.5 * theirs);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, (double)search.after, worst_with(&search.g, INA_BY_ROWS));
}

static void each_of_two_rows_is_as_good_as_the_best_of_all_directions(void)
{
    static const unsigned plants[] = {PLANT_WOOD_BERRY, PLANT_LUYBEN_VINANTE, PLANT_PACKED_BED};
    for (unsigned p = 0; p < 3; p++) {
        tabulate_plant(plants[p]);
        TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(2, &g));
        run_search();
        for (unsigned row = 0; row < 2; row++) {
            double best = INFINITY;
            for (unsigned k = 0; k < 20000; k++) {
                double c = cos(3.14159265 * k / 20000), s = sin(3.14159265 * k / 20000);
                double worst = 0.0;
                for (unsigned point = 0; point < POINTS && worst < best; point++) {
                    const struct cplx *at = table + point * 4;
                    double own = hypot(c * (double)at[row].re + s * (double)at[2 + row].re,
                                       c * (double)at[row].im + s * (double)at[2 + row].im);
                    double off = hypot(c * (double)at[1 - row].re + s * (double)at[3 - row].re,
                                       c * (double)at[1 - row].im + s * (double)at[3 - row].im);
                    worst = fmax(worst, own > 0 ? off / own : INFINITY);
                }
                best = fmin(best, worst);
            }
            TEST_ASSERT_TRUE((double)search.ratio[row] <= best * (1 + 1e-3) + 1e-4);
            TEST_ASSERT_TRUE((double)search.ratio[row] >= best * (1 - 1e-2));
        }
    }
}

static void what_a_constant_matrix_decouples_it_decouples(void)
{
    static const double mix[3][3] = {{1, 0.5, -0.25}, {0.5, 1, 0.5}, {-0.5, 0.25, 1}};
    for (unsigned k = 0; k < POINTS; k++) {
        f.rows = f.cols = 3;
        for (unsigned i = 0; i < 3; i++) {
            struct fopdt own = {1, (real_t)(5 * i), (real_t)(20 + 10 * i)};
            struct cplx z = fopdt_response(&own, (real_t)(1e-3 * (k + 1)));
            for (unsigned j = 0; j < 3; j++)
                f.value[i][j] = cplx_scale(z, (real_t)mix[i][j]);
        }
        add_point(k);
    }
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(3, &g));
    run_search();
    TEST_ASSERT_TRUE(search.before > REAL_C(0.5));
    TEST_ASSERT_TRUE(search.after < REAL_C(1e-4));
    for (unsigned i = 0; i < 3; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, (double)search.g.value[i][i]);
}

static void four_loops_get_better_from_where_they_are(void)
{
    tabulate_plant(PLANT_LUYBEN_4X4);
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(4, &g));
    for (unsigned by = 0; by < 2; by++) {
        config.by = by == 0 ? INA_BY_ROWS : INA_BY_COLUMNS;
        config.starts = 3;
        run_search();
        printf("four loops, %s: %.3f to %.3f\n", by == 0 ? "rows" : "columns",
               (double)search.before, (double)search.after);
        TEST_ASSERT_TRUE(search.after < search.before);
        double again = worst_with(&search.g, config.by);
        TEST_ASSERT_DOUBLE_WITHIN(1e-2 * again, again, (double)search.after);
    }
}

static void by_columns_the_largest_element_is_1_and_the_diagonal_positive(void)
{
    tabulate_kotyk();
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(2, &g));
    config.by = INA_BY_COLUMNS;
    run_search();
    double largest = 0.0;
    for (unsigned k = 0; k < 4; k++)
        largest = fmax(largest, fabs((double)search.g.value[k / 2][k % 2]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, largest);
    TEST_ASSERT_TRUE(search.g.value[0][0] > 0 && search.g.value[1][1] > 0);
    TEST_ASSERT_TRUE((double)search.after < 0.238);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, (double)search.after, worst_with(&search.g, INA_BY_COLUMNS));
    for (unsigned i = 0; i < 2; i++)
        TEST_ASSERT_EQUAL_DOUBLE((double)search.after, (double)search.ratio[i]);
}

static void the_same_seed_finds_the_same_to_the_last_bit(void)
{
    tabulate_kotyk();
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(2, &g));
    run_search();
    struct matrix first = search.g;
    run_search();
    for (unsigned i = 0; i < 2; i++)
        TEST_ASSERT_EQUAL_MEMORY(first.value[i], search.g.value[i], 2 * sizeof(real_t));
}

static void a_single_start_is_the_given_compensator(void)
{
    tabulate_kotyk();
    kotyk_compensator(&g);
    config.starts = 1;
    run_search();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.424, (double)search.before);
    TEST_ASSERT_TRUE(search.after <= search.before);
}

static void a_single_loop_has_nothing_beside_it(void)
{
    f.rows = f.cols = 1;
    f.value[0][0] = cplx(2, -1);
    for (unsigned k = 0; k < POINTS; k++)
        add_point(k);
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(1, &g));
    run_search();
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)search.after);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, (double)search.g.value[0][0]);
}

static void of_several_starts_the_best_counts(void)
{
    tabulate_plant(PLANT_PACKED_BED);
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(2, &g));
    config.by = INA_BY_COLUMNS;
    double last = INFINITY;
    for (uint8_t starts = 1; starts <= 8; starts++) {
        config.starts = starts; /* the same ones, and one more */
        run_search();
        TEST_ASSERT_TRUE((double)search.after <= last);
        last = (double)search.after;
    }
}

/* Rows of K that are nearly the same would have ratios of 1. */
static void a_plant_that_is_not_dominant_with_any_gets_no_compensator_next_to_singular(void)
{
    tabulate_plant(PLANT_PACKED_BED);
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(2, &g));
    config.by = INA_BY_COLUMNS;
    config.lambda_hi = REAL_C(1.05);
    run_search();
    printf("packed bed: %.3f to %.3f, lambda %.2f\n", (double)search.before, (double)search.after,
           (double)search.lambda);
    TEST_ASSERT_TRUE(search.after < search.before);
    TEST_ASSERT_TRUE((double)search.lambda <= 1.05 * (1 + 1e-4));
}

static void rows_that_make_a_compensator_past_the_bound_are_refused(void)
{
    tabulate_kotyk();
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(2, &g));
    run_search();
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 1.274, (double)search.lambda);
    config.lambda_hi = REAL_C(1.2);
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_search_begin(&search, table, POINTS, &g, &config));
    enum err err;
    while ((err = ina_search_step(&search)) == ERR_BUSY)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, err);
}

static void what_cannot_be_searched_is_refused(void)
{
    tabulate_kotyk();
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(2, &g));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, ina_search_begin(&search, table, 0, &g, &config));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE,
                          ina_search_begin(&search, table, INA_POINTS_MOST + 1, &g, &config));
    config.starts = 0;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, ina_search_begin(&search, table, POINTS, &g, &config));
    ina_search_config_default(&config);
    config.lambda_hi = REAL_C(0.5);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, ina_search_begin(&search, table, POINTS, &g, &config));
    ina_search_config_default(&config);
    g.value[1][1] = 0;
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, ina_search_begin(&search, table, POINTS, &g, &config));
    TEST_ASSERT_EQUAL_INT(ERR_OK, ina_identity(2, &g));
    table[7].im = (real_t)NAN;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, ina_search_begin(&search, table, POINTS, &g, &config));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_is_at_least_as_dominant_as_what_two_row_operations_gave);
    RUN_TEST(each_of_two_rows_is_as_good_as_the_best_of_all_directions);
    RUN_TEST(what_a_constant_matrix_decouples_it_decouples);
    RUN_TEST(four_loops_get_better_from_where_they_are);
    RUN_TEST(by_columns_the_largest_element_is_1_and_the_diagonal_positive);
    RUN_TEST(the_same_seed_finds_the_same_to_the_last_bit);
    RUN_TEST(a_single_start_is_the_given_compensator);
    RUN_TEST(a_single_loop_has_nothing_beside_it);
    RUN_TEST(of_several_starts_the_best_counts);
    RUN_TEST(a_plant_that_is_not_dominant_with_any_gets_no_compensator_next_to_singular);
    RUN_TEST(rows_that_make_a_compensator_past_the_bound_are_refused);
    RUN_TEST(what_cannot_be_searched_is_refused);
    return UNITY_END();
}
