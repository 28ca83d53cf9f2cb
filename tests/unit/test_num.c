/* num/num.h and num/accumulator.[ch] against double.
 *
 * Contract                                   float32              Q7.24
 *   num_from_float                           exact                half a step, 2^-25, ties away from zero
 *   num_mul, num_div (in range)              2^-24 relative       half a step, 2^-25
 *   add, sub                                 2^-24 relative       exact
 *   outside the range                        -                    saturates, keeps its sign
 *   coefficient                              exact                2^-24 relative, down to 2^-48
 *   accumulator, 1e6 products of 1e-9        1e-6 relative        1e-6 relative
 *   accumulator, a term and its negative     1e-7 x 2^-23 x term  exact
 *   accumulator_clamp inside the limits      changes nothing, remainder included
 */
#include <limits.h>
#include <math.h>

#include "csv.h"
#include "formats.h"
#include "num/accumulator.h"
#include "unity.h"

#define HALF_STEP (1.0 / 33554432.0) /* 2^-25 */

void setUp(void) {}
void tearDown(void) {}

static double bound(double value)
{
    double relative = fabs(value) * 2.0 * HALF_STEP;
    return BY_FORMAT(relative, HALF_STEP + 0.0 * relative) + 1e-30;
}

static void products_and_quotients_are_within_half_a_step_of_the_reference(void)
{
    FILE *f = csv_open("reference/num_operations.csv");
    double v[4];
    int rows = 0;
    while (csv_row(f, v, 4)) {
        num_t a = N(v[0]), b = N(v[1]);
        TEST_ASSERT_TRUE(D(a) == v[0] && D(b) == v[1]);
        TEST_ASSERT_DOUBLE_WITHIN(bound(v[2]), v[2], D(num_mul(a, b)));
        if (fabs(v[3]) < 127.0)
            TEST_ASSERT_DOUBLE_WITHIN(bound(v[3]), v[3], D(num_div(a, b)));
        TEST_ASSERT_DOUBLE_WITHIN(BY_FORMAT(bound(v[0] + v[1]), 0.0), v[0] + v[1],
                                  D(num_add(a, b)));
        TEST_ASSERT_DOUBLE_WITHIN(BY_FORMAT(bound(v[0] - v[1]), 0.0), v[0] - v[1],
                                  D(num_sub(a, b)));
        rows++;
    }
    fclose(f);
    TEST_ASSERT_GREATER_THAN(300, rows);
}

static void a_float_becomes_the_nearest_number(void)
{
    for (int i = -4000; i <= 4000; i++) {
        float x = (float)i * 0.0312345f;
        double want = (double)x;
        TEST_ASSERT_DOUBLE_WITHIN(BY_FORMAT(0.0, HALF_STEP), want, D(num_from_float(x)));
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.0, BY_FORMAT(HALF_STEP, 2 * HALF_STEP), D(N(HALF_STEP)));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, -BY_FORMAT(HALF_STEP, 2 * HALF_STEP), D(N(-HALF_STEP)));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, -128.0, D(N(-128.0)));
}

/* Draws every exponent and both signs: fractions at the ends, at ties, and between. */
static void a_float_of_any_size_becomes_the_nearest_number_ties_away_from_zero(void)
{
    for (uint32_t high = 0; high < 512; high++)
        for (uint32_t k = 0; k < 200; k++) {
            union {
                uint32_t u;
                float f;
            } x = {.u = high << 23};
            uint32_t power = 1u << k % 23u;
            x.u |= (k < 69 ? power - 1u + k / 23u : 0x7FFFFFu - k * 41943u) & 0x7FFFFFu;
            if (!isfinite(x.f))
                continue;
            double steps = floor(fabs((double)x.f) * 16777216.0 + 0.5) / 16777216.0;
            double nearest = x.f < 0.0f ? -steps : steps, top = 128.0 - 2 * HALF_STEP;
            nearest = nearest > top ? top : nearest < -128.0 ? -128.0 : nearest;
            TEST_ASSERT_TRUE(D(num_from_float(x.f)) == BY_FORMAT((double)x.f, nearest));
        }
}

