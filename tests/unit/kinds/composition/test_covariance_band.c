/* The banded covariance (kinds/composition/covariance_band.h) against full matrices in double (dense_band.h), which leave out the same.
 *
 * Contract: each P_ij within ROUNDINGS units in the last place of sqrt(P_ii P_jj), times the steps taken, times the condition of the
 * correlations of a stage, which the completion divides by; 2 m (m + q) + 24 sums and products lie between a number and itself one step
 * later, each of which rounds once, and a measurement adds one. alpha and gains (of sqrt(P_ii alpha)/alpha) likewise. With two
 * stages nothing is left out: within the same of the whole covariance, and COVARIANCE_BAND_GROWTH a step. */
#include "covariance_case.h"
#include "dense_band.h"

#include "band_bench.h" /* its variables after names of the others that are the same */

#include "num/ud.h"

#define SEED      20261125u
#define STAGES    10
#define ROUNDINGS 90
#define UNIT      6e-8

static struct dense_band dense;
static unsigned steps;

void setUp(void)
{
    source.state = SEED;
    steps = 0;
}

void tearDown(void) {}

static void begin(size_t stages, size_t m, size_t q, bool whole)
{
    bench_band(stages, m, q);
    if (stages * m + q <= DENSE_MOST)
        dense_begin(&dense, stages, m, q, variance, whole);
}

/* ---- what is kept ---- */

static double said(size_t i, size_t e)
{
    size_t m = band.m;
    return (double)at_stage(i / m)[2 * m * m + e * m + i % m];
}

static double extras_element(size_t e, size_t f)
{
    return (double)ud_element(band.ud, band.extras, e, f);
}

/* P of two fractions of one stage or of neighbours, i <= j; of a fraction and an extra; of two extras. */
static double element(size_t i, size_t j)
{
    size_t m = band.m, n = band.stages * m, q = band.extras;
    double sum = 0;
    if (i >= n)
        return extras_element(i - n, j - n);
    if (j >= n) {
        for (size_t e = 0; e < q; e++)
            sum += said(i, e) * extras_element(e, j - n);
        return sum;
    }
    sum = (double)at_stage(i / m)[(i / m == j / m ? 0 : m * m) + i % m * m + j % m];
    for (size_t e = 0; e < q; e++)
        for (size_t f = 0; f < q; f++)
            sum += said(i, e) * extras_element(e, f) * said(j, f);
    return sum;
}

static double bound(void)
{
    return ROUNDINGS * UNIT * (steps + 1) * dense.condition +
           (dense.whole ? ((double)COVARIANCE_BAND_GROWTH - 1) * steps : 0);
}

static void agrees(void)
{
    for (size_t i = 0; i < dense.n + dense.q; i++)
        for (size_t j = i; j < dense.n + dense.q; j++) {
            if (j < dense.n && j / dense.m > i / dense.m + 1)
                continue;
            double scale = sqrt(dense.p[i][i] * dense.p[j][j]);
            TEST_ASSERT_DOUBLE_WITHIN(bound() * scale, dense.p[i][j], element(i, j));
        }
}

static void carry(size_t effort)
{
    while (covariance_band_carry_piece(&band, &step, effort)) {
    }
    TEST_ASSERT_EQUAL(ERR_OK, band.err);
    steps++;
    dense_step_of(&dense, &step);
}

static void take(const struct covariance_measurement *z)
{
    double wanted[DENSE_MOST], before[DENSE_MOST];
    for (size_t i = 0; i < dense.n + dense.q; i++)
        before[i] = dense.p[i][i];
    double of = dense_of(&dense, z);
    double alpha = dense_take(&dense, z, wanted);
    TEST_ASSERT_DOUBLE_WITHIN(bound() * of, of, (double)covariance_band_of(&band, z));
    TEST_ASSERT_DOUBLE_WITHIN(bound() * alpha, alpha, (double)covariance_band_take(&band, z, gain));
    for (size_t i = 0; i < dense.n + dense.q; i++)
        TEST_ASSERT_DOUBLE_WITHIN(bound() * sqrt(before[i] / alpha), wanted[i], (double)gain[i]);
}

