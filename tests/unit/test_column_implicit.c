/* The step of a column by elimination of blocks (model/column_implicit.h), against one full matrix (dense_step.h). Built twice.
 *
 * Contract: within 5e-6 (double, which is what its bubble points leave of slopes), 2e-3 (float) of the largest change of a step. */
#include "dense_step.h"

#ifdef REFLUX_REAL_DOUBLE
#define STEP_BOUND 5e-6
#define ROUNDING   1e-11
#else
#define STEP_BOUND 2e-3
#define ROUNDING   1e-4
#endif

static struct column_blocks blocks;

void setUp(void)
{
    make_column(3, 0.8, COLUMN_HOLDUP_MOLAR);
}

void tearDown(void) {}

static void step(double h, const struct column_pull *pull, size_t pulls)
{
    TEST_ASSERT_EQUAL(ERR_OK, column_implicit_step(&column, truncated, x, rates, (real_t)h, pull,
                                                   pulls, &blocks));
}

static void agrees_with_the_full_matrix(double h, const struct column_pull *pull, size_t pulls)
{
    double d[N_MOST];
    step(h, pull, pulls);
    dense_step(h, pull, pulls, d);
    double bound = STEP_BOUND * largest_of(d, states());
    for (size_t i = 0; i < states(); i++)
        TEST_ASSERT_DOUBLE_WITHIN(bound, d[i], (double)blocks.change[i]);
}

/* Two to four components, with and without memory of vapours, all holdups, three lengths of a step. */
static void every_column_agrees(const struct column_pull *pull, size_t pulls)
{
    static const double lengths[] = {1, 60, 3600};
    for (size_t c = 2; c <= MOST; c++)
        for (int form = COLUMN_HOLDUP_MOLAR; form <= COLUMN_HOLDUP_CONSERVATIVE; form++)
            for (int memory = 0; memory < 2; memory++) {
                make_column(c, memory ? 0.8 : 1, (enum column_holdup)form);
                rates_of_line();
                for (int k = 0; k < 3; k++)
                    agrees_with_the_full_matrix(lengths[k], pull, pulls);
            }
}

static struct column_pull drawn(size_t stage, size_t component)
{
    return (struct column_pull){.stage = stage,
                                .component = component,
                                .deviation = REAL_C(2.0),
                                .gain = REAL_C(0.02),
                                .rate = REAL_C(-0.005)};
}

/* ---- against the full matrix ---- */

static void without_a_pull_it_is_the_step_of_the_full_matrix(void)
{
    every_column_agrees(NULL, 0);
}

static void a_pull_at_the_reboiler_is_in_its_row(void)
{
    struct column_pull pull = drawn(0, 0);
    every_column_agrees(&pull, 1);
}

static void a_pull_at_the_feed_stage_is_in_its_row(void)
{
    struct column_pull pull = drawn(FEED, 0);
    every_column_agrees(&pull, 1);
}

static void a_pull_at_the_condenser_is_in_its_row(void)
{
    struct column_pull pull = drawn(TOP, 0);
    every_column_agrees(&pull, 1);
}

static void pulls_at_neighbours_are_each_in_their_own_row(void)
{
    struct column_pull pull[3] = {drawn(5, 0), drawn(6, 0), drawn(7, 0)};
    pull[1].deviation = REAL_C(-1.0);
    pull[2].gain = REAL_C(0.1);
    every_column_agrees(pull, 3);
}

static void a_pull_may_come_in_any_order_and_at_every_stage(void)
{
    struct column_pull pull[STAGES];
    for (size_t s = 0; s < STAGES; s++) {
        pull[s] = drawn((3 * s) % STAGES, 0);
        pull[s].deviation = (real_t)s - REAL_C(4.0);
    }
    every_column_agrees(pull, STAGES);
}

static void a_pull_moves_the_fraction_that_is_named(void)
{
    for (size_t c = 3; c <= MOST; c++)
        for (size_t j = 1; j + 1 < c; j++) {
            struct column_pull pull[2] = {drawn(2, j), drawn(7, j)};
            make_column(c, 0.8, COLUMN_HOLDUP_CONSERVATIVE);
            rates_of_line();
            agrees_with_the_full_matrix(60, pull, 2);
        }
}

