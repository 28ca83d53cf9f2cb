/* identify/shape_found.[ch]: what is kept of an element, its covariance and its plausible members.
 *
 * Contract (both scalar types)
 *   deviations             as packed, 1 %; the difference to the other shape is among them
 *   members                mean and deviation of 4000 draws within 6 % of a deviation of what was packed; all stable
 */
#include <math.h>
#include <string.h>

#include "identify/common.h"
#include "identify/shape_found.h"
#include "unity.h"

#define DRAWS 4000u

void setUp(void) {}
void tearDown(void) {}

/* Deviations of gain, dead time, residence time, square, zero. */
static const double sds[5] = {0.03, 3.0, 4.0, 60.0, 5.0};
static const struct shape damped = {
    .gain = 2, .dead_time_s = 40, .lag_s = 60, .square_s2 = 2500, .zero_s = -30};

/* All parameters correlated by r, apart from the gain. */
static void fill_covariance(real_t *within, double r)
{
    for (unsigned i = 0, n = 0; i < 5; i++)
        for (unsigned j = 0; j <= i; j++)
            within[n++] = (real_t)(sds[i] * sds[j] * (i == j ? 1.0 : (j == 0 ? 0.0 : r)));
}

static struct shape_found packed(const struct shape *other, double weight, double r)
{
    struct shape_found f = {.kind = SHAPE_TWO_WITH_ZERO};
    real_t within[15];
    fill_covariance(within, r);
    /* lag = residence time - dead time + zero */
    double lag = sds[2] * sds[2] + sds[1] * sds[1] + sds[4] * sds[4] +
                 2.0 * r * (sds[2] * sds[4] - sds[2] * sds[1] - sds[1] * sds[4]);
    double apart = (double)(other->lag_s - damped.lag_s);
    shape_found_pack(&f, &damped, 5, other, 5, (real_t)weight, within,
                     (real_t)(lag + weight * apart * apart));
    return f;
}

static void deviations_and_covariance_are_those_that_were_packed(void)
{
    struct shape_found f = packed(&damped, 0.0, 0.5);
    real_t c[25];
    shape_found_covariance(&f, c);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.03, (double)f.sd[SHAPE_GAIN]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 4.0, (double)f.residence_sd_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, sqrt(16 + 9 + 25 + 20 - 12 - 15), (double)f.sd[SHAPE_LAG]);
    for (unsigned i = 0; i < 5; i++) {
        double sd = (double)f.sd[i];
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * sd * sd, sd * sd, (double)c[6 * i]);
        for (unsigned j = 0; j < 5; j++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, (double)c[5 * i + j], (double)c[5 * j + i]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(2.0, 0.5 * 3.0 * 60.0, (double)c[5 * SHAPE_DEAD + SHAPE_SQUARE]);
}

static void the_other_shape_counts_with_its_weight(void)
{
    const struct shape other = {
        .gain = (real_t)2.2, .dead_time_s = 50, .lag_s = 90, .square_s2 = 2000, .zero_s = 0};
    struct shape_found f = packed(&other, 0.2, 0.0);
    struct shape back;
    TEST_ASSERT_DOUBLE_WITHIN(0.003, 0.2, (double)shape_found_other(&f, &back));
    TEST_ASSERT_DOUBLE_WITHIN(0.4, 90.0, (double)back.lag_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 2.2, (double)back.gain);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, sqrt(0.03 * 0.03 + 0.2 * 0.04), (double)f.sd[SHAPE_GAIN]);
    real_t c[25];
    shape_found_covariance(&f, c);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.2 * 0.2 * 10.0, (double)c[5 * SHAPE_GAIN + SHAPE_DEAD]);
}

static void members_have_the_mean_and_the_deviations(void)
{
    const struct shape other = {
        .gain = (real_t)2.2, .dead_time_s = 50, .lag_s = 90, .square_s2 = 2000, .zero_s = 0};
    struct shape_found f = packed(&other, 0.25, 0.4);
    double sum[3] = {0}, square[3] = {0};
    for (uint32_t n = 0; n < DRAWS; n++) {
        struct shape m;
        shape_found_draw(&f, 7, n, &m);
        TEST_ASSERT_TRUE(m.gain > 0 && m.dead_time_s >= 0 && m.lag_s > 0 && m.square_s2 >= 0);
        double v[3] = {(double)m.gain - 2.0, (double)m.dead_time_s - 40.0,
                       (double)shape_residence_s(&m) - 130.0};
        for (int k = 0; k < 3; k++) {
            sum[k] += v[k] / DRAWS;
            square[k] += v[k] * v[k] / DRAWS;
        }
    }
    /* about the chosen one: the weight of the other times its difference */
    const double mean[3] = {0.25 * 0.2, 0.25 * 10.0, 0.25 * 10.0};
    const double sd[3] = {(double)f.sd[SHAPE_GAIN], (double)f.sd[SHAPE_DEAD],
                          (double)f.residence_sd_s};
    for (int k = 0; k < 3; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.06 * sd[k], mean[k], sum[k]);
        TEST_ASSERT_DOUBLE_WITHIN(0.06 * sd[k], sd[k], sqrt(square[k]));
    }
}