static void filter(unsigned count, size_t effort)
{
    real_t slope[M_MOST];
    for (unsigned k = 0; k < count; k++) {
        carry(effort);
        agrees();
        for (unsigned sensor = 0; sensor < SENSORS; sensor++) {
            struct covariance_measurement z = draw_measurement(slope);
            take(&z);
            agrees();
        }
    }
}

static const size_t extras_tried[] = {0, 1, 3, Q_MOST};

/* ---- against full matrices ---- */

static void with_two_stages_it_is_the_whole_covariance(void)
{
    for (size_t m = 1; m <= M_MOST; m++)
        for (size_t k = 0; k < 4; k++) {
            setUp();
            begin(2, m, extras_tried[k], true);
            filter(30, AT_ONCE);
        }
}

static void with_more_stages_it_is_the_same_form_in_full_matrices(void)
{
    for (size_t m = 1; m <= M_MOST; m++)
        for (size_t k = 0; k < 4; k++) {
            setUp();
            begin(STAGES, m, extras_tried[k], false);
            filter(15, AT_ONCE);
        }
}

static void without_memory_of_vapours_it_is_so_too(void)
{
    begin(STAGES, 2, 3, false);
    draw_transition(STAGES, 2, 0);
    filter(15, AT_ONCE);
}

/* A distillation column in place of numbers that are drawn: steps of a second to an hour, with and without memory of vapours. */
static void on_a_column_it_is_so_too(void)
{
    static struct covariance_case column;
    for (unsigned kind = 0; kind < 6; kind++) {
        setUp();
        TEST_ASSERT_TRUE(
            case_begin(&column, 20, 3, kind % 2 ? 1 : 0.8, 5, pow(60, (double)(kind / 2))));
        for (size_t i = 0; i < 45; i++)
            variance[i] = i < 40 ? REAL_C(1e-3) : REAL_C(1e-2);
        for (size_t i = 0; i < 40; i++)
            column.noise[i] = REAL_C(1e-5);
        column.step.noise_count = 40;
        TEST_ASSERT_EQUAL(ERR_OK, covariance_band_begin(&band, 20, 2, 5, variance, memory));
        dense_begin(&dense, 20, 2, 5, variance, false);
        step = column.step;
        filter(8, COVARIANCE_BAND_EFFORT);
    }
}

static void extras_that_do_not_change_stay_as_they_are(void)
{
    begin(STAGES, 2, 3, false);
    for (size_t e = 0; e < 3; e++) {
        keep[e] = 1;
        grown[e] = 0;
    }
    filter(15, AT_ONCE);
}

static void an_extra_that_is_forgotten_at_once_begins_anew(void)
{
    begin(STAGES, 2, 2, false);
    keep[0] = COVARIANCE_BAND_KEEP;
    grown[0] = 1;
    filter(5, AT_ONCE);
    keep[0] = 0;
    while (covariance_band_carry_piece(&band, &step, AT_ONCE)) {
    }
    double left = (double)(COVARIANCE_BAND_KEEP * COVARIANCE_BAND_KEEP);
    TEST_ASSERT_DOUBLE_WITHIN(2 * left, 1 + left / 2, extras_element(0, 0));
}

static void noise_goes_round(void)
{
    begin(STAGES, 2, 1, false);
    step.noise_count = 7;
    for (unsigned k = 0; k < 12; k++) {
        step.noise_first = 7 * k % (2 * STAGES);
        carry(AT_ONCE);
        agrees();
    }
}

static void pieces_make_the_same_bits(void)
{
    static real_t once[4000];
    unsigned pieces = 0;
    begin(STAGES, 3, 3, false);
    filter(2, AT_ONCE);
    size_t bytes = covariance_band_bytes(STAGES, 3, 3);
    memcpy(once, memory, bytes);
    setUp();
    begin(STAGES, 3, 3, false);
    filter(2, 3 * 27);
    TEST_ASSERT_EQUAL_MEMORY(once, memory, bytes);
    while (covariance_band_carry_piece(&band, &step, 4 * 27 - 1))
        pieces++;
    TEST_ASSERT_EQUAL(2 * 4 - 1, pieces);
    while (covariance_band_carry_piece(&band, &step, 0)) /* at least one stage */
        pieces++;
    TEST_ASSERT_EQUAL(2 * 4 - 1 + 2 * STAGES - 1, pieces);
}

