/* The kind `state_law` on the pilot column, against matrices in long double and a law in double precision (tests/reference/state_law_reference.py).
 * Contract, in float: matrices within 1e-4 of the largest element of their own row, weights of F, G and Tf within 2e-3 of the largest of theirs. */
#include "state_law_bench.h"

void setUp(void)
{
    bench_pilot();
}

void tearDown(void)
{
    workspace_share(NULL);
}

/* ---- matrices ---- */

static double worst_of(const char *what, const struct matrix *m)
{
    double worst = 0;
    for (unsigned i = 0; i < m->rows; i++) {
        double wanted[16], most = 0, off = 0;
        reference(what, i, wanted, m->cols);
        for (unsigned k = 0; k < m->cols; k++) {
            most = fmax(most, fabs(wanted[k]));
            off = fmax(off, fabs(wanted[k] - (double)m->at[i][k]));
        }
        if (most > 1e-12)
            worst = fmax(worst, off / most);
        else
            TEST_ASSERT_TRUE(off < 1e-7);
    }
    printf("%s: %.2e of the largest element of its row at most\n", what, worst);
    return worst;
}

static void matrices_are_those_of_differences_in_long_double(void)
{
    static struct state_law_job job;
    by_feed();
    state_law_job_of_column(&job, &settings, setup.input, setup.inputs, &record);
    while (job.phase <= STATE_LAW_PHASE_LINEAR)
        (void)state_law_job_piece(&job);
    TEST_ASSERT_EQUAL(STATE_LAW_PHASE_SAMPLE, job.phase);
    TEST_ASSERT_TRUE(worst_of("a", &job.linear.plant.a) < 1e-4);
    TEST_ASSERT_TRUE(worst_of("b", &job.linear.plant.b) < 1e-4);
    job.linear.seen.rows = 6;
    TEST_ASSERT_TRUE(worst_of("seen", &job.linear.seen) < 1e-4);
    double wanted[2];
    for (unsigned i = 0; i < 12; i++) {
        reference("e", i, wanted, 2);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * 5e-2, wanted[0], (double)job.linear.plant.e.at[i][0]);
    }
}

/* ---- the law ---- */

static void law_is(const char *what, unsigned inputs)
{
    double wanted[8], off = 0, most = 0;
    char name[40];
    for (unsigned i = 0; i < 2; i++) {
        snprintf(name, sizeof name, "f_%s", what);
        reference(name, i, wanted, inputs);
        for (unsigned k = 0; k < inputs; k++) {
            most = fmax(most, fabs(wanted[k]));
            off = fmax(off, fabs(wanted[k] - (double)block()->found.f[i][k]));
        }
        snprintf(name, sizeof name, "g_%s", what);
        reference(name, i, wanted, 2);
        for (unsigned k = 0; k < 2; k++) {
            most = fmax(most, fabs(wanted[k]));
            off = fmax(off, fabs(wanted[k] - (double)block()->found.g[i][k]));
        }
    }
    printf("%s: weights within %.2e of the largest, radius %.5f, by inputs %.5f, left %.3f %%, %u pieces\n",
           what, off / most, (double)shown("radius"), (double)shown("radius_by_inputs"),
           (double)shown("left_of_F"), pieces);
    TEST_ASSERT_TRUE(off < 2e-3 * most);
}

static void the_law_of_the_pilot_column_is_that_in_double_precision(void)
{
    configure(false);
    design();
    TEST_ASSERT_EQUAL_MESSAGE(STATE_LAW_DONE, block()->stage, told());
    law_is("temperatures", 8);
    TEST_ASSERT_EQUAL_FLOAT(0, shown("index_1"));
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0.59343f, shown("K_star_1"));
    TEST_ASSERT_FLOAT_WITHIN(0.02f, 8.53f, shown("condition"));
    TEST_ASSERT_EQUAL_FLOAT(10, shown("zeros"));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.8631f, shown("outermost_zero"));
}

static void the_law_with_the_feed_measured_has_its_columns(void)
{
    by_feed();
    configure(false);
    design();
    TEST_ASSERT_EQUAL_MESSAGE(STATE_LAW_DONE, block()->stage, told());
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.75f, block()->found.f[0][6]);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.86667f, block()->found.f[1][6]);
    law_is("feed", 7);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(matrices_are_those_of_differences_in_long_double);
    RUN_TEST(the_law_of_the_pilot_column_is_that_in_double_precision);
    RUN_TEST(the_law_with_the_feed_measured_has_its_columns);
    return UNITY_END();
}
