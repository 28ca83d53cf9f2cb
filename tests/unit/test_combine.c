/* commission/combine.[ch]: what several tests of one element say together.
 *
 * Contract
 *   known and known     weighted by variances where the shapes are of one kind, else only the gain; the other plausible shape and
 *                       the correlations are those of the surer test; a disagreement widens the deviation
 *   ramp and ramp       by their slopes, whatever lag stands for the integrator
 *   ramp and lag        they contradict each other, and the later counts
 *   open, then known    the later counts
 *   known, then slow    the later counts; known, then unknown: nothing changes
 *   open, then none     settled only where the later test was longer; a known element is never settled as none
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "commission/combine.h"
#include "lti/fopdt.h"
#include "step_records.h"
#include "unity.h"

#define SEED 20240713u

#define KINDS (SHAPE_SLOW + 1)

void setUp(void) {}
void tearDown(void) {}

/* Deviations of a tenth of the times, and of the residence time. */
static struct shape_found shape(enum shape_kind kind, double gain, double sd, double lag_s,
                                double dead_s)
{
    static const uint8_t parameters[] = {1, 1, 3, 4, 5, 3, 3, 3};
    struct shape_found f = {
        .kind = (uint8_t)kind,
        .parameters = parameters[kind],
        .shape = {.gain = (real_t)gain, .dead_time_s = (real_t)dead_s, .lag_s = (real_t)lag_s}};
    f.sd[SHAPE_GAIN] = (real_t)sd;
    f.sd[SHAPE_DEAD] = (real_t)(0.1 * dead_s);
    f.sd[SHAPE_LAG] = f.residence_sd_s = (real_t)(0.1 * lag_s);
    if (kind == SHAPE_TWO_LAGS || kind == SHAPE_TWO_WITH_ZERO) {
        f.shape.square_s2 = (real_t)(0.2 * lag_s * lag_s);
        f.sd[SHAPE_SQUARE] = (real_t)(0.02 * lag_s * lag_s);
    }
    if (kind == SHAPE_TWO_WITH_ZERO) {
        f.shape.zero_s = (real_t)(-0.3 * lag_s);
        f.sd[SHAPE_ZERO] = (real_t)(0.03 * lag_s);
    }
    return f;
}

/* ---- two that are known ---- */

static void two_tests_of_one_shape_count_by_how_well_they_know_each_parameter(void)
{
    struct shape_found sum = shape(SHAPE_TWO_WITH_ZERO, 1.0, 0.1, 100, 20);
    struct shape_found next = shape(SHAPE_TWO_WITH_ZERO, 1.2, 0.2, 110, 22);
    next.sd[SHAPE_LAG] = 20;
    next.sd[SHAPE_DEAD] = 4;
    next.sd[SHAPE_SQUARE] = 400;
    next.shape.zero_s = REAL_C(-33.0);
    next.sd[SHAPE_ZERO] = 6;
    next.residence_sd_s = 20;
    sum.residence_drawn_sd_s = 4;
    next.residence_drawn_sd_s = 3;
    combine_shapes(&sum, &next, false);
    TEST_ASSERT_EQUAL_UINT8(SHAPE_TWO_WITH_ZERO, sum.kind);
    TEST_ASSERT_EQUAL_UINT8(5, sum.parameters);
    /* deviations of 1 and 2: weights of 4 and 1, and the root of 4/5 of the smaller deviation */
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, (4 * 1.0 + 1.2) / 5, (double)sum.shape.gain);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, (4 * 100 + 110) / 5.0, (double)sum.shape.lag_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, (4 * 20 + 22) / 5.0, (double)sum.shape.dead_time_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-1, (4 * 2000 + 2420) / 5.0, (double)sum.shape.square_s2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, (4 * -30 - 33) / 5.0, (double)sum.shape.zero_s);
    static const double sd[SHAPE_PARAMETERS] = {0.1, 2, 10, 200, 3};
    for (unsigned i = 0; i < SHAPE_PARAMETERS; i++) /* the squares are 1.05 deviations apart */
        TEST_ASSERT_DOUBLE_WITHIN(0.1 * sd[i], sd[i] * sqrt(0.8), (double)sum.sd[i]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 10 * sqrt(0.8), (double)sum.residence_sd_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 12 / 5.0, (double)sum.residence_drawn_sd_s);
}

