/* The covariance of a Kalman filter as U D U' (kinds/composition/covariance_ud.h) beside a dense one in double (covariance_case.h), which begins
 * with the very numbers that the float one has.
 *
 * Contract of a step, u = 2^-24: P_ij within ROUNDINGS(K) u a_i a_j of the dense one. a_i: standard deviations taken through the
 * magnitudes of the transition's factors (and what noise brings), which bounds every intermediate of row i. K: roundings that an
 * element of the root S goes through one after the other: m + 2 at each of 2 N stages of the sweeps, 2 m + 4 in each of the 2 m N
 * reflections, and a few at both ends; P has each twice. They are independent, so that six of their standard deviations are
 * 6 sqrt(K) u.
 *
 * Contract of a measurement, H = sum |h_i| sd_i, e = ROUNDINGS(n + q) u, which is what sums of n + q products have: alpha within e H^2,
 * gains within e (sd_i H + H^2 |K_i|)/alpha, P_ij within e (sd_i + H |K_i|) (sd_j + H |K_j|), all of before. */
#include <stdalign.h>
#include <stdio.h>

#include "covariance_case.h"
#include "kinds/composition/covariance_ud.h"
#include "num/ud.h"
#include "unity.h"

#define U            5.9604644775390625e-8
#define ROUNDINGS(k) (6 * sqrt((double)(k)))
#define CANARY       123456.75f
#define H_S          30.0

static struct covariance_case kase;
static struct covariance_ud ud;
static alignas(8) real_t memory[12000];

void setUp(void) {}

void tearDown(void) {}

static void begin(size_t stages, size_t c, double efficiency, size_t extras, double h)
{
    real_t variance[CASE_STATES];
    TEST_ASSERT_TRUE(case_begin(&kase, stages, c, efficiency, extras, h));
    for (size_t i = 0; i < case_all(&kase); i++) /* standard deviations of 0.01 to 0.1 */
        variance[i] = (real_t)pow(10, -3 + case_random(&kase));
    size_t bytes = covariance_ud_bytes(stages, c - 1, extras);
    TEST_ASSERT_TRUE(bytes < sizeof memory);
    memory[bytes / sizeof *memory] = CANARY;
    TEST_ASSERT_EQUAL(ERR_OK, covariance_ud_begin(&ud, stages, c - 1, extras, variance, memory));
    for (size_t i = 0; i < COLUMN_STATES_MAX; i++) /* what is behind the last one is nobody's */
        kase.noise[i] = i < kase.n ? (real_t)(1e-6 * (1.5 + case_random(&kase))) : 1;
}

/* The dense one begins again with what the float one has. */
static void take_over(void)
{
    size_t all = case_all(&kase);
    for (size_t i = 0; i < all; i++)
        for (size_t j = 0; j <= i; j++) {
            double sum = 0;
            for (size_t k = i; k < all; k++) {
                const real_t *column = ud.ud + ud_count(k);
                sum += (i == k ? 1 : (double)column[i]) * (j == k ? 1 : (double)column[j]) *
                       (double)column[k];
            }
            kase.p[i][j] = kase.p[j][i] = sum;
        }
}

static void compare(const double *scale)
{
    static double want[CASE_STATES][CASE_STATES];
    memcpy(want, kase.p, sizeof want);
    take_over();
    for (size_t i = 0; i < case_all(&kase); i++)
        for (size_t j = 0; j <= i; j++)
            TEST_ASSERT_DOUBLE_WITHIN(scale[i] * scale[j], want[i][j], kase.p[i][j]);
    TEST_ASSERT_TRUE(memory[covariance_ud_bytes(ud.stages, ud.m, ud.extras) / sizeof *memory] ==
                     CANARY);
}

static void carry(size_t effort)
{
    while (covariance_ud_carry_piece(&ud, &kase.step, effort)) {
    }
}

static double least_d(void)
{
    real_t least, most;
    ud_extremes(ud.ud, case_all(&kase), &least, &most);
    return (double)least;
}