static void division_by_zero_saturates_with_the_sign_of_the_dividend(void)
{
    TEST_ASSERT_TRUE(D(num_div(N(0.5), num_zero())) > 127.9);
    TEST_ASSERT_TRUE(D(num_div(N(-0.5), num_zero())) < -127.9);
    TEST_ASSERT_TRUE(D(num_div(num_zero(), num_zero())) == 0.0);
}

static void minimum_maximum_clamp_and_magnitude_choose_right(void)
{
    num_t a = N(-0.25), b = N(0.75);
    TEST_ASSERT_TRUE(num_eq(num_min(a, b), a) && num_eq(num_max(a, b), b));
    TEST_ASSERT_TRUE(num_eq(num_clamp(N(2), a, b), b) && num_eq(num_clamp(N(-2), a, b), a));
    TEST_ASSERT_TRUE(num_eq(num_clamp(N(0.5), a, b), N(0.5)));
    TEST_ASSERT_TRUE(num_eq(num_abs(a), N(0.25)) && num_eq(num_abs(b), b));
}

#ifdef REFLUX_FIXED_POINT
static void fixed_point_saturates_instead_of_wrapping(void)
{
    num_t top = {INT32_MAX}, bottom = {INT32_MIN};
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, num_add(top, N(1)).q);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, num_sub(bottom, N(1)).q);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, num_neg(bottom).q);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, num_abs(bottom).q);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, num_mul(bottom, bottom).q);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, num_mul(top, bottom).q);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, num_div(N(100), N(0.001)).q);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, num_div(bottom, (num_t){1}).q);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, num_from_float(1e30f).q);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, num_from_float(-1e30f).q);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, num_from_float(HUGE_VALF).q);
    TEST_ASSERT_EQUAL_INT32(0, num_from_float(nanf("")).q);
}

static void fixed_point_rounds_ties_away_from_zero_on_both_sides(void)
{
    num_t half = N(0.5), step = {1};
    TEST_ASSERT_EQUAL_INT32(1, num_mul(half, step).q);
    TEST_ASSERT_EQUAL_INT32(-1, num_mul(half, num_neg(step)).q);
    TEST_ASSERT_EQUAL_INT32(1, num_div(step, N(2)).q);
    TEST_ASSERT_EQUAL_INT32(-1, num_div(num_neg(step), N(2)).q);
}

static double accumulated(const struct accumulator *a)
{
    return (double)a->q48 / 281474976710656.0;
}

static double coefficient_value(struct coefficient c)
{
    return ldexp((double)c.mantissa, -c.shift);
}

/* A sum scaled by almost 2^-32: its last word is half a unit of 2^-48 or more, and rounds up. */
static void the_last_bit_of_a_scaled_sum_is_rounded(void)
{
    struct accumulator a = {.q48 = (1 << 23) - 1}, b = {.q48 = UINT32_MAX};
    TEST_ASSERT_EQUAL_INT32(0, accumulator_get(&a).q);
    accumulator_add_scaled(&a, (struct coefficient){.mantissa = INT32_MAX, .shift = 63}, &b);
    TEST_ASSERT_EQUAL_INT32(1, accumulator_get(&a).q);
    for (unsigned tenths = 4; tenths <= 6; tenths += 2) {
        a.q48 = (1 << 23) - 1;
        b.q48 = (int64_t)UINT32_MAX * tenths / 10;
        accumulator_add_scaled(&a, (struct coefficient){.mantissa = INT32_MAX, .shift = 63}, &b);
        TEST_ASSERT_EQUAL_INT32(tenths / 5, accumulator_get(&a).q);
    }
    b.q48 = UINT32_MAX;
    a.q48 = (1 << 23) - 1;
    accumulator_add_scaled(&a, (struct coefficient){.mantissa = INT32_MAX, .shift = 64}, &b);
    TEST_ASSERT_EQUAL_INT32(0, accumulator_get(&a).q);
}

