/* design/decoupler_shapes.[ch]; built in float and in double. eps is REAL_EPSILON, kappa the condition number of K.
 *
 * Contract (100 random matrices of up to eight loops with kappa up to 200)
 *   whole       with factors of 1, and by directions without a limit, K D is diagonal to 64 eps kappa of the sums of its terms; the two agree
 *   one-way     K D is 0 above the diagonal in the order given, to the same; D has zeros below
 *   directions  a symmetric K of two loops: elements by hand, with one direction limited and with both alike
 *   Kotyk       gains at rest of the pilot column: elements by the formulas of two loops
 */
#include <math.h>
#include <string.h>

#include "design/decoupler_shapes.h"
#include "random_matrix.h"
#include "unity.h"

#define EPS ((double)REAL_EPSILON)
#define N   DECOUPLER_SHAPE_LOOPS

static struct matrix gains;
static struct decoupler_shape_work work;
static struct decoupler_shape shape, other;
static real_t factor[N][N];
static uint8_t limited;
/* Kotyk and Machacek (1995): B(1)/A(1). */
static const double kotyk[2][2] = {{0.15553, -0.05629}, {0.19767, -0.22961}};

void setUp(void)
{
    gains.rows = gains.cols = 2;
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++)
            gains.value[i][j] = (real_t)kotyk[i][j];
    for (unsigned i = 0; i < N; i++)
        for (unsigned j = 0; j < N; j++)
            factor[i][j] = (real_t)1;
}
void tearDown(void) {}

/* With a condition number of at most 200. */
static double draw(struct random_source *r)
{
    for (;;) {
        gains.rows = gains.cols = (uint8_t)(1 + random_below(r, N));
        for (unsigned i = 0; i < gains.rows; i++)
            for (unsigned j = 0; j < gains.rows; j++)
                gains.value[i][j] = (real_t)random_fraction(r);
        TEST_ASSERT_EQUAL(ERR_OK, svd_decompose(&work.svd, &gains));
        if ((double)svd_condition(&work.svd) <= 200)
            return (double)svd_condition(&work.svd);
    }
}

static double terms(unsigned i, unsigned j)
{
    double sum = 0;
    for (unsigned k = 0; k < gains.rows; k++)
        sum += fabs((double)gains.value[i][k] * (double)shape.d.value[k][j]);
    return sum;
}

static void all_of_it_leaves_nothing(void)
{
    struct random_source r = {17};
    unsigned made = 0;
    for (unsigned k = 0; k < 100; k++) {
        double kappa = draw(&r);
        enum err err = decoupler_partial(&gains, factor, &work, &shape);
        if (err == ERR_SINGULAR)
            continue;
        TEST_ASSERT_EQUAL(ERR_OK, err);
        made++;
        for (unsigned i = 0; i < gains.rows; i++)
            for (unsigned j = 0; j < gains.rows; j++) {
                if (i != j)
                    TEST_ASSERT_DOUBLE_WITHIN(64 * EPS * kappa * terms(i, j), 0,
                                              (double)shape.seen.value[i][j]);
                else
                    TEST_ASSERT_TRUE((double)shape.d.value[i][i] == 1);
            }
        TEST_ASSERT_EQUAL(ERR_OK,
                          decoupler_by_directions(&gains, (real_t)1e4, &work, &other, &limited));
        TEST_ASSERT_EQUAL_UINT8(0, limited);
        for (unsigned j = 0; j < gains.rows; j++) {
            /* Rounding of a column: that of its largest element, over the one it was divided by. */
            double most = 1;
            for (unsigned i = 0; i < gains.rows; i++)
                most = fmax(most, fabs((double)shape.d.value[i][j]));
            for (unsigned i = 0; i < gains.rows; i++)
                TEST_ASSERT_DOUBLE_WITHIN(64 * EPS * kappa * most * most,
                                          (double)shape.d.value[i][j], (double)other.d.value[i][j]);
        }
    }
    TEST_ASSERT_TRUE(made >= 90);
}

static void a_part_of_it_leaves_the_rest_between_none_and_all(void)
{
    factor[0][1] = (real_t)0.5;
    factor[1][0] = (real_t)0;
    TEST_ASSERT_EQUAL(ERR_OK, decoupler_partial(&gains, factor, &work, &shape));
    TEST_ASSERT_TRUE((double)shape.d.value[1][0] == 0);
    TEST_ASSERT_DOUBLE_WITHIN(32 * EPS, -0.5 * kotyk[0][1] / kotyk[0][0],
                              (double)shape.d.value[0][1]);
    TEST_ASSERT_DOUBLE_WITHIN(32 * EPS, 0.5 * fabs(kotyk[0][1]) / kotyk[0][0],
                              (double)shape.left[0]);
    TEST_ASSERT_DOUBLE_WITHIN(32 * EPS, kotyk[0][0], (double)shape.gain[0]);
}

static void one_way_of_two_loops_is_one_element(void)
{
    static const uint8_t top_first[2] = {0, 1}, bottom_first[2] = {1, 0};
    TEST_ASSERT_EQUAL(ERR_OK, decoupler_one_way(&gains, top_first, &work, &shape));
    TEST_ASSERT_DOUBLE_WITHIN(8 * EPS, -kotyk[0][1] / kotyk[0][0], (double)shape.d.value[0][1]);
    TEST_ASSERT_TRUE((double)shape.d.value[1][0] == 0);
    TEST_ASSERT_DOUBLE_WITHIN(8 * EPS, 0, (double)shape.left[0]);
    TEST_ASSERT_TRUE((double)shape.left[1] > 0.5);
    TEST_ASSERT_EQUAL(ERR_OK, decoupler_one_way(&gains, bottom_first, &work, &shape));
    TEST_ASSERT_DOUBLE_WITHIN(8 * EPS, -kotyk[1][0] / kotyk[1][1], (double)shape.d.value[1][0]);
    TEST_ASSERT_TRUE((double)shape.d.value[0][1] == 0);
    TEST_ASSERT_DOUBLE_WITHIN(8 * EPS, 0, (double)shape.left[1]);
}