/* a_i of the head, without what noise brings. */
static void bounds_of_a_step(double *a)
{
    for (size_t i = 0; i < case_all(&kase); i++)
        a[i] = sqrt(kase.p[i][i]);
    for (size_t e = 0; e < kase.extras; e++)
        for (size_t i = 0; i < kase.n; i++)
            a[i] += fabs((double)kase.push[e * kase.n + i]) * a[kase.n + e];
    case_apply(&kase.transition, a, true);
}

static void a_step_agrees(void)
{
    double a[CASE_STATES], m = (double)ud.m, stages = (double)ud.stages;
    take_over();
    bounds_of_a_step(a);
    carry(COVARIANCE_UD_EFFORT);
    TEST_ASSERT_EQUAL(ERR_OK, covariance_ud_err(&ud));
    case_carry(&kase);
    double k = 2 * stages * (m + 2) + 2 * stages * m * (2 * m + 4) + 20;
    for (size_t i = 0; i < case_all(&kase); i++)
        a[i] = (a[i] + sqrt(kase.p[i][i])) * sqrt(2 * ROUNDINGS(k) * U);
    compare(a);
    TEST_ASSERT_TRUE(least_d() > 0);
}

static void a_measurement_agrees(const struct covariance_measurement *z)
{
    double sd[CASE_STATES], want[CASE_STATES], h = 0, e = ROUNDINGS(case_all(&kase)) * U;
    real_t gain[CASE_STATES];
    take_over();
    for (size_t i = 0; i < case_all(&kase); i++) {
        sd[i] = sqrt(kase.p[i][i]);
        h += fabs(case_slope(&kase, z, i)) * sd[i];
    }
    double of = (double)covariance_ud_of(&ud, z), alpha = (double)covariance_ud_take(&ud, z, gain);
    double exact = case_take(&kase, z, want);
    TEST_ASSERT_DOUBLE_WITHIN(e * h * h, exact - (double)z->variance, of);
    TEST_ASSERT_DOUBLE_WITHIN(e * (h * h + (double)z->variance), exact, alpha);
    for (size_t i = 0; i < case_all(&kase); i++) {
        double own = h * fabs(want[i]);
        TEST_ASSERT_DOUBLE_WITHIN(e * h * (sd[i] + own) / exact, want[i], (double)gain[i]);
        sd[i] = (sd[i] + own) * sqrt(e);
    }
    compare(sd);
    TEST_ASSERT_TRUE(least_d() > 0);
}

/* Temperature of a stage, by slopes of either sign, or an analysis of one fraction there with the last extra as its offset. */
static void measure(size_t stage, bool analysis, double sd)
{
    real_t slope[3];
    for (size_t j = 0; j < ud.m; j++)
        slope[j] = (real_t)(100 * (case_random(&kase) - 0.5));
    struct covariance_measurement z = {.first = stage * ud.m,
                                       .count = ud.m,
                                       .slope = slope,
                                       .extra = COVARIANCE_EXTRAS_MAX,
                                       .variance = (real_t)(sd * sd)};
    if (analysis) {
        slope[0] = z.extra_slope = 1;
        z.first += ud.m - 1;
        z.count = 1;
        z.extra = ud.extras ? ud.extras - 1 : 0;
    }
    a_measurement_agrees(&z);
}

/* Steps with noise going round the column, measurements in between. */
static void a_filter_agrees(unsigned steps, double sensor_sd)
{
    for (unsigned t = 0; t < steps; t++) {
        kase.step.noise_first = (size_t)t * 5 % kase.n;
        kase.step.noise_count = 5 < kase.n ? 5 : kase.n;
        a_step_agrees();
        measure((size_t)t * 3 % ud.stages, false, sensor_sd);
        measure(ud.stages - 1, t % 2, t % 2 ? 1e-3 : sensor_sd);
    }
}