static void measurements_alone_leave_nothing_out(void)
{
    real_t slope[M_MOST];
    begin(STAGES, 2, 3, false);
    filter(3, AT_ONCE);
    dense.whole = true; /* of what there is now */
    for (unsigned k = 0; k < 20; k++) {
        struct covariance_measurement z = draw_measurement(slope);
        take(&z);
        agrees();
    }
}

/* Between the sweeps one fraction of a stage is another's copy, to the last digit. */
static void a_fraction_that_says_nothing_of_its_own_is_no_harm(void)
{
    for (size_t m = 2; m <= M_MOST; m++) {
        begin(2, m, 0, true);
        for (size_t s = 0; s < 2; s++) {
            real_t *p = &factors[s * column_transition_stride(m)];
            for (size_t i = 0; i < m; i++)
                p[m + i] = p[i];
        }
        filter(5, AT_ONCE);
    }
}

/* Nothing moves, nothing is measured. */
static void a_step_makes_variances_larger_by_what_is_said(void)
{
    double wanted = 1;
    begin(STAGES, 2, 0, false);
    memset(factors, 0, sizeof factors);
    for (size_t s = 0; s < STAGES; s++)
        factors[s * column_transition_stride(2)] = factors[s * column_transition_stride(2) + 3] = 1;
    step.noise_count = 0;
    for (unsigned k = 0; k < 20000; k++) {
        while (covariance_band_carry_piece(&band, &step, AT_ONCE)) {
        }
        wanted *= 1 + 1.0 / 524288;
    }
    for (size_t i = 0; i < 2 * STAGES; i++)
        TEST_ASSERT_DOUBLE_WITHIN(20000 * UNIT * wanted, wanted * (double)variance[i],
                                  element(i, i));
}

static void extremes_are_those_of_all_states(void)
{
    real_t least, most;
    double lo = 1e9, hi = 0;
    begin(STAGES, 2, 3, false);
    filter(3, AT_ONCE);
    for (size_t i = 0; i < dense.n + dense.q; i++) {
        lo = fmin(lo, dense.p[i][i]);
        hi = fmax(hi, dense.p[i][i]);
    }
    covariance_band_extremes(&band, &least, &most);
    TEST_ASSERT_DOUBLE_WITHIN(bound() * lo, lo, (double)least);
    TEST_ASSERT_DOUBLE_WITHIN(bound() * hi, hi, (double)most);
}

/* ---- limits ---- */

static void sizes_that_no_column_has_are_refused(void)
{
    draw_step(STAGES, 2, 0);
    for (size_t i = 0; i < 20; i++)
        variance[i] = 1;
    TEST_ASSERT_EQUAL(ERR_RANGE, covariance_band_begin(&band, 1, 2, 0, variance, memory));
    TEST_ASSERT_EQUAL(ERR_RANGE, covariance_band_begin(&band, 10, 0, 0, variance, memory));
    TEST_ASSERT_EQUAL(ERR_RANGE,
                      covariance_band_begin(&band, 10, COLUMN_COMPONENTS_MAX, 0, variance, memory));
    TEST_ASSERT_EQUAL(ERR_RANGE,
                      covariance_band_begin(&band, COLUMN_STAGES_MAX + 1, 1, 0, variance, memory));
    TEST_ASSERT_EQUAL(
        ERR_RANGE, covariance_band_begin(&band, 2, 1, COVARIANCE_EXTRAS_MAX + 1, variance, memory));
    TEST_ASSERT_EQUAL(ERR_OK,
                      covariance_band_begin(&band, 2, 1, COVARIANCE_EXTRAS_MAX, variance, memory));
    variance[3] = -1;
    TEST_ASSERT_EQUAL(ERR_RANGE, covariance_band_begin(&band, 2, 2, 0, variance, memory));
    variance[3] = NAN;
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, covariance_band_begin(&band, 2, 2, 0, variance, memory));
}