/* One test tells dead time and lag apart, the other one does not, but both know their sum. */
static void the_residence_time_is_joined_by_itself_and_the_lag_is_what_it_leaves(void)
{
    for (unsigned order = 0; order < 2; order++) {
        struct shape_found a = shape(SHAPE_ONE_LAG, 1.0, 0.1, 100, 20);
        struct shape_found b = shape(SHAPE_ONE_LAG, 1.0, 0.2, 60, 59);
        a.residence_sd_s = b.residence_sd_s = 1;
        a.sd[SHAPE_DEAD] = 1;
        a.sd[SHAPE_LAG] = 30;
        b.sd[SHAPE_DEAD] = b.sd[SHAPE_LAG] = 30;
        struct shape_found sum = order ? b : a;
        combine_shapes(&sum, order ? &a : &b, false);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 119.5, (double)shape_residence_s(&sum.shape));
        TEST_ASSERT_DOUBLE_WITHIN(0.1, 20, (double)sum.shape.dead_time_s);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, sqrt(0.5), (double)sum.residence_sd_s);
    }
}

static void a_small_gain_counts_by_how_well_it_is_known_too(void)
{
    struct shape_found sum = shape(SHAPE_ONE_LAG, 1.0e-4, 1e-6, 100, 20);
    struct shape_found next = shape(SHAPE_ONE_LAG, 1.01e-4, 2e-6, 100, 20);
    combine_shapes(&sum, &next, false);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, (4 * 1.0e-4 + 1.01e-4) / 5, (double)sum.shape.gain);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 1e-6 * sqrt(0.8), (double)sum.sd[SHAPE_GAIN]);
}

static void a_parameter_that_a_shape_does_not_have_stays_none(void)
{
    struct shape_found sum = shape(SHAPE_ONE_LAG, 1.0, 0.1, 100, 20), next = sum;
    combine_shapes(&sum, &next, false);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)sum.shape.square_s2);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)sum.sd[SHAPE_SQUARE]);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)sum.shape.zero_s);
    sum = next = shape(SHAPE_TWO_LAGS, 1.0, 0.1, 100, 20);
    combine_shapes(&sum, &next, false);
    TEST_ASSERT_DOUBLE_WITHIN(200 * sqrt(0.5) * 1e-3, 200 * sqrt(0.5),
                              (double)sum.sd[SHAPE_SQUARE]);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)sum.shape.zero_s);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)sum.sd[SHAPE_ZERO]);
}

static void tests_that_disagree_are_less_sure_than_they_say(void)
{
    struct shape_found sum = shape(SHAPE_ONE_LAG, 1.0, 0.1, 100, 20);
    struct shape_found next = shape(SHAPE_ONE_LAG, 1.6, 0.1, 160, 20);
    next.sd[SHAPE_LAG] = next.residence_sd_s = 10;
    combine_shapes(&sum, &next, false);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.3, (double)sum.shape.gain);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.3, (double)sum.sd[SHAPE_GAIN]); /* half of the difference */
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 130, (double)sum.shape.lag_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 30, (double)sum.sd[SHAPE_LAG]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 30, (double)sum.residence_sd_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 2 * sqrt(0.5), (double)sum.sd[SHAPE_DEAD]); /* that agrees */
}

static void more_tests_make_an_element_surer_and_their_order_does_not_matter(void)
{
    struct shape_found tests[4], sum[2];
    struct random_source r = {SEED};
    for (int i = 0; i < 4; i++)
        tests[i] = shape(SHAPE_TWO_LAGS, 1.0 + 0.02 * normal(&r), 0.05 + 0.02 * i,
                         100 + 5 * normal(&r), 20);
    for (int order = 0; order < 2; order++) {
        sum[order] = tests[order ? 3 : 0];
        for (int i = 1; i < 4; i++) {
            double before = (double)sum[order].sd[SHAPE_GAIN];
            combine_shapes(&sum[order], &tests[order ? 3 - i : i], false);
            TEST_ASSERT_TRUE((double)sum[order].sd[SHAPE_GAIN] < before);
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, (double)sum[0].shape.gain, (double)sum[1].shape.gain);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, (double)sum[0].shape.lag_s, (double)sum[1].shape.lag_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-1, (double)sum[0].shape.square_s2, (double)sum[1].shape.square_s2);
}

