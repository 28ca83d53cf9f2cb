/* Integration and steady state of columns of several sizes. */
#include "columns/column_solver.h"
#include "test_columns.h"
#include "unity.h"

#include <string.h>

static struct column_config config;
static struct column_inputs inputs;
static char err[256];

void setUp(void)
{
    config = ternary_config(COLUMN_HOLDUP_CONSERVATIVE);
    inputs = ternary_inputs();
    err[0] = '\0';
}

void tearDown(void) {}

static struct column_solver *make(const struct column_solver_options *options)
{
    struct column_solver *s = column_solver_create(&config, &inputs, options, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(s, err);
    return s;
}

static double distance(const struct column_solver *a, const struct column_solver *b)
{
    double max = 0;
    for (size_t i = 0; i < column_solver_column(a)->n_states; i++)
        max = fmax(max, fabs(column_solver_state(a)[i] - column_solver_state(b)[i]));
    return max;
}

static void the_settled_state_is_where_a_long_run_ends(void)
{
    for (int form = COLUMN_HOLDUP_MOLAR; form <= COLUMN_HOLDUP_CONSERVATIVE; form++) {
        config = ternary_config((enum column_holdup)form);
        struct column_solver *a = make(NULL), *b = make(NULL);
        TEST_ASSERT_TRUE_MESSAGE(column_solver_settle(a, err, sizeof err), err);
        TEST_ASSERT_TRUE(column_solver_time(a) == 0.0);
        TEST_ASSERT_TRUE_MESSAGE(column_solver_advance(b, 200000, err, sizeof err), err);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, distance(a, b));
        column_solver_destroy(a);
        column_solver_destroy(b);
    }
}

static void the_volume_forms_share_their_steady_state(void)
{
    struct column_solver *a = make(NULL);
    config.holdup = COLUMN_HOLDUP_VOLUMETRIC;
    struct column_solver *b = make(NULL);
    TEST_ASSERT_TRUE(column_solver_settle(a, err, sizeof err));
    TEST_ASSERT_TRUE(column_solver_settle(b, err, sizeof err));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, distance(a, b));
    column_solver_destroy(a);
    column_solver_destroy(b);
}

static void default_tolerances_agree_with_tight_ones(void)
{
    struct column_solver_options tight = {.relative = 1e-10, .absolute = 1e-12};
    struct column_solver *a = make(NULL), *b = make(&tight);
    for (int k = 1; k <= 40; k++) {
        inputs.heat = 700 + 60 * (k % 3);
        inputs.reflux_flow = 1.1e-6 * (1 + 0.1 * (k % 4));
        TEST_ASSERT_TRUE(column_solver_set_inputs(a, &inputs, err, sizeof err));
        TEST_ASSERT_TRUE(column_solver_set_inputs(b, &inputs, err, sizeof err));
        TEST_ASSERT_TRUE_MESSAGE(column_solver_advance(a, 30 * k, err, sizeof err), err);
        TEST_ASSERT_TRUE_MESSAGE(column_solver_advance(b, 30 * k, err, sizeof err), err);
        TEST_ASSERT_DOUBLE_WITHIN(2e-5, 0, distance(a, b));
    }
    column_solver_destroy(a);
    column_solver_destroy(b);
}

static void same_calls_give_the_same_bits(void)
{
    struct column_solver *s[2];
    for (int i = 0; i < 2; i++) {
        setUp();
        s[i] = make(NULL);
        TEST_ASSERT_TRUE(column_solver_settle(s[i], err, sizeof err));
        for (int k = 1; k <= 50; k++) {
            inputs.heat = 500 + 37 * (k % 11);
            TEST_ASSERT_TRUE(column_solver_set_inputs(s[i], &inputs, err, sizeof err));
            TEST_ASSERT_TRUE(column_solver_advance(s[i], 30 * k, err, sizeof err));
        }
    }
    TEST_ASSERT_EQUAL_MEMORY(column_solver_state(s[0]), column_solver_state(s[1]),
                             20 * sizeof(double));
    TEST_ASSERT_EQUAL_MEMORY(column_solver_column(s[0])->temperature,
                             column_solver_column(s[1])->temperature, 10 * sizeof(double));
    column_solver_destroy(s[0]);
    column_solver_destroy(s[1]);
}

