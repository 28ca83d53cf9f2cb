/* interact/integrity.[ch], and how sure the sign of a determinant is (interact/rga.h); built in float and in double.
 *
 * Contract
 *   random 2 x 2 to 6 x 6   a negative subset is found exactly where determinants of all subsets have one, and it is one
 *   16 x 16                 all 65,535 subsets seen in pieces of a bounded number
 *   a determinant           its standard deviation is that of 20,000 draws
 */
#include <math.h>
#include <string.h>

#include "interact/integrity.h"
#include "interact/rga.h"
#include "num/random.h"
#include "random_matrix.h"
#include "unity.h"

static struct integrity w;
static struct matrix gains, sd;
static struct pairs pairs;
static struct rga_work work;
static unsigned pieces;

void setUp(void)
{
    memset(&w, 0xA5, sizeof w);
    memset(&gains, 0, sizeof gains);
    memset(&sd, 0, sizeof sd);
}
void tearDown(void) {}

static void diagonal(uint8_t n)
{
    gains.rows = gains.cols = sd.rows = sd.cols = pairs.n = n;
    for (uint8_t k = 0; k < n; k++)
        pairs.output[k] = pairs.input[k] = k;
}

static void search(void)
{
    enum err err = integrity_begin(&w, &gains, &pairs);
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    for (pieces = 1; (err = integrity_step(&w)) == ERR_BUSY; pieces++)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
}

/* By elimination with pivots; in double. */
static double determinant(double a[6][6], unsigned n)
{
    double det = 1.0;
    for (unsigned k = 0; k < n; k++) {
        unsigned best = k;
        for (unsigned i = k + 1; i < n; i++)
            best = fabs(a[i][k]) > fabs(a[best][k]) ? i : best;
        for (unsigned j = 0; j < n && best != k; j++) {
            double other = a[k][j];
            a[k][j] = a[best][j];
            a[best][j] = other;
        }
        det *= best == k ? a[k][k] : -a[k][k];
        for (unsigned i = k + 1; i < n; i++)
            for (unsigned j = n; j-- > k;)
                a[i][j] -= a[i][k] / a[k][k] * a[k][j];
    }
    return det;
}

static double index_of(uint16_t subset)
{
    double a[6][6];
    uint8_t member[6], n = 0;
    for (uint8_t k = 0; k < pairs.n; k++)
        if ((subset & (1u << k)) != 0u)
            member[n++] = k;
    double own = 1.0;
    for (unsigned i = 0; i < n; i++) {
        own *= (double)gains.value[pairs.output[member[i]]][pairs.input[member[i]]];
        for (unsigned j = 0; j < n; j++)
            a[i][j] = (double)gains.value[pairs.output[member[i]]][pairs.input[member[j]]];
    }
    return determinant(a, n) / own;
}

static void a_negative_subset_is_found_where_there_is_one(void)
{
    unsigned with = 0, without = 0, two = 0;
    for (uint64_t seed = 1; seed <= 600; seed++) {
        struct random_source r = {seed};
        uint8_t n = (uint8_t)(2 + random_below(&r, 5));
        diagonal(n);
        for (uint8_t k = 0; k < n; k++)
            pairs.input[k] = (uint8_t)((k + seed) % n);
        for (unsigned i = 0; i < n; i++)
            for (unsigned j = 0; j < n; j++)
                gains.value[i][j] =
                    (real_t)(random_fraction(&r) * (pairs.input[i] == j ? 2.0 : 1.0));
        double least = INFINITY, least_of_two = INFINITY;
        for (uint16_t subset = 1; subset < 1u << n; subset++) {
            double index = index_of(subset);
            least = fmin(least, index);
            if (__builtin_popcount(subset) == 2)
                least_of_two = fmin(least_of_two, index);
        }
        TEST_ASSERT_TRUE(fabs(least) > 1e-5 && fabs(least_of_two) > 1e-5); /* of these seeds */
        search();
        TEST_ASSERT_EQUAL_INT(least < 0.0, w.negative != 0);
        TEST_ASSERT_EQUAL_INT(least_of_two > 0.0, integrity_of_two(&gains, &pairs));
        if (w.negative) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-3 * (1.0 + fabs(index_of(w.negative))),
                                      index_of(w.negative), (double)w.index);
            TEST_ASSERT_TRUE(index_of(w.negative) < 0.0);
        }
        with += w.negative != 0;
        without += w.negative == 0;
        two += least < 0.0 && least_of_two > 0.0;
    }
    TEST_ASSERT_TRUE(with > 100 && without > 100 && two > 10);
}