static void one_way_no_loop_is_disturbed_by_one_of_a_later_rank(void)
{
    struct random_source r = {18};
    unsigned made = 0;
    for (unsigned draws = 0; draws < 100; draws++) {
        uint8_t rank[N];
        (void)draw(&r);
        for (unsigned k = 0; k < gains.rows; k++)
            rank[k] = (uint8_t)k;
        for (unsigned k = gains.rows; k-- > 1;) {
            unsigned l = random_below(&r, k + 1);
            uint8_t swap = rank[k];
            rank[k] = rank[l];
            rank[l] = swap;
        }
        enum err err = decoupler_one_way(&gains, rank, &work, &shape);
        if (err == ERR_SINGULAR)
            continue;
        TEST_ASSERT_EQUAL(ERR_OK, err);
        made++;
        for (unsigned i = 0; i < gains.rows; i++)
            for (unsigned j = i + 1; j < gains.rows; j++) {
                /* Gaussian elimination: backward stable, so in the terms themselves. */
                TEST_ASSERT_DOUBLE_WITHIN(64 * EPS * 8 * terms(rank[i], rank[j]), 0,
                                          (double)shape.seen.value[rank[i]][rank[j]]);
                TEST_ASSERT_TRUE((double)shape.d.value[rank[j]][rank[i]] == 0);
            }
    }
    TEST_ASSERT_TRUE(made >= 90);
}

static void a_weak_direction_gets_no_more_than_its_bound(void)
{
    /* Nearly singular: 1 and 0.9 of both, singular values about 1.9 and 0.1. */
    static const double k[2][2] = {{1, 0.9}, {0.9, 1}};
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++)
            gains.value[i][j] = (real_t)k[i][j];
    TEST_ASSERT_EQUAL(ERR_OK, decoupler_by_directions(&gains, (real_t)5, &work, &shape, &limited));
    TEST_ASSERT_EQUAL_UINT8(1, limited);
    /* W = V = [1 1; 1 -1]/sqrt 2: D before division is (1/1.9 + g)/2 and (1/1.9 - g)/2 with g = 5/1.9. */
    double g = 5 / 1.9, ratio = (1 / 1.9 - g) / (1 / 1.9 + g);
    TEST_ASSERT_DOUBLE_WITHIN(64 * EPS, ratio, (double)shape.d.value[0][1]);
    TEST_ASSERT_DOUBLE_WITHIN(64 * EPS, ratio, (double)shape.d.value[1][0]);
    TEST_ASSERT_EQUAL(ERR_OK, decoupler_by_directions(&gains, (real_t)1, &work, &shape, &limited));
    TEST_ASSERT_DOUBLE_WITHIN(64 * EPS, 0, (double)shape.d.value[0][1]); /* all alike: none */
}

static void what_cannot_be_right_is_refused(void)
{
    static const uint8_t twice[2] = {1, 1}, outside[2] = {0, 2}, rank[2] = {0, 1};
    TEST_ASSERT_EQUAL(ERR_RANGE, decoupler_one_way(&gains, twice, &work, &shape));
    TEST_ASSERT_EQUAL(ERR_RANGE, decoupler_one_way(&gains, outside, &work, &shape));
    factor[0][1] = (real_t)1.01;
    TEST_ASSERT_EQUAL(ERR_RANGE, decoupler_partial(&gains, factor, &work, &shape));
    factor[0][1] = (real_t)NAN;
    TEST_ASSERT_EQUAL(ERR_RANGE, decoupler_partial(&gains, factor, &work, &shape));
    factor[0][1] = (real_t)1;
    TEST_ASSERT_EQUAL(ERR_RANGE,
                      decoupler_by_directions(&gains, (real_t)0.9, &work, &shape, &limited));
    gains.value[0][0] = (real_t)0;
    TEST_ASSERT_EQUAL(ERR_SINGULAR, decoupler_one_way(&gains, rank, &work, &shape));
    gains.value[1][0] = (real_t)0;
    TEST_ASSERT_EQUAL(ERR_SINGULAR, decoupler_partial(&gains, factor, &work, &shape));
    gains.value[0][1] = (real_t)INFINITY;
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, decoupler_partial(&gains, factor, &work, &shape));
    setUp();
    gains.rows = 1;
    TEST_ASSERT_EQUAL(ERR_RANGE, decoupler_partial(&gains, factor, &work, &shape));
    gains.rows = gains.cols = 9;
    memset(gains.value, 0, sizeof gains.value);
    TEST_ASSERT_EQUAL(ERR_RANGE, decoupler_partial(&gains, factor, &work, &shape));
    gains.rows = gains.cols = 2;
    TEST_ASSERT_EQUAL(ERR_SINGULAR,
                      decoupler_by_directions(&gains, (real_t)5, &work, &shape, &limited));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(all_of_it_leaves_nothing);
    RUN_TEST(a_part_of_it_leaves_the_rest_between_none_and_all);
    RUN_TEST(one_way_of_two_loops_is_one_element);
    RUN_TEST(one_way_no_loop_is_disturbed_by_one_of_a_later_rank);
    RUN_TEST(a_weak_direction_gets_no_more_than_its_bound);
    RUN_TEST(what_cannot_be_right_is_refused);
    return UNITY_END();
}