static void wrong_configs_inputs_states_and_times_are_refused_in_words(void)
{
    config.efficiency = 2;
    TEST_ASSERT_NULL(column_solver_create(&config, &inputs, NULL, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("column: efficiency must be 0.01 to 1", err);
    setUp();
    inputs.heat = NAN;
    TEST_ASSERT_NULL(column_solver_create(&config, &inputs, NULL, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("column input heat must be 0 or more", err);

    setUp();
    struct column_solver *s = make(NULL);
    double before[20], bad[20];
    memcpy(before, column_solver_state(s), sizeof before);
    memcpy(bad, before, sizeof bad);
    bad[3] = 1.5;
    TEST_ASSERT_FALSE(column_solver_set_state(s, bad, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("column state: mole fractions must be in [0, 1]", err);
    bad[3] = NAN;
    TEST_ASSERT_FALSE(column_solver_set_state(s, bad, err, sizeof err));
    TEST_ASSERT_EQUAL_MEMORY(before, column_solver_state(s), sizeof before);
    TEST_ASSERT_TRUE(column_solver_advance(s, 60, err, sizeof err));
    TEST_ASSERT_FALSE(column_solver_advance(s, 30, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("column: advance to 30 s, which is before the present 60 s", err);
    TEST_ASSERT_FALSE(column_solver_advance(s, NAN, err, sizeof err));
    column_solver_destroy(s);
}

static void inputs_without_bubble_points_are_refused_and_the_old_ones_stay(void)
{
    struct column_solver *s = make(NULL), *untouched = make(NULL);
    struct column_inputs high = inputs;
    high.pressure_top = 9e6;
    TEST_ASSERT_FALSE(column_solver_set_inputs(s, &high, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("column: stage 1 has no boiling point within the temperature_range, "
                             "280 to 440 K, at 9.003e+06 Pa "
                             "with mole fractions TCE 0.02, PCE 0, heavy 0.98",
                             err);
    TEST_ASSERT_TRUE(column_solver_column(s)->inputs.pressure_top == inputs.pressure_top);
    TEST_ASSERT_TRUE_MESSAGE(column_solver_advance(s, 300, err, sizeof err), err);
    TEST_ASSERT_TRUE_MESSAGE(column_solver_advance(untouched, 300, err, sizeof err), err);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0, distance(s, untouched));
    column_solver_destroy(s);
    column_solver_destroy(untouched);
}

/* One call over the stretch, ticks of 30 s and ticks of 1 s, past the point where CVODE takes over. */
static void the_way_is_the_same_whatever_the_ticks(void)
{
    static const double ticks[] = {7200, 30, 1};
    struct column_solver *s[3];
    for (int i = 0; i < 3; i++) {
        s[i] = make(NULL);
        TEST_ASSERT_TRUE(column_solver_settle(s[i], err, sizeof err));
        for (int jump = 0; jump < 3; jump++) {
            struct column_inputs u = inputs;
            u.heat *= 1 + 0.05 * jump;
            u.reflux_flow *= 1 - 0.05 * jump;
            TEST_ASSERT_TRUE(column_solver_set_inputs(s[i], &u, err, sizeof err));
            for (double t = 0; t < 7200; t += ticks[i])
                TEST_ASSERT_TRUE_MESSAGE(
                    column_solver_advance(s[i], 7200 * jump + t + ticks[i], err, sizeof err), err);
        }
    }
    TEST_ASSERT_TRUE_MESSAGE(column_solver_work(s[1]).restarts >= 3, "CVODE took over");
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, distance(s[0], s[1]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, distance(s[0], s[2]));
    for (int i = 0; i < 3; i++)
        column_solver_destroy(s[i]);
}

static void a_large_column_settles_and_runs(void)
{
    config.stages = 150;
    config.feed_stage = 60;
    config.holdup = COLUMN_HOLDUP_MOLAR;
    config.holdup_reboiler = 8;
    config.holdup_tray = 0.3;
    config.holdup_condenser = 1.5;
    struct column_solver *s = make(NULL);
    TEST_ASSERT_TRUE_MESSAGE(column_solver_settle(s, err, sizeof err), err);
    const struct column *c = column_solver_column(s);
    double in = c->flows.feed * inputs.feed_fraction[0];
    double out = c->flows.distillate * column_fraction(c, column_solver_state(s), 149, 0) +
                 c->flows.bottoms * column_fraction(c, column_solver_state(s), 0, 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8 * in, in, out);
    inputs.heat *= 1.05;
    TEST_ASSERT_TRUE(column_solver_set_inputs(s, &inputs, err, sizeof err));
    TEST_ASSERT_TRUE_MESSAGE(column_solver_advance(s, 600, err, sizeof err), err);
    column_solver_destroy(s);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_settled_state_is_where_a_long_run_ends);
    RUN_TEST(the_volume_forms_share_their_steady_state);
    RUN_TEST(default_tolerances_agree_with_tight_ones);
    RUN_TEST(same_calls_give_the_same_bits);
    RUN_TEST(wrong_configs_inputs_states_and_times_are_refused_in_words);
    RUN_TEST(inputs_without_bubble_points_are_refused_and_the_old_ones_stay);
    RUN_TEST(the_way_is_the_same_whatever_the_ticks);
    RUN_TEST(a_large_column_settles_and_runs);
    return UNITY_END();
}
