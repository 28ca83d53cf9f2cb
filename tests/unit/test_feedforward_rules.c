/* Rules for feedforward elements (design/feedforward_rules.h), in single and double precision. Oracles: how far Shinskey's settings are from the
 * ideal element in the nine cases of R. Siddha (2003), as the digest's author recomputed them (his thesis has the absolute values, tables
 * 2.5 and so on; two decimals). Contract: misses to 0.006 dB and 0.06 degrees, a hundredth more than what they are rounded to. */
#include <math.h>

#include "design/feedforward_rules.h"
#include "interact/plant.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static const struct fopdt process = {
    .gain = REAL_C(2.0), .dead_time_s = REAL_C(0.6), .time_constant_s = REAL_C(0.4)};

/* Name, dead time and time constant of the disturbance's path; misses of Shinskey's element at 0.5, 2 and 6 rad/s. */
static const struct nine {
    const char *name;
    double dead, time, db[3], degrees[3];
} nine[] = {
    {"III c", 0.4, 0.25, {0.06, 0.93, 4.74}, {0.0, -2.1, -29.1}},
    {"I c", 0.6, 0.25, {0, 0, 0}, {0, 0, 0}},
    {"II c", 0.8, 0.25, {-0.19, -1.52, -3.59}, {0.4, 9.7, 57.2}},
    {"III b", 0.4, 0.4, {0.05, 0.76, 4.31}, {-0.1, -1.7, -23.4}},
    {"I b", 0.6, 0.4, {0, 0, 0}, {0, 0, 0}},
    {"II b", 0.8, 0.4, {0, 0, 0}, {0, 0.3, 6.8}},
    {"III a", 0.4, 0.5, {0.26, 1.58, 2.59}, {-0.7, -14.1, -63.5}},
    {"I a", 0.6, 0.5, {0, 0, 0}, {0, 0, 0}},
    {"II a", 0.8, 0.5, {-0.08, -1.21, -5.15}, {0, 2.7, 40.3}},
};
#define NINE (sizeof nine / sizeof nine[0])

static struct fopdt path_of(const struct nine *n)
{
    return (struct fopdt){
        .gain = REAL_C(2.0), .dead_time_s = (real_t)n->dead, .time_constant_s = (real_t)n->time};
}

static struct cplx ideal_at(const struct fopdt *disturbance, real_t omega)
{
    return cplx_scale(cplx_div(fopdt_response(disturbance, omega), fopdt_response(&process, omega)),
                      -1);
}

static void the_nine_cases_are_told_apart(void)
{
    for (unsigned k = 0; k < NINE; k++) {
        struct fopdt d = path_of(&nine[k]);
        TEST_ASSERT_EQUAL_STRING(
            nine[k].name, feedforward_case_name(feedforward_case_of(&process, &d, REAL_C(0.02))));
    }
}

static void what_is_nearly_equal_is_equal(void)
{
    struct fopdt d = {.gain = 1, .dead_time_s = REAL_C(0.62), .time_constant_s = REAL_C(0.41)};
    TEST_ASSERT_EQUAL_STRING(
        "I b", feedforward_case_name(feedforward_case_of(&process, &d, REAL_C(0.05))));
    TEST_ASSERT_EQUAL_STRING(
        "II a", feedforward_case_name(feedforward_case_of(&process, &d, REAL_C(0.01))));
}

/* 0.41 is 2.44 % from 0.4 by the larger of the two. */
static void nearly_is_of_the_larger_time_constant_whichever_path_has_it(void)
{
    struct fopdt slow = {.gain = 1, .dead_time_s = REAL_C(0.6), .time_constant_s = REAL_C(0.41)};
    struct fopdt fast = slow;
    fast.time_constant_s = REAL_C(0.4);
    TEST_ASSERT_EQUAL(SLOW_NEITHER, feedforward_case_of(&fast, &slow, REAL_C(0.0247)).slow);
    TEST_ASSERT_EQUAL(SLOW_NEITHER, feedforward_case_of(&slow, &fast, REAL_C(0.0247)).slow);
    TEST_ASSERT_EQUAL(SLOW_DISTURBANCE, feedforward_case_of(&fast, &slow, REAL_C(0.0241)).slow);
    TEST_ASSERT_EQUAL(SLOW_PROCESS, feedforward_case_of(&slow, &fast, REAL_C(0.0241)).slow);
}