/* By gain or by residence time; whichever came first. */
static void of_two_shapes_the_surer_stays_and_the_gain_is_that_of_both(void)
{
    for (unsigned n = 0; n < 4; n++) {
        struct shape_found a = shape(SHAPE_ONE_LAG, 1.0, 0.1, 100, 20);
        struct shape_found b = shape(SHAPE_TWO_LAGS, 1.1, 0.1, 90, 10);
        b.sd[SHAPE_GAIN] = n < 2 ? REAL_C(0.05) : REAL_C(0.1);
        b.residence_sd_s = n < 2 ? 12 : 1;
        struct shape_found sum = n % 2 ? b : a;
        combine_shapes(&sum, n % 2 ? &a : &b, false);
        TEST_ASSERT_EQUAL_UINT8(SHAPE_TWO_LAGS, sum.kind);
        TEST_ASSERT_EQUAL_UINT8(4, sum.parameters);
        TEST_ASSERT_EQUAL_FLOAT(90.0f, (float)sum.shape.lag_s);
        TEST_ASSERT_EQUAL_FLOAT((float)b.sd[SHAPE_LAG], (float)sum.sd[SHAPE_LAG]);
        TEST_ASSERT_EQUAL_FLOAT((float)b.residence_sd_s, (float)sum.residence_sd_s);
        TEST_ASSERT_EQUAL_FLOAT(10.0f, (float)sum.shape.dead_time_s);
        double gain = n < 2 ? (1.0 + 4 * 1.1) / 5 : 1.05,
               sd = n < 2 ? 0.1 / sqrt(5) : 0.1 / sqrt(2);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, gain, (double)sum.shape.gain);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, sd, (double)sum.sd[SHAPE_GAIN]);
    }
}

/* A first test with a small step leaves two shapes open; the second one knows better. */
static void the_other_plausible_shape_is_that_of_the_surer_test(void)
{
    struct shape_found rough = shape(SHAPE_ONE_LAG, 1.0, 0.1, 100, 20);
    struct shape_found fine = shape(SHAPE_ONE_LAG, 1.0, 0.01, 100, 20);
    rough.other_weight = 120;
    rough.other[SHAPE_GAIN] = 0x4000;
    rough.other_parameters = 5;
    rough.correlation[3] = 100;
    fine.other_weight = 2;
    fine.other[SHAPE_GAIN] = 0x3f80;
    fine.other_parameters = 4;
    fine.correlation[3] = -50;
    for (unsigned n = 0; n < 2; n++) {
        struct shape_found sum = n ? fine : rough;
        combine_shapes(&sum, n ? &rough : &fine, false);
        TEST_ASSERT_EQUAL_UINT8(2, sum.other_weight);
        TEST_ASSERT_EQUAL_HEX16(0x3f80, sum.other[SHAPE_GAIN]);
        TEST_ASSERT_EQUAL_UINT8(4, sum.other_parameters);
        TEST_ASSERT_EQUAL_INT8(-50, sum.correlation[3]);
    }
}

/* Times without a deviation count as exactly known, and nothing divides by it. */
static void a_deviation_of_nothing_does_not_divide_by_it(void)
{
    for (enum shape_kind kind = SHAPE_UNKNOWN; kind < KINDS; kind++) {
        struct shape_found sum = shape(kind, 1.0, 0.0, 100, 0), next = sum;
        memset(sum.sd, 0, sizeof sum.sd);
        sum.residence_sd_s = 0;
        memcpy(next.sd, sum.sd, sizeof sum.sd);
        next.residence_sd_s = 0;
        combine_shapes(&sum, &next, true);
        TEST_ASSERT_EQUAL_FLOAT(1.0f, (float)sum.shape.gain);
        TEST_ASSERT_EQUAL_FLOAT(100.0f, (float)sum.shape.lag_s);
        if (kind == SHAPE_INTEGRATING) /* a ramp has a lag that stands for it */
            continue;
        memset(&sum.shape, 0, sizeof sum.shape);
        memset(&next.shape, 0, sizeof next.shape);
        combine_shapes(&sum, &next, true);
        for (unsigned i = 0; i < SHAPE_PARAMETERS; i++)
            TEST_ASSERT_TRUE(real_is_finite(sum.sd[i]));
        TEST_ASSERT_TRUE(real_is_finite(sum.shape.gain) && real_is_finite(sum.shape.lag_s));
        TEST_ASSERT_TRUE(real_is_finite(sum.residence_sd_s));
    }
}

