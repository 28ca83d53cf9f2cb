/* Which inputs take outputs where they are asked to be (kinds/ahead/column_ahead_law.h). Contract: 2000 random matrices of up to four loops with
 * condition numbers to 30 and no input at a limit: moves within 2 % of the exact ones (the damping's share), after a second turn on what is
 * left within 0.1 %. The same
 * for loops whose inputs are not at a limit where others are. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "kinds/ahead/column_ahead_law.h"
#include "kinds/ahead/column_ahead_law_state.h"
#include "unity.h"

#define CASES 2000

static unsigned long long seed = 180618;

void setUp(void) {}
void tearDown(void) {}

static double drawn(void) /* -1 to 1 */
{
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return (double)(long long)(seed >> 11) / 4503599627370496.0 - 1.0;
}

static void draw(struct ahead_law *law, int n, double spread)
{
    memset(law, 0, sizeof *law);
    law->n = (uint8_t)n;
    law->acting = (uint8_t)((1u << n) - 1u);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            law->b[i][j] = (real_t)(0.3 * drawn() + (i == j ? spread : 0));
        law->u[i] = (real_t)(0.5 + 0.2 * drawn());
        law->lo[i] = -1000;
        law->hi[i] = 1000;
    }
}

static double left_over(const struct ahead_law *law, const real_t *before, const real_t *e)
{
    double sum = 0;
    for (int i = 0; i < law->n; i++) {
        double left = (double)e[i];
        for (int j = 0; j < law->n; j++)
            left -= (double)law->b[i][j] * ((double)law->u[j] - (double)before[j]);
        sum += left * left;
    }
    return sum;
}

static void outputs_are_taken_where_they_are_asked_to_be(void)
{
    double worst = 0, second = 0;
    for (int k = 0; k < CASES; k++) {
        struct ahead_law law;
        int n = 1 + k % 4;
        real_t e[4] = {0}, first[4];
        draw(&law, n, 1.5);
        for (int i = 0; i < n; i++)
            e[i] = (real_t)(0.1 * drawn());
        memcpy(first, law.u, sizeof first);
        TEST_ASSERT_TRUE(ahead_law_solve(&law, e));
        worst = fmax(worst, sqrt(left_over(&law, first, e)) / 0.1);
        real_t rest[4] = {0};
        for (int i = 0; i < n; i++) {
            double left = (double)e[i];
            for (int j = 0; j < n; j++)
                left -= (double)law.b[i][j] * ((double)law.u[j] - (double)first[j]);
            rest[i] = (real_t)left;
        }
        real_t before[4];
        memcpy(before, law.u, sizeof before);
        TEST_ASSERT_TRUE(ahead_law_solve(&law, rest));
        second = fmax(second, sqrt(left_over(&law, before, rest)) / 0.1);
    }
    printf("left over: %.2g of what was asked, after a second turn %.2g\n", worst, second);
    TEST_ASSERT_TRUE(worst < 0.02);
    TEST_ASSERT_TRUE(second < 0.001);
}

static void loops_whose_inputs_are_not_at_a_limit_come_to_where_they_are_asked_to_be(void)
{
    unsigned limited = 0;
    for (int k = 0; k < CASES; k++) {
        struct ahead_law law;
        int n = 2 + k % 3;
        real_t e[4] = {0}, first[4];
        draw(&law, n, 1.5);
        for (int i = 0; i < n; i++) {
            e[i] = (real_t)(0.9 * drawn());
            law.lo[i] = 0;
            law.hi[i] = 1;
        }
        memcpy(first, law.u, sizeof first);
        TEST_ASSERT_TRUE(ahead_law_solve(&law, e));
        for (int i = 0; i < n; i++) {
            double left = (double)e[i];
            TEST_ASSERT_TRUE(law.u[i] >= 0 && law.u[i] <= 1);
            limited += law.u[i] <= 0 || law.u[i] >= 1;
            for (int j = 0; j < n; j++)
                left -= (double)law.b[i][j] * ((double)law.u[j] - (double)first[j]);
            TEST_ASSERT_TRUE(law.u[i] <= 0 || law.u[i] >= 1 || fabs(left) < 0.02);
        }
    }
    printf("%u inputs at a limit\n", limited);
    TEST_ASSERT_TRUE(limited > CASES / 4);
}

static void an_input_at_a_limit_says_what_would_have_been_right(void)
{
    struct ahead_law law = {
        .n = 2, .acting = 3, .b = {{1, 0.2f}, {0.2f, 1}}, .u = {0.9f, 0.5f}, .hi = {1, 1}};
    TEST_ASSERT_TRUE(ahead_law_solve(&law, (real_t[]){0.3f, 0}));
    TEST_ASSERT_EQUAL_FLOAT(1, law.u[0]);
    TEST_ASSERT_TRUE(law.asked[0] > 1.19f);
    TEST_ASSERT_EQUAL_FLOAT(law.u[1], law.asked[1]);
}

static void an_input_that_does_nothing_stays(void)
{
    struct ahead_law law = {
        .n = 2, .acting = 3, .b = {{1, 0}, {0.5f, 0}}, .u = {0.5f, 0.5f}, .hi = {1, 1}};
    TEST_ASSERT_TRUE(ahead_law_solve(&law, (real_t[]){0.1f, 0.05f}));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.6f, law.u[0]);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, law.u[1]);
}

static void where_no_input_does_anything_there_is_no_answer(void)
{
    struct ahead_law law = {.n = 1, .acting = 1, .u = {0.5f}, .hi = {1}};
    TEST_ASSERT_FALSE(ahead_law_solve(&law, (real_t[]){0.1f}));
}

static void a_loop_by_hand_neither_moves_nor_counts(void)
{
    struct ahead_law law = {
        .n = 2, .acting = 1, .b = {{1, 0.5f}, {0.5f, 1}}, .u = {0.5f, 0.5f}, .hi = {1, 1}};
    TEST_ASSERT_TRUE(ahead_law_solve(&law, (real_t[]){0.1f, 0.4f}));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.6f, law.u[0]);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, law.u[1]);
}

int main(void)
{
    printf("seed %llu\n", seed);
    UNITY_BEGIN();
    RUN_TEST(outputs_are_taken_where_they_are_asked_to_be);
    RUN_TEST(loops_whose_inputs_are_not_at_a_limit_come_to_where_they_are_asked_to_be);
    RUN_TEST(an_input_at_a_limit_says_what_would_have_been_right);
    RUN_TEST(an_input_that_does_nothing_stays);
    RUN_TEST(where_no_input_does_anything_there_is_no_answer);
    RUN_TEST(a_loop_by_hand_neither_moves_nor_counts);
    return UNITY_END();
}
