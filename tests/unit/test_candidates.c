/* interact/candidates.[ch]; built in float and in double.
 *
 * Contract
 *   random 2 x 2 to 6 x 6    exactly the pairings that trying every permutation in double finds, in ascending order of cost (all of
 *                            up to 4 loops, else the first eight); index and negative subsets as determinants in double say
 *   sound                    within 4 standard deviations of the normal distribution's share
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "interact/candidates.h"
#include "random_matrix.h"
#include "refusal.h"
#include "unity.h"

#define NEAR 2e-3 /* of a cost: what float and the unit of the costs leave */

static struct interact_plant plant;
static struct candidates found;
static struct candidates_config config;
static struct pairs channels;

void setUp(void)
{
    config = (struct candidates_config){
        .smallest_lambda = REAL_C(0.02), .floor = REAL_C(0.005), .draws = 20, .seed = 1};
}
void tearDown(void) {}

static void square_plant(uint8_t n)
{
    memset(&plant, 0, sizeof plant);
    plant.outputs = plant.inputs = channels.n = n;
    for (uint8_t k = 0; k < n; k++)
        channels.output[k] = channels.input[k] = k;
}

static void find(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, candidates_begin(&found, &plant, &channels, &config, NULL));
    enum err err;
    while ((err = candidates_step(&found)) == ERR_BUSY)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
}

/* ---- determinants in double, by Gauss with pivots ---- */

static double determinant(double a[6][6], unsigned n)
{
    double m[6][6], det = 1.0;
    memcpy(m, a, sizeof m);
    for (unsigned k = 0; k < n; k++) {
        unsigned pivot = k;
        for (unsigned i = k + 1; i < n; i++)
            if (fabs(m[i][k]) > fabs(m[pivot][k]))
                pivot = i;
        for (unsigned j = 0; j < n; j++) {
            double other = m[k][j];
            m[k][j] = m[pivot][j];
            m[pivot][j] = other;
        }
        det *= pivot == k ? m[k][k] : -m[k][k];
        if (!(fabs(m[k][k]) > 0))
            return 0.0;
        for (unsigned i = k + 1; i < n; i++)
            for (unsigned j = n; j-- > k;)
                m[i][j] -= m[i][k] / m[k][k] * m[k][j];
    }
    return det;
}

static double gain(unsigned i, unsigned j)
{
    return (double)plant.element[i][j].gain;
}

static double relative_gain(unsigned row, unsigned col, unsigned n)
{
    double all[6][6] = {{0}}, less[6][6] = {{0}};
    for (unsigned i = 0; i < n; i++)
        for (unsigned j = 0; j < n; j++) {
            all[i][j] = gain(i, j);
            if (i != row && j != col)
                less[i - (i > row)][j - (j > col)] = gain(i, j);
        }
    double minor = determinant(less, n - 1) * ((row + col) % 2 ? -1.0 : 1.0);
    return gain(row, col) * minor / determinant(all, n);
}

/* Index of the loops in `subset`. */
static double index_of(const unsigned *input, unsigned subset, unsigned n)
{
    double part[6][6] = {{0}}, product = 1.0;
    unsigned row = 0;
    for (unsigned i = 0; i < n; i++) {
        if (!(subset >> i & 1u))
            continue;
        unsigned col = 0;
        for (unsigned j = 0; j < n; j++)
            if (subset >> j & 1u)
                part[row][col++] = gain(i, input[j]);
        row++;
        product *= gain(i, input[i]);
    }
    return determinant(part, row) / product;
}

struct tried {
    double cost, index;
    unsigned input[6];
    bool whole; /* no negative subset */
};
static struct tried tried[720];
static unsigned n_tried;
static double lambda[6][6];

static void try_every_permutation(unsigned n)
{
    unsigned permutation[6] = {0}, counts = 1;
    n_tried = 0;
    for (unsigned k = 0; k < n; k++)
        counts *= n;
    for (unsigned i = 0; i < n; i++)
        for (unsigned j = 0; j < n; j++)
            lambda[i][j] = relative_gain(i, j, n);
    for (unsigned number = 0; number < counts; number++) {
        unsigned rest = number, taken = 0;
        double cost = 0.0;
        bool admissible = true;
        for (unsigned i = 0; i < n; i++, rest /= n) {
            permutation[i] = rest % n;
            admissible =
                admissible && !(taken >> permutation[i] & 1u) && lambda[i][permutation[i]] >= 0.02;
            taken |= 1u << permutation[i];
            if (admissible)
                cost += fabs(log(lambda[i][permutation[i]]));
        }
        if (!admissible || !(index_of(permutation, (1u << n) - 1u, n) > 0))
            continue;
        unsigned place = n_tried++;
        for (; place > 0 && tried[place - 1].cost > cost; place--)
            tried[place] = tried[place - 1];
        tried[place] = (struct tried){.cost = cost, .whole = true};
        memcpy(tried[place].input, permutation, sizeof permutation);
        tried[place].index = index_of(permutation, (1u << n) - 1u, n);
        for (unsigned subset = 1; subset < 1u << n; subset++)
            tried[place].whole = tried[place].whole && index_of(permutation, subset, n) > 0;
    }
}

