/* Columns whose holdups move, under the solver: Newton matrices, steady states, balances, vessels that run empty or over. */
#include "columns/column_newton.h"
#include "columns/column_solver.h"
#include "holdup_columns.h"
#include "random_source.h"
#include "unity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FRACTIONS (2 * HOLDUP_STAGES)
#define N         (FRACTIONS + HOLDUP_STAGES)
#define REBOILER  FRACTIONS
#define DRUM      (N - 1)

static struct column_config config;
static struct column_inputs inputs;
static struct column_solver *solver;
static const struct column_solver_options *options;
static char err[256];

void setUp(void)
{
    config = holdup_config(COLUMN_LEVEL_BY_PRODUCT, COLUMN_LEVEL_BY_PRODUCT);
    inputs = holdup_inputs();
    solver = NULL;
    options = NULL;
    err[0] = '\0';
}

void tearDown(void)
{
    column_solver_destroy(solver);
}

static void make(void)
{
    column_solver_destroy(solver);
    solver = column_solver_create(&config, &inputs, options, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(solver, err);
}

static const struct column_flows *flows(void)
{
    return &column_solver_column(solver)->flows;
}

static double state(size_t i)
{
    return column_solver_state(solver)[i];
}

static void take_inputs(void)
{
    TEST_ASSERT_TRUE_MESSAGE(column_solver_set_inputs(solver, &inputs, err, sizeof err), err);
}

static void run(double seconds)
{
    double t = column_solver_time(solver) + seconds;
    TEST_ASSERT_TRUE_MESSAGE(column_solver_advance(solver, t, err, sizeof err), err);
}

static void settle(void)
{
    TEST_ASSERT_TRUE_MESSAGE(column_solver_settle(solver, err, sizeof err), err);
}

static double uniform(struct random_source *r)
{
    return (double)(random_next(r) >> 11) / 9007199254740992.0;
}

/* Both product flows as inputs, at what they are nominally. */
static void products_of_reference(void)
{
    inputs.distillate_flow = column_solver_column(solver)->reference.distillate;
    inputs.bottoms_flow = column_solver_column(solver)->reference.bottoms;
    take_inputs();
}

/* ---- Newton matrices ---- */

static void residue(double a, double c, double bound)
{
    struct column column = *column_solver_column(solver);
    struct column_newton *newton = column_newton_create(&config);
    double x[N], rates[N];
    TEST_ASSERT_NOT_NULL(newton);
    memcpy(x, column_solver_state(solver), column.n_states * sizeof *x);
    TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
    column_newton_read(newton, &column, x);
    TEST_ASSERT_TRUE(column_newton_factor(newton, a, c));
    for (size_t k = 0; k < column.n_states; k++) {
        double b[N] = {0}, v[N], at[N], above[N], below[N], largest = 0.0;
        b[k] = 1.0;
        column_newton_solve(newton, b, v);
        column_newton_solve(newton, b, b);
        TEST_ASSERT_EQUAL_MEMORY(v, b, column.n_states * sizeof *b);
        memset(b, 0, sizeof b);
        b[k] = 1.0;
        for (size_t i = 0; i < column.n_states; i++)
            largest = fmax(largest, fabs(v[i]));
        double h = 1e-6 / largest;
        for (size_t i = 0; i < column.n_states; i++)
            at[i] = x[i] + h * v[i];
        TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, at, above));
        for (size_t i = 0; i < column.n_states; i++)
            at[i] = x[i] - h * v[i];
        TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, at, below));
        for (size_t i = 0; i < column.n_states; i++)
            TEST_ASSERT_DOUBLE_WITHIN(bound, b[i], a * v[i] + c * (above[i] - below[i]) / (2 * h));
    }
    column_newton_destroy(newton);
}