/* ---- ramps ---- */

/* Slope 0.002 and 0.0022 per second; the records of the two are 300 and 900 s long, so are the lags that stand for them. */
static void two_ramps_join_by_their_slopes(void)
{
    for (unsigned n = 0; n < 2; n++) {
        struct shape_found a = shape(SHAPE_INTEGRATING, 60, 6, 3e4, 10);
        struct shape_found b = shape(SHAPE_INTEGRATING, 198, 9, 9e4, 10);
        a.shape.square_s2 = REAL_C(3e4) * 20;
        b.shape.square_s2 = REAL_C(9e4) * 20;
        a.sd[SHAPE_LAG] = b.sd[SHAPE_LAG] = a.residence_sd_s = b.residence_sd_s = 2;
        struct shape_found sum = n ? b : a;
        combine_shapes(&sum, n ? &a : &b, false);
        TEST_ASSERT_EQUAL_UINT8(SHAPE_INTEGRATING, sum.kind);
        double lag_s = (double)sum.shape.lag_s;
        /* deviations of 2 and 1 in 1e-4 */
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, (0.002 + 4 * 0.0022) / 5, (double)sum.shape.gain / lag_s);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, 1e-4 * sqrt(0.8), (double)sum.sd[SHAPE_GAIN] / lag_s);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 20, (double)sum.shape.square_s2 / lag_s);
    }
}

/* One of them has not seen what the other has; their gains have nothing to do with each other. */
static void of_a_ramp_and_a_lag_the_later_counts(void)
{
    const struct shape_found ramp = shape(SHAPE_INTEGRATING, 600, 0.6, 3e5, 10);
    const struct shape_found lag = shape(SHAPE_ONE_LAG, 1.0, 0.1, 100, 20);
    struct shape_found sum = ramp;
    combine_shapes(&sum, &lag, false);
    TEST_ASSERT_EQUAL_MEMORY(&lag, &sum, sizeof sum);
    combine_shapes(&sum, &ramp, false);
    TEST_ASSERT_EQUAL_MEMORY(&ramp, &sum, sizeof sum);
}

/* ---- where one is open ---- */

static const enum shape_kind known[] = {SHAPE_ONE_LAG, SHAPE_TWO_LAGS, SHAPE_TWO_WITH_ZERO,
                                        SHAPE_INTEGRATING};

/* The later one is a copy of what is expected to stay, or of what is not. */
static void joins(enum shape_kind before, enum shape_kind after, bool longer, bool later_stays)
{
    char where[60];
    const struct shape_found first = shape(before, 1.0, 0.1, 100, 20);
    const struct shape_found second = shape(after, 2.0, 0.3, 250, 35);
    struct shape_found sum = first;
    snprintf(where, sizeof where, "%d then %d, longer %d", before, after, longer);
    combine_shapes(&sum, &second, longer);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(later_stays ? &second : &first, &sum, sizeof sum, where);
}

static void a_test_that_knows_settles_what_an_earlier_one_left_open(void)
{
    for (unsigned n = 0; n < 4; n++)
        for (unsigned longer = 0; longer < 2; longer++) {
            joins(SHAPE_UNKNOWN, known[n], longer, true);
            joins(SHAPE_SLOW, known[n], longer, true);
            joins(SHAPE_NO_RESPONSE, known[n], longer, true);
        }
}

static void a_test_that_sees_no_end_opens_what_seemed_known(void)
{
    for (unsigned n = 0; n < 4; n++)
        for (unsigned longer = 0; longer < 2; longer++)
            joins(known[n], SHAPE_SLOW, longer, true);
}

static void a_test_that_knows_nothing_changes_nothing_that_is_known(void)
{
    for (unsigned n = 0; n < 4; n++)
        for (unsigned longer = 0; longer < 2; longer++)
            joins(known[n], SHAPE_UNKNOWN, longer, false);
}

static void of_two_that_are_open_the_later_counts(void)
{
    static const enum shape_kind open[] = {SHAPE_UNKNOWN, SHAPE_SLOW};
    for (unsigned n = 0; n < 8; n++)
        joins(open[n & 1u], open[n >> 1 & 1u], n >> 2, true);
    for (unsigned n = 0; n < 4; n++) /* what hid below the noise comes out of it */
        joins(SHAPE_NO_RESPONSE, open[n & 1u], n >> 1, true);
}