/* Neither float nor the unit of the costs can tell near costs apart, so the place is looked for among those. */
static const struct tried *tried_like(const struct candidate *c, unsigned n)
{
    for (unsigned k = 0; k < n_tried; k++) {
        bool same = true;
        for (unsigned i = 0; i < n; i++)
            same = same && tried[k].input[i] == c->input[i];
        if (same)
            return &tried[k];
    }
    return NULL;
}

static bool is_near_a_bound(unsigned n)
{
    for (unsigned i = 0; i < n; i++)
        for (unsigned j = 0; j < n; j++)
            if (fabs(lambda[i][j] - 0.02) < 1e-3 || fabs(lambda[i][j]) > 50)
                return true;
    return false;
}

static void candidates_are_those_that_trying_every_pairing_finds(void)
{
    unsigned looked = 0, several = 0, warned = 0;
    for (uint64_t seed = 1; seed <= 400; seed++) {
        struct random_source r = {seed};
        uint8_t n = (uint8_t)(2 + random_below(&r, 5));
        square_plant(n);
        for (unsigned i = 0; i < n; i++)
            for (unsigned j = 0; j < n; j++)
                plant.element[i][j].gain =
                    (real_t)random_fraction(&r) + (i == j ? REAL_C(1.0) : REAL_C(0.0));
        try_every_permutation(n);
        if (is_near_a_bound(n))
            continue;
        find();
        char text[32];
        snprintf(text, sizeof text, "seed %u, %u loops", (unsigned)seed, n);
        unsigned most = n <= CANDIDATES_LOOPS ? CANDIDATES_MAX : CANDIDATES_OF_MANY;
        TEST_ASSERT_EQUAL_UINT_MESSAGE(n_tried < most ? n_tried : most, found.n, text);
        looked++;
        several += found.n > 1;
        for (unsigned k = 0; k < found.n; k++) {
            const struct tried *want = tried_like(&found.list[k], n);
            TEST_ASSERT_NOT_NULL_MESSAGE(want, text);
            TEST_ASSERT_DOUBLE_WITHIN(NEAR, tried[k].cost, (double)found.list[k].cost);
            TEST_ASSERT_DOUBLE_WITHIN(2e-3 * want->index + 1e-6, want->index,
                                      (double)found.list[k].niederlinski);
            TEST_ASSERT_EQUAL_INT_MESSAGE(want->whole, found.list[k].negative == 0, text);
            if (found.list[k].negative) {
                warned++;
                TEST_ASSERT_TRUE(index_of(want->input, found.list[k].negative, n) <= 0);
            }
        }
    }
    printf("%u plants, %u with several candidates, %u candidates with a negative subset\n", looked,
           several, warned);
    TEST_ASSERT_GREATER_THAN_UINT(200, looked);
    TEST_ASSERT_GREATER_THAN_UINT(50, several);
    TEST_ASSERT_GREATER_THAN_UINT(20, warned);
}

/* [[1, b], [c, 1]]: the diagonal has the index 1 - b c, the other one 1 - 1/(b c). One gain is uncertain. */
static void sound_is_the_share_of_draws_in_which_the_pairs_would_do(void)
{
    config.floor = 0;
    config.draws = 4000;
    for (double sds = 0.5; sds < 3.0; sds += 0.5) {
        square_plant(2);
        plant.element[0][0].gain = plant.element[1][1].gain = plant.element[1][0].gain =
            REAL_C(1.0);
        plant.element[0][1].gain = REAL_C(0.6);
        plant.gain_sd[0][1] = (real_t)(0.4 / sds);
        find();
        TEST_ASSERT_EQUAL_UINT8(1, found.n);
        double share = 0.5 * erfc(-sds / sqrt(2.0)), sd = sqrt(share * (1 - share) / 4000);
        TEST_ASSERT_DOUBLE_WITHIN(4 * sd + 1e-3, share, (double)found.list[0].sound / 4000);
        TEST_ASSERT_EQUAL_UINT16(4000, found.drawn);
    }
}