static void newton_matrices_have_what_holdups_do_in_every_structure(void)
{
    struct random_source r = {7};
    for (int structure = 0; structure < 9; structure++)
        for (int trays = 0; trays < 2; trays++)
            for (int low = 0; low < 3; low++) {
                config = holdup_config((enum column_level_by)(structure / 3),
                                       (enum column_level_by)(structure % 3));
                if (low == 1) { /* so weak that they still ask for something then */
                    config.hydraulic_time *= 10;
                    config.condenser_level.gain *= 0.1;
                    config.reboiler_level.gain *= 0.1;
                }
                if (!trays)
                    config.hydraulic_time = 0;
                inputs = holdup_inputs();
                inputs.reflux_subcooling = 20 * low;
                make();
                products_of_reference();
                double x[N];
                size_t n = column_solver_column(solver)->n_states;
                for (size_t i = 0; i < n; i++)
                    x[i] = i < FRACTIONS ? 0.05 + 0.4 * uniform(&r) : 0.7 + 0.6 * uniform(&r);
                if (low == 1)
                    for (size_t i = FRACTIONS; i < n; i++)
                        x[i] = config.limit_softness * (0.2 + 0.6 * uniform(&r));
                if (low == 2)
                    x[REBOILER] = 2.3, x[n - 1] = 2.2;
                TEST_ASSERT_TRUE_MESSAGE(column_solver_set_state(solver, x, err, sizeof err), err);
                residue(1.0, -3.0, 1e-5);
                residue(1.0, -1e-2, 1e-5);
            }
}

static void newton_matrices_follow_activity_coefficients(void)
{
    struct random_source r = {8};
    for (int k = 0; k < 4; k++) {
        double x[N];
        make_nonideal(&config, k % 2 ? &nrtl_tables : &wilson_tables);
        make();
        for (size_t i = 0; i < N; i++)
            x[i] = i < FRACTIONS ? 0.05 + 0.4 * uniform(&r) : 0.7 + 0.6 * uniform(&r);
        TEST_ASSERT_TRUE_MESSAGE(column_solver_set_state(solver, x, err, sizeof err), err);
        residue(1.0, -3.0, 1e-4);
    }
}

/* ---- steady states ---- */

static void every_structure_starts_at_rest_where_perfect_levels_are(void)
{
    config.levels = COLUMN_LEVELS_PERFECT;
    config.hydraulic_time = 0;
    make();
    settle();
    double perfect[FRACTIONS];
    memcpy(perfect, column_solver_state(solver), sizeof perfect);
    struct column_flows reference = *flows();
    for (int structure = 0; structure < 9; structure++) {
        config = holdup_config((enum column_level_by)(structure / 3),
                               (enum column_level_by)(structure % 3));
        make();
        products_of_reference();
        settle();
        run(3600);
        for (size_t i = 0; i < FRACTIONS; i++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-8, perfect[i], state(i));
        for (size_t i = FRACTIONS; i < N; i++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-8, 1, state(i));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, reference.distillate, flows()->distillate);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, reference.bottoms, flows()->bottoms);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, reference.reflux, flows()->reflux);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, reference.vapour_stripping, flows()->vapour_stripping);
    }
}

static void after_a_step_every_structure_settles_where_a_long_run_ends(void)
{
    static const enum column_level_by both[3][2] = {
        {COLUMN_LEVEL_BY_PRODUCT, COLUMN_LEVEL_BY_PRODUCT},
        {COLUMN_LEVEL_BY_INTERNAL, COLUMN_LEVEL_BY_PRODUCT},
        {COLUMN_LEVEL_BY_PRODUCT, COLUMN_LEVEL_BY_INTERNAL},
    };
    for (int k = 0; k < 3; k++) {
        config = holdup_config(both[k][0], both[k][1]);
        inputs = holdup_inputs();
        make();
        products_of_reference();
        inputs.reflux_flow *= 1.03;
        inputs.boilup *= 1.02;
        inputs.distillate_flow *= 1.02;
        inputs.bottoms_flow *= 0.97;
        inputs.feed_flow *= 1.01;
        take_inputs();
        run(400000);
        double end[N];
        memcpy(end, column_solver_state(solver), sizeof end);
        const struct column_inputs moved = inputs;
        inputs = holdup_inputs();
        make();
        inputs = moved;
        take_inputs();
        settle();
        for (size_t i = 0; i < N; i++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, end[i], state(i));
    }
}