static void the_accumulator_saturates_and_comes_back(void)
{
    struct accumulator a = {0};
    struct coefficient big = coefficient_from_float(1e9f);
    for (int i = 0; i < 5; i++)
        accumulator_add_product(&a, big, N(100));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, accumulator_get(&a).q);
    a.q48 = INT64_MAX; /* one least step more */
    accumulator_add_product(&a, coefficient_from_float(1.0f / 16777216.0f), (num_t){1});
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, accumulator_get(&a).q);
    for (int i = 0; i < 5; i++)
        accumulator_add_product(&a, big, N(-100));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, accumulator_get(&a).q);
    accumulator_clamp(&a, N(-1), N(1));
    TEST_ASSERT_TRUE(num_eq(N(-1), accumulator_get(&a)));
}
#else
static double accumulated(const struct accumulator *a)
{
    return (double)a->sum - (double)a->carry;
}

static double coefficient_value(struct coefficient c)
{
    return (double)c.value;
}
#endif

static void a_coefficient_keeps_its_digits_however_small(void)
{
    const float values[] = {0.7f,     -0.7f,  1.0f,  1.4e-5f, -3.3e-9f, 5e-13f,
                            3.6e-15f, 100.0f, -1e4f, 1e9f,    2.1e9f,   0.0f};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
        TEST_ASSERT_DOUBLE_WITHIN(fabs((double)values[i]) * 2.0 * HALF_STEP, (double)values[i],
                                  coefficient_value(coefficient_from_float(values[i])));
}

#ifdef REFLUX_FIXED_POINT
static void a_coefficient_out_of_range_is_clipped_or_zero(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 2147483647.0, coefficient_value(coefficient_from_float(1e20f)));
    TEST_ASSERT_DOUBLE_WITHIN(1.0, -2147483647.0,
                              coefficient_value(coefficient_from_float(-1e20f)));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, coefficient_value(coefficient_from_float(1e-16f)));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, coefficient_value(coefficient_from_float(nanf(""))));
}
#endif

static void a_million_products_of_a_billionth_add_up(void)
{
    struct accumulator a;
    accumulator_set(&a, N(0.5));
    struct coefficient c = coefficient_from_float(1.25e-5f);
    num_t x = N(1e-4);
    for (int i = 0; i < 1000000; i++)
        accumulator_add_product(&a, c, x);
    double want = 1e6 * (double)1.25e-5f * D(x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * want, want, accumulated(&a) - 0.5);
}

static void a_large_term_added_and_taken_away_leaves_the_small_remainder(void)
{
    struct accumulator a;
    accumulator_set(&a, N(0.3));
    accumulator_add_product(&a, coefficient_from_float(1e-9f), N(0.25));
    double before = accumulated(&a);
    struct coefficient gain = coefficient_from_float(97.0f);
    for (int i = 0; i < 100; i++) {
        num_t x = N(0.01 * i - 0.4);
        accumulator_add_product(&a, gain, x);
        accumulator_add_product(&a, gain, num_neg(x));
    }
    TEST_ASSERT_DOUBLE_WITHIN(BY_FORMAT(5e-12, 0.0), before, accumulated(&a));
}

static void a_value_set_is_the_value_read(void)
{
    struct accumulator a;
    for (int i = -1000; i <= 1000; i++) {
        num_t x = N(i * 0.00137);
        accumulator_set(&a, x);
        TEST_ASSERT_TRUE(num_eq(x, accumulator_get(&a)));
    }
}

static void clamping_inside_the_limits_keeps_the_remainder(void)
{
    struct accumulator a;
    accumulator_set(&a, N(0.5));
    accumulator_add_product(&a, coefficient_from_float(1e-10f), N(0.5));
    double before = accumulated(&a);
    accumulator_clamp(&a, N(0), N(1));
    TEST_ASSERT_TRUE(before == accumulated(&a));
    accumulator_clamp(&a, N(0.6), N(1));
    TEST_ASSERT_TRUE(num_eq(N(0.6), accumulator_get(&a)));
    accumulator_clamp(&a, N(0), N(0.25));
    TEST_ASSERT_TRUE(num_eq(N(0.25), accumulator_get(&a)));
}