static void a_pair_whose_gain_may_have_the_other_sign_is_not_sound(void)
{
    config.floor = 0;
    config.draws = 4000;
    square_plant(2);
    plant.element[0][0].gain = plant.element[1][1].gain = REAL_C(1.0);
    plant.gain_sd[0][0] = plant.gain_sd[1][1] = REAL_C(1.0);
    find();
    double both = 0.841345 * 0.841345;
    TEST_ASSERT_DOUBLE_WITHIN(0.03, both, (double)found.list[0].sound / 4000);
}

static void pairs_that_are_kept_apart_are_no_candidates(void)
{
    square_plant(2);
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++)
            plant.element[i][j].gain =
                i == j ? REAL_C(1.0) : REAL_C(-0.8) + (real_t)i * REAL_C(1.6);
    find();
    TEST_ASSERT_EQUAL_UINT8(2, found.n);
    config.apart[0] = 1; /* output 1 and input 1 */
    find();
    TEST_ASSERT_EQUAL_UINT8(1, found.n);
    struct pairs pairs;
    candidates_pairs(&found, 0, &pairs);
    TEST_ASSERT_EQUAL_UINT8(1, pairs.input[0]);
    TEST_ASSERT_EQUAL_UINT8(0, pairs.input[1]);
}

static void channels_may_be_any_of_a_larger_plant_in_any_order(void)
{
    memset(&plant, 0, sizeof plant);
    plant.outputs = 3;
    plant.inputs = 4;
    channels = (struct pairs){2, {2, 0}, {3, 1}};
    plant.element[0][3].gain = REAL_C(2.0);
    plant.element[2][1].gain = REAL_C(1.0);
    plant.element[2][3].gain = REAL_C(0.1);
    find();
    TEST_ASSERT_EQUAL_UINT8(1, found.n);
    struct pairs pairs;
    candidates_pairs(&found, 0, &pairs);
    TEST_ASSERT_EQUAL_UINT8(0, pairs.output[0]);
    TEST_ASSERT_EQUAL_UINT8(3, pairs.input[0]);
    TEST_ASSERT_EQUAL_UINT8(2, pairs.output[1]);
    TEST_ASSERT_EQUAL_UINT8(1, pairs.input[1]);
}

static void a_plant_without_pairs_has_no_candidate_and_a_singular_one_is_refused(void)
{
    square_plant(2);
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++)
            plant.element[i][j].gain = REAL_C(1.0);
    TEST_ASSERT_EQUAL_INT(ERR_OK, candidates_begin(&found, &plant, &channels, &config, NULL));
    TEST_ASSERT_EQUAL_INT(ERR_SINGULAR, candidates_step(&found));
    TEST_ASSERT_EQUAL_INT(ERR_STATE, candidates_step(&found));
    config.apart[0] = 3;
    plant.element[0][0].gain = REAL_C(2.0);
    find();
    TEST_ASSERT_EQUAL_UINT8(0, found.n);
}

/* ... and the settings are good again after it. */
static void refused(const char *field, const struct candidates_config *good)
{
    struct interact_refusal reason = {NULL, NULL, 0, 0};
    enum err err = candidates_begin(&found, &plant, &channels, &config, &reason);
    expect_refusal(err, &reason, field);
    config = *good;
}

static void settings_out_of_range_are_refused_with_their_name(void)
{
    square_plant(1);
    plant.element[0][0].gain = REAL_C(1.0);
    const struct candidates_config good = config;
    config.smallest_lambda = 0;
    refused("smallest_lambda", &good);
    config.floor = (real_t)NAN;
    refused("floor", &good);
    config.draws = 19;
    refused("draws", &good);
    channels.n = 0;
    refused("channels", &good);
    channels = (struct pairs){1, {1}, {0}};
    refused("pairs", &good);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(candidates_are_those_that_trying_every_pairing_finds);
    RUN_TEST(sound_is_the_share_of_draws_in_which_the_pairs_would_do);
    RUN_TEST(a_pair_whose_gain_may_have_the_other_sign_is_not_sound);
    RUN_TEST(pairs_that_are_kept_apart_are_no_candidates);
    RUN_TEST(channels_may_be_any_of_a_larger_plant_in_any_order);
    RUN_TEST(a_plant_without_pairs_has_no_candidate_and_a_singular_one_is_refused);
    RUN_TEST(settings_out_of_range_are_refused_with_their_name);
    return UNITY_END();
}