static void columns_with_activity_coefficients_settle_where_a_long_run_ends(void)
{
    for (int k = 0; k < 2; k++) {
        inputs = holdup_inputs();
        make_nonideal(&config, k ? &nrtl_tables : &wilson_tables);
        make();
        inputs.reflux_flow *= 1.05;
        take_inputs();
        long rates = column_solver_work(solver).rates;
        settle();
        rates = column_solver_work(solver).rates - rates;
        TEST_ASSERT_TRUE_MESSAGE(rates < 100, "Newton's matrices are good");
        double at_rest[N];
        memcpy(at_rest, column_solver_state(solver), sizeof at_rest);
        inputs.reflux_flow /= 1.05;
        take_inputs();
        run(7200);
        inputs.reflux_flow *= 1.05;
        take_inputs();
        run(300000);
        for (size_t i = 0; i < N; i++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, at_rest[i], state(i));
    }
}

static void a_level_that_nothing_holds_is_named_with_how_fast_it_runs_away(void)
{
    config = holdup_config(COLUMN_LEVEL_FREE, COLUMN_LEVEL_FREE);
    make();
    products_of_reference();
    settle();
    double before[N];
    memcpy(before, column_solver_state(solver), sizeof before);
    inputs.distillate_flow += 0.01;
    take_inputs();
    TEST_ASSERT_FALSE(column_solver_settle(solver, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING(
        "column: no steady state: the level of the condenser runs away, it falls by 0.01 mol/s "
        "and nothing holds it",
        err);
    TEST_ASSERT_EQUAL_MEMORY(before, column_solver_state(solver), sizeof before);
    inputs.distillate_flow -= 0.01;
    inputs.bottoms_flow -= 0.02;
    take_inputs();
    TEST_ASSERT_FALSE(column_solver_settle(solver, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING(
        "column: no steady state: the level of the reboiler runs away, it rises by 0.02 mol/s "
        "and nothing holds it",
        err);
}

static void a_level_that_nothing_holds_runs_as_the_flows_say(void)
{
    config = holdup_config(COLUMN_LEVEL_FREE, COLUMN_LEVEL_FREE);
    make();
    products_of_reference();
    inputs.distillate_flow += 0.01;
    inputs.bottoms_flow -= 0.02;
    take_inputs();
    run(3600);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1 - 0.01 * 3600 / 200, state(DRUM));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1 + 0.02 * 3600 / 300, state(REBOILER));
}

/* ---- balances ---- */

static void contents(double *moles)
{
    const struct column *c = column_solver_column(solver);
    memset(moles, 0, 4 * sizeof *moles);
    for (size_t s = 0; s < HOLDUP_STAGES; s++)
        for (size_t j = 0; j < 3; j++) {
            double part = c->holdup[s] * column_fraction(c, column_solver_state(solver), s, j);
            moles[j] += part;
            moles[3] += part;
        }
}

static void net(double *gain)
{
    const struct column *c = column_solver_column(solver);
    gain[3] = 0.0;
    for (size_t j = 0; j < 3; j++) {
        gain[j] = c->flows.feed * inputs.feed_fraction[j] -
                  c->flows.distillate *
                      column_fraction(c, column_solver_state(solver), HOLDUP_STAGES - 1, j) -
                  c->flows.bottoms * column_fraction(c, column_solver_state(solver), 0, j);
        gain[3] += gain[j];
    }
}

/* Trapezoids between changes of the inputs every 400 s, over a day. */
static void over_a_day_of_moving_inputs_all_balances_close(void)
{
    double before[4], after[4], gathered[4] = {0}, rate[2][4], fed = 0.0, moved = 0.0;
    struct random_source r = {3};
    const struct column_solver_options tight = {.relative = 1e-8, .absolute = 1e-10};
    options = &tight;
    make();
    contents(before);
    for (int k = 0; k < 216; k++) {
        const struct column_inputs nominal = holdup_inputs();
        inputs.reflux_flow = nominal.reflux_flow * (0.8 + 0.4 * uniform(&r));
        inputs.boilup = nominal.boilup * (0.8 + 0.4 * uniform(&r));
        inputs.feed_flow = nominal.feed_flow * (0.6 + 0.8 * uniform(&r));
        inputs.feed_fraction[0] = 0.2 + 0.2 * uniform(&r);
        inputs.feed_fraction[2] = 0.6 - inputs.feed_fraction[0];
        inputs.feed_quality = 0.5 + uniform(&r);
        take_inputs();
        net(rate[0]);
        for (int i = 1; i <= 290; i++) {
            double step = i <= 120 ? 0.5 : 2.0;
            run(step);
            net(rate[i % 2]);
            for (int j = 0; j < 4; j++)
                gathered[j] += 0.5 * step * (rate[0][j] + rate[1][j]);
            fed += step * inputs.feed_flow;
        }
        for (size_t i = FRACTIONS; i < N; i++)
            moved = fmax(moved, fabs(state(i) - 1));
    }
    contents(after);
    TEST_ASSERT_TRUE(moved > 0.2);
    for (int j = 0; j < 4; j++)
        TEST_ASSERT_DOUBLE_WITHIN(3e-6 * fed, after[j] - before[j], gathered[j]);
}

/* ---- vessels ---- */

static void a_drum_that_runs_empty_gives_what_it_gets(void)
{
    config = holdup_config(COLUMN_LEVEL_FREE, COLUMN_LEVEL_BY_PRODUCT);
    make();
    products_of_reference();
    inputs.distillate_flow *= 2;
    take_inputs();
    run(20000);
    TEST_ASSERT_TRUE(state(DRUM) > 0 && state(DRUM) < config.limit_softness);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, flows()->vapour_top, flows()->reflux + flows()->distillate);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, inputs.reflux_flow / inputs.distillate_flow,
                              flows()->reflux / flows()->distillate);
    inputs.boilup = 0;
    inputs.feed_quality = 1;
    take_inputs();
    run(20000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, state(DRUM));
    TEST_ASSERT_DOUBLE_WITHIN(1e-2, 0, flows()->distillate);
}

