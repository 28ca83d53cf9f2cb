/* interact/direction.[ch], and what pairing, candidates and the rank make of it; built in float and in double.
 *
 * Contract, against numpy (tests/reference/direction_reference.py), eps is REAL_EPSILON:
 *   conditional mean     within 2e-5
 *   covariance of draws  within 5 standard deviations of an estimate from DRAWS
 *   determinant          within 1e-3 of its deviations
 */
#include <math.h>
#include <string.h>

#include "csv.h"
#include "interact/candidates.h"
#include "interact/direction.h"
#include "interact/gains.h"
#include "interact/pairing.h"
#include "unity.h"

#define NUMBERS 101
#define DRAWS   4000
#define MOST    6

static struct interact_plant plant;
static double v[NUMBERS];

void setUp(void)
{
    memset(&plant, 0, sizeof plant);
}
void tearDown(void) {}

static unsigned row_of_numbers(double *measured, double *sd, double *floor)
{
    unsigned n = (unsigned)v[1];
    memset(&plant, 0, sizeof plant);
    plant.outputs = 2;
    plant.inputs = (uint8_t)n;
    *floor = v[2];
    *measured = v[3];
    *sd = v[4];
    for (unsigned k = 0; k < n; k++) {
        plant.element[1][k].gain = (real_t)v[5 + k];
        plant.gain_sd[1][k] = (real_t)v[5 + n + k];
        plant.share[k] = (real_t)v[5 + 2 * n + k];
    }
    return n;
}

static void the_mean_is_that_of_bayes_rule(void)
{
    FILE *file = csv_open("reference/direction.csv");
    unsigned rows = 0;
    double measured, sd, floor;
    while (csv_row(file, v, NUMBERS)) {
        if (v[0] > 0)
            continue;
        unsigned n = row_of_numbers(&measured, &sd, &floor);
        direction_take(&plant, 1, (real_t)floor, (real_t)measured, (real_t)sd);
        for (unsigned k = 0; k < n; k++)
            TEST_ASSERT_DOUBLE_WITHIN(2e-5, v[5 + 3 * n + k], (double)plant.element[1][k].gain);
        rows++;
    }
    fclose(file);
    TEST_ASSERT_EQUAL_UINT(60, rows);
}

/* Counts errors of the row that were drawn in one of two ways. */
static void count_draws(unsigned n, double floor, bool corrected, double sum[MOST][MOST])
{
    struct random random = random_from(7);
    memset(sum, 0, MOST * sizeof *sum);
    for (unsigned draw = 0; draw < DRAWS; draw++) {
        real_t e[INTERACT_MAX];
        if (corrected) {
            for (unsigned k = 0; k < n; k++)
                e[k] = direction_sd(&plant, 1, k, (real_t)floor) * random_normal(&random);
            direction_correct(&plant, 1, (real_t)floor, e);
        } else {
            direction_draw(&plant, 1, (real_t)floor, &random, e);
            for (unsigned k = 0; k < n; k++)
                e[k] -= plant.element[1][k].gain;
        }
        for (unsigned k = 0; k < n; k++)
            for (unsigned l = 0; l < n; l++)
                sum[k][l] += (double)e[k] * (double)e[l] / DRAWS;
    }
}

static void draws_have_the_covariance_of_bayes_rule(void)
{
    FILE *file = csv_open("reference/direction.csv");
    double measured, sd, floor, sum[MOST][MOST];
    while (csv_row(file, v, NUMBERS)) {
        if (v[0] > 0)
            continue;
        unsigned n = row_of_numbers(&measured, &sd, &floor);
        direction_take(&plant, 1, (real_t)floor, (real_t)measured, (real_t)sd);
        const double *wanted = &v[5 + 4 * n + n * n];
        for (unsigned way = 0; way < 2; way++) {
            count_draws(n, floor, way == 0, sum);
            for (unsigned k = 0; k < n; k++)
                for (unsigned l = 0; l < n; l++) {
                    double both = wanted[k * n + l];
                    double size = wanted[k * n + k] * wanted[l * n + l];
                    double near = 5 * sqrt((both * both + size) / DRAWS) + 1e-9;
                    TEST_ASSERT_DOUBLE_WITHIN(near, both, sum[k][l]);
                }
        }
    }
    fclose(file);
}

