/* Least squares by rotations. */
#include <math.h>

#include "identify/triangle.h"
#include "unity.h"

static real_t memory[100], other[100];
static struct triangle triangle, lower;

void setUp(void) {}
void tearDown(void) {}

#define EPS ((double)REAL_EPSILON)

/* y = 2 x - 3 and what is left of points beside it: with x -1, 0, 1, 2 and errors +-1 that x and 1 do not explain. */
static void take_points(void)
{
    static const double x[4] = {-1, 0, 1, 2}, e[4] = {1, -1, -1, 1};
    triangle_begin(&triangle, 3, 0, memory);
    for (int k = 0; k < 4; k++) {
        real_t row[3] = {(real_t)x[k], 1, (real_t)(2 * x[k] - 3 + e[k])};
        triangle_row(&triangle, row);
    }
}

static void test_a_line_through_points_is_found(void)
{
    real_t theta[2];
    take_points();
    TEST_ASSERT_EQUAL(ERR_OK, triangle_solve(&triangle, theta));
    /* 6 columns, and a norm of rows below 12 over the least singular value above 1 */
    TEST_ASSERT_DOUBLE_WITHIN(18 * 12 * EPS, 2, (double)theta[0]);
    TEST_ASSERT_DOUBLE_WITHIN(18 * 12 * EPS, -3, (double)theta[1]);
}

static void test_what_is_left_is_the_sum_of_squared_errors(void)
{
    take_points();
    TEST_ASSERT_DOUBLE_WITHIN(2 * 2 * 18 * 12 * EPS, 4, (double)triangle_rest(&triangle));
}

static void test_the_spread_is_that_of_the_normal_equations(void)
{
    real_t theta[2], spread[2];
    take_points();
    TEST_ASSERT_EQUAL(ERR_OK, triangle_solve(&triangle, theta));
    triangle_spread(&triangle, spread);
    /* X'X = (6 2; 2 4), its inverse (4 -2; -2 6)/20 */
    TEST_ASSERT_DOUBLE_WITHIN(100 * EPS, sqrt(0.2), (double)spread[0]);
    TEST_ASSERT_DOUBLE_WITHIN(100 * EPS, sqrt(0.3), (double)spread[1]);
}

static void test_columns_that_are_left_out_are_as_if_they_had_not_been_there(void)
{
    static const uint8_t without_x[2] = {1, 2};
    real_t theta[1];
    take_points();
    triangle_select(&triangle, without_x, 2, &lower, other);
    TEST_ASSERT_EQUAL(ERR_OK, triangle_solve(&lower, theta));
    TEST_ASSERT_DOUBLE_WITHIN(200 * EPS, -2, (double)theta[0]);                      /* mean */
    TEST_ASSERT_DOUBLE_WITHIN(2 * 5 * 200 * EPS, 24, (double)triangle_rest(&lower)); /* about it */
}

static void test_columns_may_change_places(void)
{
    static const uint8_t turned[3] = {1, 0, 2};
    real_t theta[2];
    take_points();
    triangle_select(&triangle, turned, 3, &lower, other);
    TEST_ASSERT_EQUAL(ERR_OK, triangle_solve(&lower, theta));
    TEST_ASSERT_DOUBLE_WITHIN(2 * 18 * 12 * EPS, 2, (double)theta[1]);
}

static void test_a_column_twice_is_singular(void)
{
    real_t theta[2];
    triangle_begin(&triangle, 3, 0, memory);
    for (int k = 0; k < 10; k++) {
        real_t x = REAL_C(0.1) * (real_t)(k * k % 7), row[3] = {x, REAL_C(0.3) * x, 1};
        triangle_row(&triangle, row);
    }
    TEST_ASSERT_EQUAL(ERR_SINGULAR, triangle_solve(&triangle, theta));
}

static void test_no_rows_are_singular(void)
{
    real_t theta[2];
    triangle_begin(&triangle, 3, 0, memory);
    TEST_ASSERT_EQUAL(ERR_SINGULAR, triangle_solve(&triangle, theta));
}

static void test_squares_of_large_and_of_tiny_numbers_do_not_leave_the_range(void)
{
    static const double sizes[2] = {1e15, 1e-25};
    for (int s = 0; s < 2; s++) {
        real_t theta[1];
        triangle_begin(&triangle, 2, 0, memory);
        for (int k = 1; k < 5; k++) {
            real_t row[2] = {(real_t)(k * sizes[s]), (real_t)(3 * k * sizes[s])};
            triangle_row(&triangle, row);
        }
        TEST_ASSERT_EQUAL(ERR_OK, triangle_solve(&triangle, theta));
        TEST_ASSERT_DOUBLE_WITHIN(100 * EPS, 3, (double)theta[0]);
    }
}

static void test_what_stands_on_the_right_is_rotated_along(void)
{
    triangle_begin(&triangle, 1, 2, memory);
    real_t row[2][3] = {{3, 1, 2}, {4, 5, -1}};
    for (int k = 0; k < 2; k++)
        triangle_row(&triangle, row[k]);
    const real_t *r = triangle_at(&triangle, 0); /* along (0.6, 0.8) */
    TEST_ASSERT_DOUBLE_WITHIN(60 * EPS, 5, (double)r[0]);
    TEST_ASSERT_DOUBLE_WITHIN(60 * EPS, 4.6, (double)r[1]);
    TEST_ASSERT_DOUBLE_WITHIN(60 * EPS, 0.4, (double)r[2]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_line_through_points_is_found);
    RUN_TEST(test_what_is_left_is_the_sum_of_squared_errors);
    RUN_TEST(test_the_spread_is_that_of_the_normal_equations);
    RUN_TEST(test_columns_that_are_left_out_are_as_if_they_had_not_been_there);
    RUN_TEST(test_columns_may_change_places);
    RUN_TEST(test_a_column_twice_is_singular);
    RUN_TEST(test_no_rows_are_singular);
    RUN_TEST(test_squares_of_large_and_of_tiny_numbers_do_not_leave_the_range);
    RUN_TEST(test_what_stands_on_the_right_is_rotated_along);
    return UNITY_END();
}