/* A gain that leaves next to nothing of the element on the diagonal. */
static void the_largest_pivot_of_a_stage_is_taken(void)
{
    struct column_pull pull = {.stage = 0, .component = 0};
    double at[N_MOST], up[N_MOST], down[N_MOST];
    rates_of_line();
    for (size_t i = 0; i < states(); i++)
        at[i] = (double)x[i];
    at[0] += DIFFERENCE;
    own_rates(at, up);
    at[0] -= 2 * DIFFERENCE;
    own_rates(at, down);
    double gain = (up[0] - down[0]) / (2 * DIFFERENCE) - 1.0 / 60;
    for (int n = -100; n <= 100; n++) { /* each of the floats around it, in float */
        pull.gain = (real_t)(gain * (1 + n * 6e-8));
        agrees_with_the_full_matrix(60, &pull, 1);
    }
}

static void a_flow_that_is_not_there_carries_nothing(void)
{
    struct column_inputs inputs = column.inputs;
    inputs.reflux_flow = REAL_C(0.0);
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
    rates_of_line();
    TEST_ASSERT_TRUE(column.liquid[TOP] == REAL_C(0.0));
    agrees_with_the_full_matrix(60, NULL, 0);
}

static void a_feed_that_flashes_has_the_efficiency_that_is_left(void)
{
    struct column_inputs inputs = column.inputs;
    inputs.feed_basis = COLUMN_FLOW_MOLAR;
    inputs.feed_flow = REAL_C(0.015);
    inputs.feed_state = COLUMN_FEED_QUALITY;
    inputs.feed_quality = 0;
    inputs.boilup_given = true;
    inputs.boilup = inputs.heat = REAL_C(1e-3);
    inputs.reflux_flow = REAL_C(3e-7);
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
    rates_of_line();
    TEST_ASSERT_TRUE(column.feed_efficiency > config.efficiency + REAL_C(0.01));
    agrees_with_the_full_matrix(60, NULL, 0);
}

/* Truncated regions: one stage, right above the reboiler, right below the condenser, on both sides of the feed. */
static void truncated_stages_have_a_row_of_their_own_that_is_algebraic(void)
{
    static const struct {
        size_t first, last;
    } regions[][2] = {{{1, 1}, {6, 6}}, {{1, 2}, {5, 8}}, {{4, 8}, {2, 2}}, {{1, 2}, {4, 8}}};
    struct column_pull pull[2] = {drawn(0, 0), drawn(TOP, 0)};
    for (size_t c = 2; c <= MOST; c++)
        for (unsigned k = 0; k < 4; k++) {
            make_column(c, k % 2 ? 0.8 : 1, k < 2 ? COLUMN_HOLDUP_MOLAR : COLUMN_HOLDUP_VOLUMETRIC);
            for (unsigned r = 0; r < 2; r++)
                for (size_t s = regions[k][r].first; s <= regions[k][r].last; s++)
                    truncated[s] = true;
            rates_of_line();
            agrees_with_the_full_matrix(60, NULL, 0);
            agrees_with_the_full_matrix(60, pull, 2);
        }
}

static void on_a_truncated_stage_fractions_move_along_the_bubble_point_that_is_given(void)
{
    truncated[5] = truncated[6] = true;
    rates_of_line();
    step(60, NULL, 0);
    for (size_t s = 5; s <= 6; s++) {
        const real_t *k = &column.k[3 * s];
        double first = (double)((k[0] - k[2]) * blocks.change[2 * s]);
        double second = (double)((k[1] - k[2]) * blocks.change[2 * s + 1]);
        TEST_ASSERT_TRUE(fabs(first) > 1e-3);
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING * fabs(first), 0, first + second);
    }
}

/* ---- what must hold of a step ---- */