static void a_reboiler_that_runs_empty_stops_boiling(void)
{
    config = holdup_config(COLUMN_LEVEL_BY_PRODUCT, COLUMN_LEVEL_FREE);
    make();
    products_of_reference();
    inputs.boilup = 6;
    take_inputs();
    run(20000);
    TEST_ASSERT_TRUE(state(REBOILER) > 0 && state(REBOILER) < config.limit_softness);
    TEST_ASSERT_TRUE(flows()->vapour_stripping < 5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, column_solver_column(solver)->liquid[1],
                              flows()->vapour_stripping + flows()->bottoms);
}

static void a_vessel_above_its_capacity_runs_over_into_the_product(void)
{
    config = holdup_config(COLUMN_LEVEL_FREE, COLUMN_LEVEL_FREE);
    make();
    products_of_reference();
    inputs.distillate_flow = inputs.bottoms_flow = 0;
    take_inputs();
    run(100000);
    TEST_ASSERT_TRUE(state(DRUM) > 2 && state(REBOILER) > 2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1 * 200 * (state(DRUM) - 2), flows()->distillate);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1 * 300 * (state(REBOILER) - 2), flows()->bottoms);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, inputs.feed_flow, flows()->distillate + flows()->bottoms);
}

/* ---- inputs that jump ---- */

static double jump(struct random_source *r, double low, double high)
{
    double how = uniform(r), where = uniform(r);
    return how < 0.25 ? low : how < 0.5 ? high : low + where * (high - low);
}