static void of_sixteen_loops_every_subset_is_seen_in_pieces(void)
{
    diagonal(16);
    for (unsigned i = 0; i < 16; i++)
        for (unsigned j = 0; j < 16; j++)
            gains.value[i][j] = i == j ? 1 : REAL_C(0.05);
    search();
    TEST_ASSERT_EQUAL_HEX16(0, w.negative);
    TEST_ASSERT_TRUE(pieces > 20 && pieces < 300);
    /* A ring of all sixteen, whose gains multiply to more than 1: no smaller subset shows it, and it is the last. */
    for (unsigned i = 0; i < 16; i++)
        for (unsigned j = 0; j < 16; j++)
            gains.value[i][j] = i == j ? 1 : j == (i + 1) % 16 ? REAL_C(1.02) : 0;
    search();
    TEST_ASSERT_EQUAL_HEX16(0xFFFF, w.negative);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1.0 - pow(1.02, 16), (double)w.index);
    gains.value[15][0] = REAL_C(0.7);
    search();
    TEST_ASSERT_EQUAL_HEX16(0, w.negative);
}

static void what_is_no_pairing_is_refused(void)
{
    diagonal(2);
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, integrity_begin(&w, &gains, &pairs));
    gains.value[0][0] = gains.value[1][1] = 1;
    pairs.input[1] = 2;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, integrity_begin(&w, &gains, &pairs));
    pairs.n = 0;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, integrity_begin(&w, &gains, &pairs));
}

static void a_determinant_is_as_sure_as_draws_of_the_gains_say(void)
{
    static const double k[3][3] = {{12, -7, 0}, {3, 5e3, 0.2}, {1, 400, 0.1}};
    double a[6][6], sum = 0.0, squares = 0.0;
    struct random r = random_from(3);
    real_t sds;
    diagonal(3);
    for (unsigned i = 0; i < 3; i++)
        for (unsigned j = 0; j < 3; j++) {
            gains.value[i][j] = (real_t)k[i][j];
            sd.value[i][j] = (real_t)(0.01 * fabs(k[i][j]));
        }
    sd.value[0][2] = REAL_C(1e-4); /* of a gain that is 0 */
    for (unsigned n = 0; n < 20000; n++) {
        for (unsigned i = 0; i < 3; i++)
            for (unsigned j = 0; j < 3; j++)
                a[i][j] = k[i][j] + (double)sd.value[i][j] * (double)random_normal(&r);
        double det = determinant(a, 3);
        sum += det;
        squares += det * det;
    }
    double mean = sum / 20000.0, deviation = sqrt(squares / 20000.0 - mean * mean);
    TEST_ASSERT_EQUAL_INT(ERR_OK, rga_determinant_sds(&gains, &sd, NULL, &work, &sds));
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 1.0, (double)sds * deviation / fabs(mean));

    memset(&sd.value, 0, sizeof sd.value);
    TEST_ASSERT_EQUAL_INT(ERR_OK, rga_determinant_sds(&gains, &sd, NULL, &work, &sds));
    TEST_ASSERT_TRUE(isinf(sds));
    for (unsigned j = 0; j < 3; j++)
        gains.value[2][j] = 2 * gains.value[0][j];
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, rga_determinant_sds(&gains, &sd, NULL, &work, &sds));
    gains.cols = sd.cols = 2;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, rga_determinant_sds(&gains, &sd, NULL, &work, &sds));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_negative_subset_is_found_where_there_is_one);
    RUN_TEST(of_sixteen_loops_every_subset_is_seen_in_pieces);
    RUN_TEST(what_is_no_pairing_is_refused);
    RUN_TEST(a_determinant_is_as_sure_as_draws_of_the_gains_say);
    return UNITY_END();
}