/* The whole column gathers the feed less the products at the end of the step. */
static void the_total_of_every_component_closes(void)
{
    for (size_t c = 2; c <= MOST; c++) {
        make_column(c, 0.8, COLUMN_HOLDUP_MOLAR);
        rates_of_line();
        step(600, NULL, 0);
        const struct column_flows *f = &column.flows;
        for (size_t j = 0, m = c - 1; j < m; j++) {
            double gathered = 0;
            for (size_t s = 0; s < STAGES; s++)
                gathered += (double)(column.holdup[s] * blocks.change[s * m + j]) / 600;
            double in = (double)(f->feed * column.inputs.feed_fraction[j]);
            double out = (double)(f->bottoms * (x[j] + blocks.change[j]) +
                                  f->distillate * (x[TOP * m + j] + blocks.change[TOP * m + j]));
            TEST_ASSERT_DOUBLE_WITHIN(ROUNDING * 10 * (double)f->feed, in - out, gathered);
        }
    }
}

static void a_very_short_step_is_that_of_the_rates(void)
{
    rates_of_line();
    step(1e-4, NULL, 0);
    double most = 0;
    for (size_t i = 0; i < states(); i++)
        most = fmax(most, fabs((double)rates[i]));
    for (size_t i = 0; i < states(); i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * most, (double)rates[i], (double)blocks.change[i] / 1e-4);
}

static void a_strong_pull_takes_the_temperature_where_it_was_measured(void)
{
    struct column_pull pull = {.stage = 6, .component = 1, .deviation = REAL_C(0.5), .gain = 100};
    rates_of_line();
    step(1, &pull, 1);
    TEST_ASSERT_EQUAL(2, config.components - 1);
    double at[N_MOST], before;
    for (size_t i = 0; i < states(); i++)
        at[i] = (double)x[i];
    before = own_bubble_point(at, 6);
    for (size_t j = 0; j < 2; j++)
        at[12 + j] += (double)blocks.change[12 + j];
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.5, own_bubble_point(at, 6) - before);
}

static bool within_limits(void)
{
    size_t m = fractions();
    for (size_t s = 0; s < STAGES; s++) {
        real_t sum = REAL_C(0.0);
        for (size_t j = 0; j < m; j++) {
            if (!(x[s * m + j] >= REAL_C(0.0)))
                return false;
            sum += x[s * m + j];
        }
        if (!(sum <= REAL_C(1.00001)))
            return false;
    }
    return true;
}

static void steps_of_a_millisecond_to_a_million_seconds_stay_within_limits(void)
{
    for (size_t c = 2; c <= MOST; c++)
        for (double h = 1e-3; h < 2e6; h *= 10) {
            struct column_pull pull[2] = {drawn(1, 0), drawn(8, 0)};
            make_column(c, 0.8, COLUMN_HOLDUP_CONSERVATIVE);
            truncated[4] = truncated[5] = true;
            for (int n = 0; n < 100; n++) {
                pull[0].deviation = (real_t)(10 - n % 20);
                pull[1].deviation = (real_t)(n % 20 - 10);
                rates_of_line();
                step(h, pull, 2);
                (void)column_move(&column, x, blocks.change);
                TEST_ASSERT_TRUE(within_limits());
            }
        }
}

/* Steady state of the whole column, flows and all: there the rates of column_rates are 0. */
static void settle(void)
{
    for (int n = 0; n < 300; n++) {
        rates_of_line();
        step(3600, NULL, 0);
        (void)column_move(&column, x, blocks.change);
    }
    TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
    for (size_t i = 0; i < states(); i++)
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING * 10, 0, (double)rates[i]);
}

static void a_step_without_end_lands_at_the_steady_state(void)
{
    real_t steady[N_MOST];
    settle();
    memcpy(steady, x, sizeof steady);
    for (size_t i = 0; i < states(); i++)
        x[i] += (real_t)(i % 2 ? 0.002 : -0.002) * x[i];
    for (int n = 0; n < 2; n++) {
        rates_of_line();
        step(1e9, NULL, 0);
        TEST_ASSERT_EQUAL(0, column_move(&column, x, blocks.change));
    }
    for (size_t i = 0; i < states(); i++)
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, (double)steady[i], (double)x[i]);
}

/* ---- errors ---- */

static void a_change_that_is_no_number_is_an_error(void)
{
    rates_of_line();
    for (size_t i = 0; i < states(); i++) {
        real_t kept = rates[i];
        rates[i] = (real_t)(i % 2 ? NAN : INFINITY);
        TEST_ASSERT_EQUAL(ERR_NOT_FINITE,
                          column_implicit_step(&column, truncated, x, rates, 60, NULL, 0, &blocks));
        rates[i] = kept;
    }
}