static void jump_all(struct random_source *r)
{
    inputs.feed_flow = jump(r, 0, 3);
    double light = jump(r, 0, 1), middle = (1 - light) * jump(r, 0, 1);
    inputs.feed_fraction[0] = light;
    inputs.feed_fraction[1] = middle;
    inputs.feed_fraction[2] = fmax(1 - light - middle, 0);
    inputs.feed_quality = jump(r, 0, 2);
    inputs.reflux_flow = jump(r, 0, 5);
    inputs.boilup = jump(r, 0, 6);
    inputs.distillate_flow = jump(r, 0, 2);
    inputs.bottoms_flow = jump(r, 0, 2);
    inputs.pressure_top = jump(r, 5e4, 2e5);
}

static void stays_inside(const char *when)
{
    const struct column *c = column_solver_column(solver);
    for (size_t s = 0; s < HOLDUP_STAGES; s++) {
        for (size_t j = 0; j < 3; j++) {
            double f = column_fraction(c, column_solver_state(solver), s, j);
            TEST_ASSERT_TRUE_MESSAGE(f >= -1e-14 && f <= 1 + 1e-14, when);
        }
        TEST_ASSERT_TRUE_MESSAGE(column_relative_holdup(c, column_solver_state(solver), s) >= 0,
                                 when);
        TEST_ASSERT_TRUE_MESSAGE(isfinite(c->temperature[s]) && isfinite(c->liquid[s]), when);
    }
}

static int seeds = 1; /* of each structure */

static void no_jump_of_the_inputs_ends_a_run(void)
{
    static const double tick[] = {30, 1, 300};
    for (int seed = 1; seed <= seeds; seed++)
        for (int structure = 0; structure < 12; structure++) {
            struct random_source r = {(uint64_t)seed * 16 + (uint64_t)structure};
            config = holdup_config((enum column_level_by)(structure / 3 % 3),
                                   (enum column_level_by)(structure % 3));
            if (structure == 9)
                config.levels = COLUMN_LEVELS_PERFECT;
            if (structure > 9)
                make_nonideal(&config, structure > 10 ? &nrtl_tables : &wilson_tables);
            inputs = holdup_inputs();
            make();
            for (int k = 0; k < 60; k++) {
                char when[400];
                jump_all(&r);
                snprintf(when, sizeof when, "seed %d, structure %d, tick %d", seed, structure, k);
                if (!column_solver_set_inputs(solver, &inputs, err, sizeof err) ||
                    !column_solver_advance(
                        solver, column_solver_time(solver) + tick[(seed + structure) % 3], err,
                        sizeof err)) {
                    snprintf(when, sizeof when, "seed %d, structure %d, tick %d: %s", seed,
                             structure, k, err);
                    TEST_FAIL_MESSAGE(when);
                }
                stays_inside(when);
            }
        }
    printf("jumps of columns with levels: %d seeds of 12 structures, from 1\n", seeds);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        seeds = atoi(argv[1]);
    UNITY_BEGIN();
    RUN_TEST(newton_matrices_have_what_holdups_do_in_every_structure);
    RUN_TEST(newton_matrices_follow_activity_coefficients);
    RUN_TEST(every_structure_starts_at_rest_where_perfect_levels_are);
    RUN_TEST(after_a_step_every_structure_settles_where_a_long_run_ends);
    RUN_TEST(columns_with_activity_coefficients_settle_where_a_long_run_ends);
    RUN_TEST(a_level_that_nothing_holds_is_named_with_how_fast_it_runs_away);
    RUN_TEST(a_level_that_nothing_holds_runs_as_the_flows_say);
    RUN_TEST(over_a_day_of_moving_inputs_all_balances_close);
    RUN_TEST(a_drum_that_runs_empty_gives_what_it_gets);
    RUN_TEST(a_reboiler_that_runs_empty_stops_boiling);
    RUN_TEST(a_vessel_above_its_capacity_runs_over_into_the_product);
    RUN_TEST(no_jump_of_the_inputs_ends_a_run);
    return UNITY_END();
}