static void what_is_clamped_is_the_limit_and_no_remainder(void)
{
    static const double ranges[][3] = {{0.6, 1, 0.6}, {0, 0.25, 0.25}};
    for (unsigned k = 0; k < 2; k++) {
        struct accumulator a;
        accumulator_set(&a, N(0.5));
        accumulator_add_product(&a, coefficient_from_float(1e-10f), N(0.5));
        TEST_ASSERT_TRUE(accumulated(&a) != 0.5); /* there is a remainder */
        accumulator_clamp(&a, N(ranges[k][0]), N(ranges[k][1]));
        TEST_ASSERT_TRUE(accumulated(&a) == D(N(ranges[k][2])));
    }
}

static void sums_are_added_taken_away_and_scaled_at_full_width(void)
{
    static const float factors[] = {1.0f, -1.0f, 0.3f, -1e-3f, 2.5e-6f, 90.0f};
    for (size_t i = 0; i < sizeof factors / sizeof factors[0]; i++) {
        struct accumulator a, b = {0};
        accumulator_set(&a, N(0.25));
        for (int k = 0; k < 200; k++) /* 200.0002: beyond Q7.24, and finer than it */
            accumulator_add_product(&b, coefficient_from_float(k % 2 ? 2.0f : 1e-9f),
                                    N(k < 198 ? 1 : -1));
        double sum = accumulated(&b);
        accumulator_add_sum(&a, &b);
        TEST_ASSERT_DOUBLE_WITHIN(1e-11, 0.25 + sum, accumulated(&a));
        accumulator_take_sum(&a, &b);
        TEST_ASSERT_DOUBLE_WITHIN(1e-11, 0.25, accumulated(&a));
        accumulator_add_scaled(&a, coefficient_from_float(factors[i]), &b);
        TEST_ASSERT_DOUBLE_WITHIN(3e-7 * fabs(factors[i] * sum), 0.25 + (double)factors[i] * sum,
                                  accumulated(&a));
    }
}

static void a_wide_sum_of_products_may_leave_the_range_and_come_back(void)
{
    static const double terms[][2] = {
        {127, 127}, {100, 127}, {-127, 127}, {-100, 127}, {0.5, 0.25}};
    num_wide_t sum = num_wide_zero();
    for (size_t i = 0; i < 5; i++)
        sum = num_wide_add(sum, N(terms[i][0]), N(terms[i][1]));
    TEST_ASSERT_DOUBLE_WITHIN(6e-8, 0.125, D(num_from_wide(sum)));
    sum = num_wide_add(num_wide_zero(), N(-0.3), N(0.7));
    TEST_ASSERT_DOUBLE_WITHIN(6e-8, -0.21, D(num_from_wide(sum)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(products_and_quotients_are_within_half_a_step_of_the_reference);
    RUN_TEST(a_float_becomes_the_nearest_number);
    RUN_TEST(a_float_of_any_size_becomes_the_nearest_number_ties_away_from_zero);
    RUN_TEST(division_by_zero_saturates_with_the_sign_of_the_dividend);
    RUN_TEST(minimum_maximum_clamp_and_magnitude_choose_right);
#ifdef REFLUX_FIXED_POINT
    RUN_TEST(fixed_point_saturates_instead_of_wrapping);
    RUN_TEST(fixed_point_rounds_ties_away_from_zero_on_both_sides);
    RUN_TEST(the_accumulator_saturates_and_comes_back);
    RUN_TEST(the_last_bit_of_a_scaled_sum_is_rounded);
    RUN_TEST(a_coefficient_out_of_range_is_clipped_or_zero);
#endif
    RUN_TEST(a_coefficient_keeps_its_digits_however_small);
    RUN_TEST(a_million_products_of_a_billionth_add_up);
    RUN_TEST(a_large_term_added_and_taken_away_leaves_the_small_remainder);
    RUN_TEST(a_value_set_is_the_value_read);
    RUN_TEST(clamping_inside_the_limits_keeps_the_remainder);
    RUN_TEST(what_is_clamped_is_the_limit_and_no_remainder);
    RUN_TEST(sums_are_added_taken_away_and_scaled_at_full_width);
    RUN_TEST(a_wide_sum_of_products_may_leave_the_range_and_come_back);
    return UNITY_END();
}