static void steps_and_measurements_are_the_dense_ones_on_every_column(void)
{
    static const size_t sizes[] = {4, 5, 7, 12};
    for (size_t c = 2; c <= 4; c++)
        for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++)
            for (size_t q = 0; q <= 5; q++) {
                begin(sizes[k], c, q % 3 == 0 ? 1 : q % 3 == 1 ? 0.7 : 0.3, q, H_S);
                a_filter_agrees(4, 0.2);
            }
}

static void steps_and_measurements_are_the_dense_ones_on_tall_columns(void)
{
    for (size_t c = 2; c <= 4; c++) {
        begin(37, c, 0.8, 5, H_S);
        a_filter_agrees(3, 0.2);
        begin(36, c, 1, 3, H_S);
        a_filter_agrees(3, 0.2);
    }
}

static void steps_of_any_length_are_the_dense_ones(void)
{
    for (double h = 0.1; h < 1e5; h *= 10) {
        begin(9, 3, 0.8, 3, h);
        a_filter_agrees(4, 0.2);
    }
}

/* Sensor noise of 1e-3 K beside fractions known to 0.1, which are tens of kelvins: eight decades of variance and more. */
static void sensors_far_better_than_what_is_known_cost_no_sign(void)
{
    for (size_t c = 2; c <= 4; c++) {
        begin(12, c, 0.8, 3, H_S);
        a_filter_agrees(8, 1e-3);
    }
}

static void noise_reaches_every_fraction_that_is_named_and_no_other(void)
{
    begin(6, 3, 0.8, 2, H_S);
    for (size_t first = 0; first < kase.n; first++)
        for (size_t count = 0; count <= kase.n; count += 4) {
            kase.step.noise_first = first;
            kase.step.noise_count = count;
            a_step_agrees();
        }
}

static void nothing_is_known_of_an_extra_that_is_not_kept(void)
{
    begin(6, 3, 0.8, 3, H_S);
    kase.keep[0] = kase.keep[1] = 0;
    kase.grown[1] = REAL_C(0.25);
    case_dense(&kase);
    carry(COVARIANCE_UD_EFFORT);
    take_over();
    TEST_ASSERT_DOUBLE_WITHIN(1e-29, (double)COVARIANCE_LEAST, kase.p[kase.n][kase.n]);
    TEST_ASSERT_DOUBLE_WITHIN(0.25 * 4 * U, 0.25, kase.p[kase.n + 1][kase.n + 1]);
    for (size_t i = 0; i < kase.n;
         i++) /* the first one has a deviation of 1e-9 at most in common */
        TEST_ASSERT_DOUBLE_WITHIN(1e-9 * sqrt(kase.p[i][i]) * 2, 0, kase.p[i][kase.n]);
}

static void how_a_step_is_cut_does_not_change_it(void)
{
    static real_t first[12000];
    static const size_t efforts[] = {1, 37, 400, COVARIANCE_UD_EFFORT, 1000000};
    for (size_t c = 2; c <= 4; c++)
        for (size_t k = 0; k < sizeof efforts / sizeof *efforts; k++) {
            begin(11, c, 0.8, 4, H_S);
            for (unsigned t = 0; t < 3; t++) {
                kase.step.noise_first = 3 * t;
                kase.step.noise_count = 4;
                carry(efforts[k]);
                measure(4, false, 0.2);
            }
            size_t bytes = ud_count(case_all(&kase)) * sizeof(real_t);
            if (k == 0)
                memcpy(first, memory, bytes);
            else
                TEST_ASSERT_EQUAL_MEMORY(first, memory, bytes);
        }
}

static void a_piece_does_no_more_than_it_is_told_to(void)
{
    size_t pieces = 0;
    begin(37, 3, 0.8, 3, H_S);
    kase.step.noise_count = 8;
    kase.step.noise_first = 60;
    while (covariance_ud_carry_piece(&ud, &kase.step, 1))
        pieces++;
    /* extras, stages up and back, variances of extras, and noise of two fractions at once */
    TEST_ASSERT_EQUAL(3 + 37 + 37 + 3 + 4, pieces + 1);
    for (pieces = 0; covariance_ud_carry_piece(&ud, &kase.step, COVARIANCE_UD_EFFORT);)
        pieces++;
    TEST_ASSERT_TRUE(pieces >= 3);
}