static void draws_leave_slow_tails_out_of_the_residence_time(void)
{
    struct shape_found f = packed(&damped, 0.0, 0.4);
    shape_found_add_tails(&f, 150 * 150);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, sqrt(150 * 150 + 16), (double)f.residence_sd_s);
    double square = 0;
    for (uint32_t n = 0; n < DRAWS; n++) {
        struct shape m;
        shape_found_draw(&f, 7, n, &m);
        double v = (double)shape_residence_s(&m) - 130.0;
        square += v * v / DRAWS;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.06 * sds[2], sds[2], sqrt(square));
}

static void a_member_is_the_same_every_time_and_another_for_another_number(void)
{
    struct shape_found f = packed(&damped, 0.0, 0.4);
    struct shape a, b, c, d;
    shape_found_draw(&f, 1, 5, &a);
    shape_found_draw(&f, 1, 5, &b);
    shape_found_draw(&f, 1, 6, &c);
    shape_found_draw(&f, 2, 5, &d);
    TEST_ASSERT_EQUAL_INT(0, memcmp(&a, &b, sizeof a));
    TEST_ASSERT_TRUE(memcmp(&a, &c, sizeof a) != 0);
    TEST_ASSERT_TRUE(memcmp(&a, &d, sizeof a) != 0);
}

static void members_keep_the_parameters_of_their_shape(void)
{
    const struct shape one = {.gain = -1, .dead_time_s = 10, .lag_s = 50};
    const struct shape two = {.gain = -1, .dead_time_s = 5, .lag_s = 55, .square_s2 = 250};
    struct shape_found f = {.kind = SHAPE_ONE_LAG};
    real_t within[15] = {0};
    within[0] = (real_t)1e-4;
    within[2] = within[5] = 4;
    within[9] = 400;
    shape_found_pack(&f, &one, 3, &two, 4, (real_t)0.3, within, 10);
    int with_square = 0;
    for (uint32_t n = 0; n < 1000; n++) {
        struct shape m;
        shape_found_draw(&f, 3, n, &m);
        TEST_ASSERT_TRUE(m.zero_s >= 0 && m.zero_s <= 0);
        with_square += m.square_s2 > 0;
    }
    TEST_ASSERT_INT_WITHIN(45, 300, with_square);
}

static void a_member_of_an_unsure_element_is_bounded(void)
{
    struct shape_found f = {.kind = SHAPE_TWO_WITH_ZERO};
    real_t within[15] = {0};
    int negative = 0;
    static const double wild[5] = {1.0, 100.0, 300.0, 9000.0, 200.0};
    for (unsigned i = 0, n = 0; i < 5; i++)
        for (unsigned j = 0; j <= i; j++, n++)
            within[n] = i == j ? (real_t)(wild[i] * wild[i]) : 0;
    shape_found_pack(&f, &damped, 5, &damped, 5, 0, within, 90000);
    for (uint32_t n = 0; n < 1000; n++) {
        struct shape m;
        shape_found_draw(&f, 4, n, &m);
        TEST_ASSERT_TRUE(m.dead_time_s >= 0);
        TEST_ASSERT_TRUE(m.lag_s >= (real_t)0.0499 * damped.lag_s);
        TEST_ASSERT_TRUE(m.square_s2 >= 0 && m.square_s2 <= (real_t)30.01 * m.lag_s * m.lag_s);
        negative += m.gain < 0;
    }
    TEST_ASSERT_TRUE(negative > 5 && negative < 60); /* two deviations: 2.3 % */
    /* a gain that is known keeps its sign */
    within[0] = (real_t)(0.6 * 0.6);
    shape_found_pack(&f, &damped, 5, &damped, 5, 0, within, 90000);
    for (uint32_t n = 0; n < 4000; n++) {
        struct shape m;
        shape_found_draw(&f, 5, n, &m);
        TEST_ASSERT_TRUE(m.gain >= (real_t)0.199);
    }
}

static void infinite_covariances_do_no_harm(void)
{
    struct shape_found f = {.kind = SHAPE_TWO_WITH_ZERO};
    real_t within[15];
    for (unsigned n = 0; n < 15; n++)
        within[n] = (real_t)INFINITY;
    shape_found_pack(&f, &damped, 5, &damped, 5, 0, within, (real_t)INFINITY);
    for (unsigned k = 0; k < SHAPE_CORRELATIONS; k++)
        TEST_ASSERT_EQUAL_INT(0, f.correlation[k]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(deviations_and_covariance_are_those_that_were_packed);
    RUN_TEST(the_other_shape_counts_with_its_weight);
    RUN_TEST(members_have_the_mean_and_the_deviations);
    RUN_TEST(draws_leave_slow_tails_out_of_the_residence_time);
    RUN_TEST(a_member_is_the_same_every_time_and_another_for_another_number);
    RUN_TEST(members_keep_the_parameters_of_their_shape);
    RUN_TEST(a_member_of_an_unsure_element_is_bounded);
    RUN_TEST(infinite_covariances_do_no_harm);
    return UNITY_END();
}