/* Each of the two saw the end of a shape of its own; that both are wrong alike is not plausible. */
static void what_is_perhaps_slow_in_two_tests_is_known(void)
{
    static const uint8_t parameters[] = {3, 4, 5};
    for (unsigned n = 0; n < 3; n++) {
        struct shape_found sum = shape(SHAPE_PERHAPS_SLOW, 1.0, 0.1, 100, 20);
        struct shape_found next = shape(SHAPE_PERHAPS_SLOW, 1.1, 0.1, 110, 20);
        sum.parameters = next.parameters = parameters[n];
        combine_shapes(&sum, &next, false);
        TEST_ASSERT_EQUAL_UINT8(known[n], sum.kind);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.05, (double)sum.shape.gain);
    }
    for (unsigned n = 0; n < 4; n++) {
        joins(SHAPE_PERHAPS_SLOW, known[n], false, true);
        joins(known[n], SHAPE_PERHAPS_SLOW, true, false);
    }
    joins(SHAPE_SLOW, SHAPE_PERHAPS_SLOW, false, true);
    joins(SHAPE_PERHAPS_SLOW, SHAPE_SLOW, false, true);
}

static void no_response_settles_what_was_open_only_in_a_longer_test(void)
{
    for (unsigned longer = 0; longer < 2; longer++) {
        joins(SHAPE_UNKNOWN, SHAPE_NO_RESPONSE, longer, longer);
        joins(SHAPE_SLOW, SHAPE_NO_RESPONSE, longer, longer);
    }
}

static void a_response_that_was_seen_is_not_lost_in_a_later_test(void)
{
    for (unsigned n = 0; n < 4; n++)
        for (unsigned longer = 0; longer < 2; longer++)
            joins(known[n], SHAPE_NO_RESPONSE, longer, false);
}

static void two_tests_that_saw_nothing_still_see_nothing_but_bound_it_closer(void)
{
    struct shape_found sum = shape(SHAPE_NO_RESPONSE, 0.01, 0.3, 25, 0);
    struct shape_found next = shape(SHAPE_NO_RESPONSE, -0.02, 0.3, 25, 0);
    combine_shapes(&sum, &next, false);
    TEST_ASSERT_EQUAL_UINT8(SHAPE_NO_RESPONSE, sum.kind);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, -0.005, (double)sum.shape.gain);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.3 / sqrt(2), (double)sum.sd[SHAPE_GAIN]);
    TEST_ASSERT_EQUAL_FLOAT(25.0f, (float)sum.shape.lag_s);
}

int main(void)
{
    printf("seed %u\n", SEED);
    UNITY_BEGIN();
    RUN_TEST(two_tests_of_one_shape_count_by_how_well_they_know_each_parameter);
    RUN_TEST(the_residence_time_is_joined_by_itself_and_the_lag_is_what_it_leaves);
    RUN_TEST(a_small_gain_counts_by_how_well_it_is_known_too);
    RUN_TEST(a_parameter_that_a_shape_does_not_have_stays_none);
    RUN_TEST(tests_that_disagree_are_less_sure_than_they_say);
    RUN_TEST(more_tests_make_an_element_surer_and_their_order_does_not_matter);
    RUN_TEST(of_two_shapes_the_surer_stays_and_the_gain_is_that_of_both);
    RUN_TEST(the_other_plausible_shape_is_that_of_the_surer_test);
    RUN_TEST(a_deviation_of_nothing_does_not_divide_by_it);
    RUN_TEST(two_ramps_join_by_their_slopes);
    RUN_TEST(of_a_ramp_and_a_lag_the_later_counts);
    RUN_TEST(a_test_that_knows_settles_what_an_earlier_one_left_open);
    RUN_TEST(a_test_that_sees_no_end_opens_what_seemed_known);
    RUN_TEST(a_test_that_knows_nothing_changes_nothing_that_is_known);
    RUN_TEST(of_two_that_are_open_the_later_counts);
    RUN_TEST(what_is_perhaps_slow_in_two_tests_is_known);
    RUN_TEST(no_response_settles_what_was_open_only_in_a_longer_test);
    RUN_TEST(a_response_that_was_seen_is_not_lost_in_a_later_test);
    RUN_TEST(two_tests_that_saw_nothing_still_see_nothing_but_bound_it_closer);
    return UNITY_END();
}