/* The errors themselves, not their common part: what is left is the covariance. */
static void the_common_part_leaves_the_covariance_of_bayes_rule(void)
{
    FILE *file = csv_open("reference/direction.csv");
    double measured, sd, floor;
    while (csv_row(file, v, NUMBERS)) {
        if (v[0] > 0)
            continue;
        unsigned n = row_of_numbers(&measured, &sd, &floor);
        real_t q[INTERACT_MAX];
        TEST_ASSERT_FALSE(direction_common(&plant, 1, (real_t)floor, q));
        TEST_ASSERT_EQUAL_DOUBLE(0, (double)q[n - 1]);
        direction_take(&plant, 1, (real_t)floor, (real_t)measured, (real_t)sd);
        TEST_ASSERT_TRUE(direction_common(&plant, 1, (real_t)floor, q));
        for (unsigned k = 0; k < n; k++)
            for (unsigned l = 0; l < n; l++) {
                double own = (double)direction_sd(&plant, 1, k, (real_t)floor);
                double left = (k == l ? own * own : 0) - (double)q[k] * (double)q[l];
                TEST_ASSERT_DOUBLE_WITHIN(1e-6, v[5 + 4 * n + n * n + k * n + l], left);
            }
    }
    fclose(file);
}

static void the_determinant_is_surer_by_the_common_part(void)
{
    static struct matrix gains, sds, common;
    static struct rga_work work;
    FILE *file = csv_open("reference/direction.csv");
    unsigned rows = 0;
    while (csv_row(file, v, NUMBERS)) {
        if (!(v[0] > 0))
            continue;
        unsigned n = (unsigned)v[1];
        gains.rows = gains.cols = sds.rows = sds.cols = common.rows = common.cols = (uint8_t)n;
        for (unsigned i = 0; i < n * n; i++) {
            gains.value[i / n][i % n] = (real_t)v[2 + i];
            sds.value[i / n][i % n] = (real_t)v[2 + n * n + i];
            common.value[i / n][i % n] = (real_t)v[2 + 2 * n * n + i];
        }
        real_t found, wanted = (real_t)v[2 + 3 * n * n];
        TEST_ASSERT_EQUAL_INT(ERR_OK, rga_determinant_sds(&gains, &sds, &common, &work, &found));
        TEST_ASSERT_DOUBLE_WITHIN(1e-3 * (double)wanted, (double)wanted, (double)found);
        rows++;
    }
    fclose(file);
    TEST_ASSERT_EQUAL_UINT(40, rows);
}

/* Relative gain 60, each gain to a half per cent. */
static void alike(void)
{
    plant.outputs = plant.inputs = 2;
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++) {
            plant.element[i][j] =
                (struct fopdt){.gain = 1, .dead_time_s = 15, .time_constant_s = 150};
            plant.gain_sd[i][j] = REAL_C(0.002);
        }
    plant.element[0][1].gain = REAL_C(0.9833);
}

static void measure_both_rows(void)
{
    plant.share[0] = 1;
    plant.share[1] = -1;
    direction_take(&plant, 0, REAL_C(0.005), REAL_C(0.0167), REAL_C(0.0005));
    direction_take(&plant, 1, REAL_C(0.005), 0, REAL_C(0.0005));
}

static struct pairing pairing;

static void pair_up(void)
{
    struct pairing_config config;
    pairing_config_default(&config);
    TEST_ASSERT_EQUAL_INT(ERR_OK, pairing_begin(&pairing, &plant, &config, NULL));
    while (pairing_step(&pairing) == ERR_BUSY)
        ;
}

