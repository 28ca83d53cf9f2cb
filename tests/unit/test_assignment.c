/* interact/assignment.[ch].
 *
 * Contract
 *   total cost      that of scipy.optimize.linear_sum_assignment on 1000 random matrices up to 16 x 16 (seeds 1 to 1000),
 *                   every third with forbidden elements, every fourth full of ties
 *   ties            the assignment that comes first in the order of columns, held against trying every one
 */
#include <stdio.h>
#include <string.h>

#include "csv.h"
#include "interact/assignment.h"
#include "random_source.h"
#include "unity.h"

static struct assignment a;
static uint8_t partner[INTERACT_MAX];

void setUp(void) {}
void tearDown(void) {}

/* As costs() of tests/reference/interact_reference.py. */
static void random_costs(uint64_t seed)
{
    struct random_source r = {seed};
    a.rows = (uint8_t)(1 + random_below(&r, 16));
    a.cols = (uint8_t)(1 + random_below(&r, 16));
    uint32_t limit = seed % 4 == 0 ? 5 : 1000001;
    for (unsigned i = 0; i < a.rows; i++)
        for (unsigned j = 0; j < a.cols; j++)
            a.cost[i][j] = (int32_t)random_below(&r, limit);
    for (unsigned i = 0; i < a.rows && seed % 3 == 0; i++)
        for (unsigned j = 0; j < a.cols; j++)
            if (random_below(&r, 2) == 0)
                a.cost[i][j] = ASSIGNMENT_FORBIDDEN;
}

static void totals_of_random_matrices_are_those_of_scipy(void)
{
    FILE *f = csv_open("reference/assignment.csv");
    double v[4];
    unsigned rows = 0, impossible = 0;
    while (csv_row(f, v, 4)) {
        random_costs((uint64_t)v[0]);
        TEST_ASSERT_EQUAL_UINT8((uint8_t)v[1], a.rows);
        TEST_ASSERT_EQUAL_UINT8((uint8_t)v[2], a.cols);
        int32_t total = -1;
        enum err err = assignment_solve(&a, partner, &total);
        char seed[32];
        snprintf(seed, sizeof seed, "seed %.0f", v[0]);
        rows++;
        if (v[3] < 0) {
            TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_EMPTY, err, seed);
            impossible++;
            continue;
        }
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, err, seed);
        TEST_ASSERT_EQUAL_INT_MESSAGE((int)v[3], total, seed);
        int32_t sum = 0;
        unsigned used = 0, taken = 0;
        for (unsigned i = 0; i < a.rows; i++) {
            if (partner[i] == INTERACT_NONE)
                continue;
            TEST_ASSERT_LESS_THAN_UINT8(a.cols, partner[i]);
            TEST_ASSERT_EQUAL_UINT(0, taken & (1u << partner[i]));
            taken |= 1u << partner[i];
            sum += a.cost[i][partner[i]];
            used++;
        }
        TEST_ASSERT_EQUAL_UINT(a.rows < a.cols ? a.rows : a.cols, used);
        TEST_ASSERT_EQUAL_INT_MESSAGE(total, sum, seed);
    }
    fclose(f);
    TEST_ASSERT_EQUAL_UINT(1000, rows);
    TEST_ASSERT_GREATER_THAN_UINT(5, impossible);
}

/* Every permutation of n columns in lexicographic order; keeps the first of the least total. */
static int32_t try_all(unsigned n, uint8_t *best)
{
    uint8_t p[INTERACT_MAX];
    int32_t least = INT32_MAX;
    for (unsigned i = 0; i < n; i++)
        p[i] = (uint8_t)i;
    for (;;) {
        int32_t sum = 0;
        for (unsigned i = 0; i < n; i++)
            sum += i < a.rows && p[i] < a.cols ? a.cost[i][p[i]] : 0;
        if (sum < least) {
            least = sum;
            memcpy(best, p, n);
        }
        unsigned i = n - 1;
        while (i > 0 && p[i - 1] > p[i])
            i--;
        if (i == 0)
            return least;
        unsigned j = n - 1;
        while (p[j] < p[i - 1])
            j--;
        uint8_t swap = p[i - 1];
        p[i - 1] = p[j];
        p[j] = swap;
        for (unsigned x = i, y = n - 1; x < y; x++, y--) {
            swap = p[x];
            p[x] = p[y];
            p[y] = swap;
        }
    }
}

static void of_equal_assignments_the_first_is_taken(void)
{
    for (uint64_t seed = 1; seed <= 400; seed++) {
        struct random_source r = {seed};
        a.rows = (uint8_t)(1 + random_below(&r, 6));
        a.cols = (uint8_t)(1 + random_below(&r, 6));
        for (unsigned i = 0; i < a.rows; i++)
            for (unsigned j = 0; j < a.cols; j++)
                a.cost[i][j] = (int32_t)random_below(&r, 3);
        uint8_t best[INTERACT_MAX];
        int32_t least = try_all(a.rows > a.cols ? a.rows : a.cols, best), total;
        TEST_ASSERT_EQUAL_INT(ERR_OK, assignment_solve(&a, partner, &total));
        TEST_ASSERT_EQUAL_INT(least, total);
        for (unsigned i = 0; i < a.rows; i++)
            TEST_ASSERT_EQUAL_UINT8(best[i] < a.cols ? best[i] : INTERACT_NONE, partner[i]);
    }
}

static void costs_and_sizes_out_of_range_are_refused(void)
{
    int32_t total;
    memset(&a, 0, sizeof a);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, assignment_solve(&a, partner, &total));
    a.rows = 17;
    a.cols = 1;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, assignment_solve(&a, partner, &total));
    a.rows = 1;
    a.cost[0][0] = -1;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, assignment_solve(&a, partner, &total));
    a.cost[0][0] = ASSIGNMENT_COST_MAX + 1;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, assignment_solve(&a, partner, &total));
    a.cost[0][0] = ASSIGNMENT_FORBIDDEN;
    TEST_ASSERT_EQUAL_INT(ERR_EMPTY, assignment_solve(&a, partner, &total));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(totals_of_random_matrices_are_those_of_scipy);
    RUN_TEST(of_equal_assignments_the_first_is_taken);
    RUN_TEST(costs_and_sizes_out_of_range_are_refused);
    return UNITY_END();
}