static void memory_is_linear_in_stages(void)
{
    TEST_ASSERT_EQUAL(sizeof(real_t) * (37 * (8 + 6) + 6), covariance_band_bytes(37, 2, 3));
    TEST_ASSERT_EQUAL(sizeof(real_t) * 2 * 2, covariance_band_bytes(2, 1, 0));
}

static void no_variance_begins_below_the_least(void)
{
    real_t least, most;
    for (size_t i = 0; i < 5; i++)
        variance[i] = 0;
    TEST_ASSERT_EQUAL(ERR_OK, covariance_band_begin(&band, 2, 2, 1, variance, memory));
    covariance_band_extremes(&band, &least, &most);
    TEST_ASSERT_TRUE(least == COVARIANCE_LEAST && most == COVARIANCE_LEAST);
}

static void is_not_taken(struct covariance_measurement z)
{
    static real_t before[4000];
    size_t bytes = covariance_band_bytes(band.stages, band.m, band.extras);
    memcpy(before, memory, bytes);
    gain[0] = gain[20] = 1;
    TEST_ASSERT_TRUE(covariance_band_take(&band, &z, gain) == 0);
    TEST_ASSERT_EQUAL_MEMORY(before, memory, bytes);
    for (size_t i = 0; i < 2 * STAGES + 3; i++)
        TEST_ASSERT_TRUE(gain[i] == 0);
}

static void a_measurement_that_is_none_leaves_everything(void)
{
    real_t slope[] = {1, 1, 1};
    struct covariance_measurement z = {
        .first = 4, .count = 2, .slope = slope, .extra = 3, .variance = 1};
    begin(STAGES, 2, 3, false);
    z.variance = 0;
    is_not_taken(z);
    z.variance = NAN;
    is_not_taken(z);
    z.variance = 1;
    slope[1] = INFINITY;
    is_not_taken(z);
    slope[1] = 1e20f; /* a number, but its square is none */
    is_not_taken(z);
    slope[1] = 1;
    z.variance = -1;
    is_not_taken(z);
    z.variance = 1;
    z.first = 5; /* of two stages */
    is_not_taken(z);
    TEST_ASSERT_TRUE(covariance_band_of(&band, &z) == 0);
    z.count = 0;
    is_not_taken(z);
    z.first = 2 * STAGES;
    z.count = 1;
    is_not_taken(z);
}

static void a_step_that_is_no_number_is_told(void)
{
    begin(STAGES, 2, 3, false);
    factors[5] = NAN;
    while (covariance_band_carry_piece(&band, &step, AT_ONCE)) {
    }
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, band.err);
}

int main(void)
{
    UNITY_BEGIN();
    printf("seed %u\n", SEED);
    RUN_TEST(with_two_stages_it_is_the_whole_covariance);
    RUN_TEST(with_more_stages_it_is_the_same_form_in_full_matrices);
    RUN_TEST(without_memory_of_vapours_it_is_so_too);
    RUN_TEST(on_a_column_it_is_so_too);
    RUN_TEST(extras_that_do_not_change_stay_as_they_are);
    RUN_TEST(an_extra_that_is_forgotten_at_once_begins_anew);
    RUN_TEST(noise_goes_round);
    RUN_TEST(pieces_make_the_same_bits);
    RUN_TEST(measurements_alone_leave_nothing_out);
    RUN_TEST(a_fraction_that_says_nothing_of_its_own_is_no_harm);
    RUN_TEST(a_step_makes_variances_larger_by_what_is_said);
    RUN_TEST(extremes_are_those_of_all_states);
    RUN_TEST(sizes_that_no_column_has_are_refused);
    RUN_TEST(memory_is_linear_in_stages);
    RUN_TEST(no_variance_begins_below_the_least);
    RUN_TEST(a_measurement_that_is_none_leaves_everything);
    RUN_TEST(a_step_that_is_no_number_is_told);
    return UNITY_END();
}
