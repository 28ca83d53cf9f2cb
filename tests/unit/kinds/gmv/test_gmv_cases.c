/* The self-tuner's regressions and laws beside closed loops that an independent model in double has written from
 * docs/methods/self-tuning.md (tests/reference/self_tuning_reference.py). At each step the firmware gets what the model measured and
 * applied, so differences do not feed back.
 *
 * Contract, float and fixed: parameters within 2e-5 (45 samples of 7 parameters, each rounded by a step of 2^-24), MVs within
 * 2e-4: what they are divided by is 0.1 and more (0.001 of the determinant is never solved together). */
#include <stdio.h>

#include "csv.h"
#include "gmv_bench.h"
#include "unity.h"

#define CASES    64
#define PER_LOOP 7
#define SETTINGS (26 + 2 * PER_LOOP)
#define COLUMNS  (11 + 2 * PER_LOOP)
#define AT_REST  30

static struct gmv_bench bench;

void setUp(void) {}
void tearDown(void) {}

static void begin(const double *s)
{
    struct gmv_config c = gmv_plain_config((uint8_t)s[1]);
    c.shape.form = (uint8_t)s[2];
    c.shape.way = (uint8_t)s[3];
    c.shape.weight = (uint8_t)s[4];
    c.shape.bias = (uint8_t)s[5];
    c.shape.na = (uint8_t)s[6];
    c.shape.nb = (uint8_t)s[7];
    c.shape.nc = (uint8_t)s[8];
    for (unsigned i = 0; i < 4; i++)
        c.shape.delay[i / 2][i % 2] = (uint8_t)s[9 + i];
    c.shape.disturbances = (uint8_t)s[13];
    c.shape.disturbance_delay = (uint8_t)s[14];
    c.shape.average = (uint8_t)s[15];
    c.p0 = c.p0_u = (float)s[21];
    c.rls.forget = (float)s[20];
    for (unsigned i = 0; i < GMV_LOOPS; i++) {
        c.tau_p_s[i] = (float)s[16];
        c.tau_r_s[i] = (float)s[17];
        c.lambda[i] = (float)s[18 + i];
        for (unsigned p = 0; p < PER_LOOP; p++)
            c.theta[i][p] = (float)s[26 + i * PER_LOOP + p];
    }
    bench.config = c;
    unsigned loop;
    const char *field = "", *wanted = "";
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, gmv_check(&c, &loop, &field, &wanted), field);
    gmv_bench_begin(&bench, 0);
    for (unsigned j = 0; j < GMV_LOOPS; j++) {
        bench.range.lo[j] = num_from_float((float)s[22 + 2 * j]);
        bench.range.hi[j] = num_from_float((float)s[23 + 2 * j]);
    }
    double w[GMV_LOOPS] = {0};
    bench.plant.y[0] = bench.plant.y[1] = 0;
    for (unsigned t = 0; t < AT_REST; t++) {
        struct gmv_sample sample = gmv_bench_sample(&bench, w);
        gmv_take(bench.gmv, &sample);
        (void)gmv_learn(bench.gmv, &sample, 0);
        gmv_bench_apply(&bench);
    }
}

static void expect_near(const double *row, double bound, double wanted, num_t is, const char *name)
{
    char message[96];
    (void)snprintf(message, sizeof message, "%s: case %g, step %g", name, row[0], row[1]);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(bound, wanted, (double)num_to_float(is), message);
}

static void learn(const double *row, unsigned loops, const struct gmv_sample *sample)
{
    (void)gmv_learn(bench.gmv, sample, (uint8_t)row[2]);
    for (unsigned i = 0; i < loops; i++)
        for (unsigned p = 0; p < gmv_parameters(&bench.config.shape, i); p++) {
            num_t theta = rls_theta(gmv_rls(bench.gmv, i), p);
            gmv_use(bench.gmv, i, p, theta);
            expect_near(row, 2e-5, row[11 + i * PER_LOOP + p], theta, "parameter");
        }
}

static void solve(const double *row, unsigned loops, const struct gmv_sample *sample)
{
    for (unsigned j = 0; j < GMV_LOOPS; j++)
        bench.range.fixed[j] = num_from_float((float)row[8 + j]);
    enum gmv_solved solved = gmv_solve(bench.gmv, sample, (uint8_t)row[2], &bench.range, bench.u);
    TEST_ASSERT_EQUAL(row[10] != 0 ? GMV_ONE_BY_ONE : GMV_SOLVED, solved);
    for (unsigned j = 0; j < loops; j++) {
        expect_near(row, 2e-4, row[8 + j], bench.u[j], "MV");
        bench.u[j] = num_from_float((float)row[8 + j]);
    }
    gmv_bench_apply(&bench);
}

static void step(const double *row, unsigned loops)
{
    struct gmv_sample sample = {.divisor = 1, .disturbance = {num_from_float((float)row[7])}};
    for (unsigned i = 0; i < GMV_LOOPS; i++) {
        sample.y[i] = num_from_float((float)row[3 + i]);
        sample.w[i] = num_from_float((float)row[5 + i]);
        sample.applied[i] = gmv_history_of(&bench, i);
    }
    gmv_take(bench.gmv, &sample);
    learn(row, loops, &sample);
    solve(row, loops, &sample);
}

/* Rows that are there: at most CASES. */
static unsigned read_settings(double settings[CASES][SETTINGS])
{
    FILE *f = csv_open("reference/gmv_settings.csv");
    unsigned n = 0;
    while (n < CASES && csv_row(f, settings[n], SETTINGS))
        n++;
    fclose(f);
    return n;
}

static void test_every_design_follows_the_independent_model(void)
{
    static double settings[CASES][SETTINGS];
    unsigned cases = read_settings(settings), at = CASES, steps = 0;
    FILE *f = csv_open("reference/gmv_cases.csv");
    double row[COLUMNS];
    while (csv_row(f, row, COLUMNS)) {
        if ((unsigned)row[0] != at)
            begin(settings[at = (unsigned)row[0]]);
        step(row, (unsigned)settings[at][1]);
        steps++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL_MESSAGE(cases - 1, at, "not every case was there");
    TEST_ASSERT_EQUAL(45 * cases, steps);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_design_follows_the_independent_model);
    return UNITY_END();
}