/* ---- positive whatever comes ---- */

static void run_blind(unsigned steps, double sensor_sd)
{
    real_t gain[CASE_STATES], slope[3] = {80, -30, 50}, least, most;
    for (unsigned t = 0; t < steps; t++) {
        carry(COVARIANCE_UD_EFFORT);
        for (size_t s = 1; s < ud.stages; s += 3) {
            struct covariance_measurement z = {.first = s * ud.m,
                                               .count = ud.m,
                                               .slope = slope,
                                               .extra = s % 2 ? ud.extras : 0,
                                               .extra_slope = 1,
                                               .variance = (real_t)(sensor_sd * sensor_sd)};
            TEST_ASSERT_TRUE(covariance_ud_take(&ud, &z, gain) > 0);
        }
        TEST_ASSERT_EQUAL(ERR_OK, covariance_ud_err(&ud));
        TEST_ASSERT_TRUE(least_d() > 0);
    }
    covariance_ud_extremes(&ud, &least, &most);
    TEST_ASSERT_TRUE(least > 0);
    TEST_ASSERT_TRUE(isfinite(most));
}

static void d_stays_positive_without_noise_over_thousands_of_steps(void)
{
    for (size_t c = 2; c <= 4; c++)
        for (unsigned full = 0; full < 2; full++) {
            begin(8, c, full ? 1 : 0.8, 3, H_S);
            memset(kase.grown, 0, sizeof kase.grown);
            for (size_t e = 0; e < 3; e++)
                kase.keep[e] = 1;
            run_blind(5000, 1e-3);
        }
}

static void d_stays_positive_where_deviations_die_out_at_once(void)
{
    for (double h = 1e6; h < 1e16; h *= 1e3) {
        begin(8, 3, 0.8, 0, h);
        run_blind(200, 1e-3);
    }
}

/* What is known exactly to begin with has a variance all the same. */
static void nothing_is_known_exactly(void)
{
    real_t none[CASE_STATES] = {0};
    begin(8, 3, 0.8, 2, H_S);
    TEST_ASSERT_EQUAL(ERR_OK, covariance_ud_begin(&ud, 8, 2, 2, none, memory));
    TEST_ASSERT_TRUE(least_d() >= (double)COVARIANCE_LEAST);
    run_blind(100, 0.1);
}

/* ---- small things ---- */

static void extremes_are_of_the_diagonal(void)
{
    real_t least, most;
    begin(10, 3, 0.8, 3, H_S);
    for (unsigned t = 0; t < 3; t++)
        carry(COVARIANCE_UD_EFFORT);
    measure(4, false, 0.1);
    take_over();
    covariance_ud_extremes(&ud, &least, &most);
    double low = kase.p[0][0], high = low, e = ROUNDINGS(case_all(&kase)) * U;
    for (size_t i = 1; i < case_all(&kase); i++) {
        low = fmin(low, kase.p[i][i]);
        high = fmax(high, kase.p[i][i]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(e * low, low, (double)least);
    TEST_ASSERT_DOUBLE_WITHIN(e * high, high, (double)most);
}

static void what_is_no_covariance_is_refused(void)
{
    real_t variance[CASE_STATES] = {0};
    TEST_ASSERT_EQUAL(ERR_OK, covariance_ud_begin(&ud, 4, 1, 0, variance, memory));
    TEST_ASSERT_EQUAL(ERR_RANGE, covariance_ud_begin(&ud, 1, 1, 0, variance, memory));
    TEST_ASSERT_EQUAL(ERR_RANGE, covariance_ud_begin(&ud, 4, 0, 0, variance, memory));
    TEST_ASSERT_EQUAL(ERR_RANGE,
                      covariance_ud_begin(&ud, 4, COLUMN_COMPONENTS_MAX, 0, variance, memory));
    TEST_ASSERT_EQUAL(ERR_RANGE,
                      covariance_ud_begin(&ud, COLUMN_STAGES_MAX + 1, 2, 0, variance, memory));
    TEST_ASSERT_EQUAL(ERR_RANGE,
                      covariance_ud_begin(&ud, 4, 2, COVARIANCE_EXTRAS_MAX + 1, variance, memory));
    TEST_ASSERT_EQUAL(ERR_OK,
                      covariance_ud_begin(&ud, 4, 2, COVARIANCE_EXTRAS_MAX, variance, memory));
    variance[9] = -1;
    TEST_ASSERT_EQUAL(ERR_OK, covariance_ud_begin(&ud, 4, 2, 1, variance, memory));
    TEST_ASSERT_EQUAL(ERR_RANGE, covariance_ud_begin(&ud, 4, 2, 2, variance, memory));
    variance[9] = NAN;
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, covariance_ud_begin(&ud, 4, 2, 2, variance, memory));
    variance[9] = INFINITY;
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, covariance_ud_begin(&ud, 4, 2, 2, variance, memory));
}

