/* Recursive least squares beside trajectories that an independent model in double has written from docs/methods/self-tuning.md
 * (tests/reference/self_tuning_reference.py).
 *
 * Contract, float and fixed: error, v, trace (relative) and parameters within 5e-5 of the model's. A sample may round by n
 * steps of 2^-24 of what is of order 1 here; 60 samples with 12 parameters make that 4.3e-5. A rule read otherwise than it
 * stands on the page is 1e-3 and more away. */
#include <stdalign.h>
#include <stdio.h>

#include "csv.h"
#include "identify/rls.h"
#include "unity.h"

#define CASES 64
#define WIDTH 12
#define BOUND 5e-5

static alignas(8) char memory[4096];
static struct rls *const rls = (struct rls *)(void *)memory;

void setUp(void) {}
void tearDown(void) {}

/* Rows that are there: at most CASES. */
static unsigned read_settings(double settings[CASES][16])
{
    FILE *f = csv_open("reference/rls_settings.csv");
    unsigned n = 0;
    while (n < CASES && csv_row(f, settings[n], 16))
        n++;
    fclose(f);
    return n;
}

static void begin(const double *s)
{
    static float p0[RLS_MAX], lo[RLS_MAX], hi[RLS_MAX];
    num_t theta[RLS_MAX];
    for (unsigned i = 0; i < RLS_MAX; i++) {
        p0[i] = (float)s[11];
        theta[i] = num_from_float((float)s[12]);
    }
    lo[0] = (float)s[13];
    hi[0] = (float)s[14];
    struct rls_settings settings = {.n = (uint8_t)s[1],
                                    .forgetting = (uint8_t)s[2],
                                    .correction = (uint8_t)s[3],
                                    .forget = (float)s[4],
                                    .forget_least = (float)s[5],
                                    .sigma0 = (float)s[6],
                                    .memory = (float)s[6],
                                    .trace = (float)s[7],
                                    .rate = (float)s[8],
                                    .error_most = (float)s[9],
                                    .normalise = s[10] != 0,
                                    .p0 = p0,
                                    .lo = lo,
                                    .hi = hi};
    const char *field = "", *wanted = "";
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, rls_check(&settings, &field, &wanted), field);
    rls_init(rls, &settings, theta);
}

static void expect_near(const double *row, double what, double wanted, const char *name)
{
    char message[96];
    (void)snprintf(message, sizeof message, "%s: case %g, sample %g", name, row[0], row[1]);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(BOUND, wanted, what, message);
}

static void step(const double *row, unsigned n)
{
    num_t phi[WIDTH];
    for (unsigned i = 0; i < n; i++)
        phi[i] = num_from_float((float)row[6 + i]);
    num_t e = rls_step(rls, phi, num_from_float((float)row[2]), true);
    expect_near(row, (double)num_to_float(e), row[3], "error");
    expect_near(row, (double)rls_forgot(rls), row[4], "v");
    expect_near(row, (double)rls_trace(rls) / row[5], 1, "trace");
    for (unsigned i = 0; i < n; i++)
        expect_near(row, (double)num_to_float(rls_theta(rls, i)), row[6 + WIDTH + i], "theta");
}

static void test_every_rule_follows_the_independent_model(void)
{
    static double settings[CASES][16];
    unsigned cases = read_settings(settings), at = CASES, samples = 0;
    FILE *f = csv_open("reference/rls_cases.csv");
    double row[6 + 2 * WIDTH];
    while (csv_row(f, row, 6 + 2 * WIDTH)) {
        if ((unsigned)row[0] != at)
            begin(settings[at = (unsigned)row[0]]);
        step(row, (unsigned)settings[at][1]);
        samples++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL_MESSAGE(cases - 1, at, "not every case was there");
    TEST_ASSERT_GREATER_THAN(20 * cases, samples);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_rule_follows_the_independent_model);
    return UNITY_END();
}