static void equations_without_a_solution_are_an_error(void)
{
    struct column_pull pull = drawn(4, 0);
    make_column(2, 1, COLUMN_HOLDUP_MOLAR);
    components[1] = components[0]; /* whose bubble point no fraction moves */
    rates_of_line();
    TEST_ASSERT_EQUAL(ERR_RANGE,
                      column_implicit_step(&column, truncated, x, rates, 60, &pull, 1, &blocks));
    make_column(3, 1, COLUMN_HOLDUP_MOLAR);
    components[2] = components[1];
    truncated[6] = true;
    rates_of_line();
    TEST_ASSERT_EQUAL(ERR_RANGE,
                      column_implicit_step(&column, truncated, x, rates, 60, NULL, 0, &blocks));
}

/* ---- moving ---- */

static void moves_to(size_t s, real_t first, real_t second, real_t want_first, real_t want_second,
                     size_t clipped)
{
    real_t at[N_MOST], change[N_MOST] = {REAL_C(0.0)};
    for (size_t i = 0; i < states(); i++)
        at[i] = i / 2 == s ? REAL_C(0.25) : REAL_C(0.125);
    change[2 * s] = first - REAL_C(0.25);
    change[2 * s + 1] = second - REAL_C(0.25);
    TEST_ASSERT_EQUAL(clipped, column_move(&column, at, change));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)want_first, (double)at[2 * s]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)want_second, (double)at[2 * s + 1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)want_first - 0.25, (double)change[2 * s]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)want_second - 0.25, (double)change[2 * s + 1]);
    for (size_t i = 0; i < states(); i++)
        if (i / 2 != s)
            TEST_ASSERT_TRUE(at[i] == REAL_C(0.125));
}

static void fractions_stay_within_what_the_others_leave(void)
{
    for (size_t s = 0; s < STAGES; s += TOP) {
        moves_to(s, REAL_C(0.5), REAL_C(0.375), REAL_C(0.5), REAL_C(0.375), 0);
        moves_to(s, REAL_C(-0.1), REAL_C(0.5), 0, REAL_C(0.5), 1);
        moves_to(s, REAL_C(0.5), REAL_C(0.75), REAL_C(0.5), REAL_C(0.5), 1);
        moves_to(s, REAL_C(1.5), REAL_C(0.25), 1, 0, 2);
        moves_to(s, REAL_C(1.5), REAL_C(-0.25), 1, 0, 2);
        moves_to(s, REAL_C(-0.1), REAL_C(1.0625), 0, 1, 2);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_a_pull_it_is_the_step_of_the_full_matrix);
    RUN_TEST(a_pull_at_the_reboiler_is_in_its_row);
    RUN_TEST(a_pull_at_the_feed_stage_is_in_its_row);
    RUN_TEST(a_pull_at_the_condenser_is_in_its_row);
    RUN_TEST(pulls_at_neighbours_are_each_in_their_own_row);
    RUN_TEST(a_pull_may_come_in_any_order_and_at_every_stage);
    RUN_TEST(a_pull_moves_the_fraction_that_is_named);
    RUN_TEST(the_largest_pivot_of_a_stage_is_taken);
    RUN_TEST(a_flow_that_is_not_there_carries_nothing);
    RUN_TEST(a_feed_that_flashes_has_the_efficiency_that_is_left);
    RUN_TEST(truncated_stages_have_a_row_of_their_own_that_is_algebraic);
    RUN_TEST(on_a_truncated_stage_fractions_move_along_the_bubble_point_that_is_given);
    RUN_TEST(the_total_of_every_component_closes);
    RUN_TEST(a_very_short_step_is_that_of_the_rates);
    RUN_TEST(a_strong_pull_takes_the_temperature_where_it_was_measured);
    RUN_TEST(steps_of_a_millisecond_to_a_million_seconds_stay_within_limits);
    RUN_TEST(a_step_without_end_lands_at_the_steady_state);
    RUN_TEST(a_change_that_is_no_number_is_an_error);
    RUN_TEST(equations_without_a_solution_are_an_error);
    RUN_TEST(fractions_stay_within_what_the_others_leave);
    return UNITY_END();
}