static void a_step_that_leaves_no_number_says_so_once(void)
{
    begin(6, 3, 0.8, 2, H_S);
    real_t kept = kase.numbers[30];
    kase.numbers[30] = NAN;
    carry(COVARIANCE_UD_EFFORT);
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, covariance_ud_err(&ud));
    kase.numbers[30] = kept;
    begin(6, 3, 0.8, 2, H_S);
    kase.push[kase.n + 3] = INFINITY;
    carry(COVARIANCE_UD_EFFORT);
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, covariance_ud_err(&ud));
    begin(6, 3, 0.8, 2, H_S);
    carry(COVARIANCE_UD_EFFORT);
    TEST_ASSERT_EQUAL(ERR_OK, covariance_ud_err(&ud));
}

static void a_measurement_that_is_none_changes_nothing(void)
{
    real_t before[400], gain[CASE_STATES], slope[] = {1, 2};
    begin(6, 3, 0.8, 2, H_S);
    carry(COVARIANCE_UD_EFFORT);
    size_t bytes = ud_count(case_all(&kase)) * sizeof(real_t);
    TEST_ASSERT_TRUE(bytes <= sizeof before);
    memcpy(before, memory, bytes);
    struct covariance_measurement z = {.first = 4, .count = 2, .slope = slope, .extra = 9};
    for (int k = 0; k < 4; k++) {
        static const float variances[] = {0, -1, NAN, 1};
        z.variance = variances[k];
        slope[1] = k == 3 ? INFINITY : 2;
        TEST_ASSERT_TRUE(covariance_ud_take(&ud, &z, gain) == 0);
        TEST_ASSERT_EQUAL_MEMORY(before, memory, bytes);
        for (size_t i = 0; i < case_all(&kase); i++)
            TEST_ASSERT_TRUE(gain[i] == 0);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(steps_and_measurements_are_the_dense_ones_on_every_column);
    RUN_TEST(steps_and_measurements_are_the_dense_ones_on_tall_columns);
    RUN_TEST(steps_of_any_length_are_the_dense_ones);
    RUN_TEST(sensors_far_better_than_what_is_known_cost_no_sign);
    RUN_TEST(noise_reaches_every_fraction_that_is_named_and_no_other);
    RUN_TEST(nothing_is_known_of_an_extra_that_is_not_kept);
    RUN_TEST(how_a_step_is_cut_does_not_change_it);
    RUN_TEST(a_piece_does_no_more_than_it_is_told_to);
    RUN_TEST(d_stays_positive_without_noise_over_thousands_of_steps);
    RUN_TEST(d_stays_positive_where_deviations_die_out_at_once);
    RUN_TEST(nothing_is_known_exactly);
    RUN_TEST(extremes_are_of_the_diagonal);
    RUN_TEST(what_is_no_covariance_is_refused);
    RUN_TEST(a_step_that_leaves_no_number_says_so_once);
    RUN_TEST(a_measurement_that_is_none_changes_nothing);
    return UNITY_END();
}