/* III c far ahead: tq - 0.2 tm - 0.6 (dm - dq) is -2.7. */
static void a_lag_of_shinskey_s_that_comes_out_below_0_is_0(void)
{
    struct fopdt late = {.gain = 1, .dead_time_s = 5, .time_constant_s = 1};
    struct fopdt d = {.gain = 1, .dead_time_s = 0, .time_constant_s = REAL_C(0.5)};
    struct feedforward_rule rule;
    TEST_ASSERT_EQUAL(ERR_OK, feedforward_shinskey(&late, &d, REAL_C(0.02), &rule));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, (double)rule.lag_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 2.8, (double)rule.lead_s);
}

static void shinskey_s_elements_miss_by_what_the_digest_has(void)
{
    static const double omega[3] = {0.5, 2, 6};
    for (unsigned k = 0; k < NINE; k++) {
        struct fopdt d = path_of(&nine[k]);
        struct feedforward_rule rule;
        TEST_ASSERT_EQUAL(ERR_OK, feedforward_shinskey(&process, &d, REAL_C(0.02), &rule));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, -1, (double)rule.gain);
        for (unsigned i = 0; i < 3; i++) {
            struct feedforward_miss miss = feedforward_miss_of(
                feedforward_rule_response(&rule, (real_t)omega[i]), ideal_at(&d, (real_t)omega[i]));
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.006, nine[k].db[i], (double)miss.db, nine[k].name);
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.06, nine[k].degrees[i], (double)miss.degrees,
                                              nine[k].name);
        }
    }
}

static void the_exact_element_cancels_where_no_prediction_is_needed(void)
{
    for (unsigned k = 0; k < NINE; k++) {
        struct fopdt d = path_of(&nine[k]);
        struct feedforward_rule rule;
        TEST_ASSERT_EQUAL(ERR_OK, feedforward_exact(&process, &d, &rule));
        struct feedforward_miss miss =
            feedforward_miss_of(feedforward_rule_response(&rule, 6), ideal_at(&d, 6));
        double ahead = 0.6 - nine[k].dead; /* what it would have to see of the future */
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, (double)miss.db);
        TEST_ASSERT_DOUBLE_WITHIN(1e-2, ahead > 0 ? -6 * ahead * 180 / acos(-1) : 0,
                                  (double)miss.degrees);
    }
}

static void models_that_are_none_are_refused(void)
{
    struct feedforward_rule rule;
    struct fopdt none = {.gain = 0, .dead_time_s = 1, .time_constant_s = 1};
    TEST_ASSERT_EQUAL(ERR_RANGE, feedforward_shinskey(&none, &process, REAL_C(0.02), &rule));
    TEST_ASSERT_EQUAL(ERR_RANGE, feedforward_exact(&none, &process, &rule));
    none = (struct fopdt){.gain = (real_t)NAN, .dead_time_s = 1, .time_constant_s = 1};
    TEST_ASSERT_NOT_EQUAL(ERR_OK, feedforward_shinskey(&process, &none, REAL_C(0.02), &rule));
    none = (struct fopdt){.gain = 1, .dead_time_s = -1, .time_constant_s = 1};
    TEST_ASSERT_NOT_EQUAL(ERR_OK, feedforward_exact(&process, &none, &rule));
}

/* ---- misses ---- */

static void phases_are_right_all_round(void)
{
    for (int degrees = -179; degrees <= 180; degrees++) {
        double angle = degrees * acos(-1) / 180;
        struct feedforward_miss miss = feedforward_miss_of(
            cplx((real_t)(3 * cos(angle)), (real_t)(3 * sin(angle))), cplx(3, 0));
        double off = fabs((double)miss.degrees - degrees);
        TEST_ASSERT_TRUE(off < 1e-3 || off > 359.999);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, (double)miss.db);
    }
}

static void the_largest_miss_and_all_together(void)
{
    const struct feedforward_miss miss[3] = {{3, -10}, {-4, 0}, {0, 5}};
    struct feedforward_miss largest, together;
    feedforward_misses(3, miss, &largest, &together);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 4, (double)largest.db);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 10, (double)largest.degrees);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 5, (double)together.db);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, sqrt(125), (double)together.degrees);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_nine_cases_are_told_apart);
    RUN_TEST(what_is_nearly_equal_is_equal);
    RUN_TEST(nearly_is_of_the_larger_time_constant_whichever_path_has_it);
    RUN_TEST(a_lag_of_shinskey_s_that_comes_out_below_0_is_0);
    RUN_TEST(shinskey_s_elements_miss_by_what_the_digest_has);
    RUN_TEST(the_exact_element_cancels_where_no_prediction_is_needed);
    RUN_TEST(models_that_are_none_are_refused);
    RUN_TEST(phases_are_right_all_round);
    RUN_TEST(the_largest_miss_and_all_together);
    return UNITY_END();
}