static void inputs_that_act_alike_are_paired_once_a_direction_was_measured(void)
{
    alike();
    pair_up();
    TEST_ASSERT_TRUE(pairing.determinant < REAL_C(2.0));
    TEST_ASSERT_TRUE(pairing.probability < REAL_C(0.97));
    measure_both_rows();
    pair_up();
    TEST_ASSERT_TRUE(pairing.determinant > REAL_C(10.0));
    TEST_ASSERT_EQUAL_INT(PAIRING_DETERMINED, pairing.verdict);
    TEST_ASSERT_EQUAL_DOUBLE(1, (double)pairing.probability);
}

static uint16_t sound_of_first(void)
{
    static struct candidates found;
    const struct candidates_config config = {
        .smallest_lambda = REAL_C(0.02), .floor = REAL_C(0.005), .draws = 400, .seed = 1};
    const struct pairs channels = {.n = 2, .output = {0, 1}, .input = {0, 1}};
    TEST_ASSERT_EQUAL_INT(ERR_OK, candidates_begin(&found, &plant, &channels, &config, NULL));
    while (candidates_step(&found) == ERR_BUSY)
        ;
    TEST_ASSERT_TRUE(found.n > 0);
    return found.list[0].sound;
}

static void a_candidate_would_do_in_every_draw_then(void)
{
    alike();
    TEST_ASSERT_TRUE(sound_of_first() < 390);
    measure_both_rows();
    TEST_ASSERT_EQUAL_UINT16(400, sound_of_first());
}

static uint8_t rank(struct gains *g)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, gains_begin(g, &plant, REAL_C(0.005)));
    while (gains_step(g) == ERR_BUSY)
        ;
    return g->rank;
}

static void both_directions_stand_out_then(void)
{
    static struct gains g;
    alike();
    TEST_ASSERT_EQUAL_UINT8(1, rank(&g));
    /* It asks for that very direction. */
    TEST_ASSERT_DOUBLE_WITHIN(0.02, sqrt(0.5), fabs((double)g.weakest[0]));
    TEST_ASSERT_DOUBLE_WITHIN(0.02, -0.5, (double)(g.weakest[0] * g.weakest[1]));
    measure_both_rows();
    TEST_ASSERT_EQUAL_UINT8(2, rank(&g));
}

static void a_direction_that_shows_no_difference_leaves_one_rank(void)
{
    static struct gains g;
    alike();
    plant.share[0] = 1;
    plant.share[1] = -1;
    for (unsigned i = 0; i < 2; i++)
        direction_take(&plant, i, REAL_C(0.005), REAL_C(0.0003), REAL_C(0.0005));
    TEST_ASSERT_EQUAL_UINT8(1, rank(&g));
    pair_up();
    TEST_ASSERT_TRUE(pairing.determinant < REAL_C(2.0));
}

static void numbers_that_are_none_change_nothing(void)
{
    alike();
    plant.share[0] = 1;
    const struct interact_plant before = plant;
    direction_take(&plant, 0, 0, (real_t)NAN, 1);
    direction_take(&plant, 0, 0, 1, (real_t)INFINITY);
    direction_take(&plant, 0, 0, 1, 0);
    plant.share[0] = 0; /* nothing was moved */
    direction_take(&plant, 0, 0, 1, 1);
    plant.share[0] = 1;
    TEST_ASSERT_EQUAL_MEMORY(&before, &plant, sizeof plant);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_mean_is_that_of_bayes_rule);
    RUN_TEST(draws_have_the_covariance_of_bayes_rule);
    RUN_TEST(the_common_part_leaves_the_covariance_of_bayes_rule);
    RUN_TEST(the_determinant_is_surer_by_the_common_part);
    RUN_TEST(inputs_that_act_alike_are_paired_once_a_direction_was_measured);
    RUN_TEST(a_candidate_would_do_in_every_draw_then);
    RUN_TEST(both_directions_stand_out_then);
    RUN_TEST(a_direction_that_shows_no_difference_leaves_one_rank);
    RUN_TEST(numbers_that_are_none_change_nothing);
    return UNITY_END();
}
