/* Transition of a column's deviations over a step (model/column_transition.h), against one full matrix (dense_step.h) and against the
 * step of column_implicit.h. Built twice.
 *
 * Contract: Phi v within 5e-6 (double, which is what the bubble points of that build leave of slopes), 2e-3 (float, likewise) of its
 * largest element, against a matrix whose elements are differences. Against the step of column_implicit.h, which has the same slopes,
 * rounding alone: both eliminate without growth, so ROUNDINGS units in the last place times the condition of I - h J, which is not above
 * 1 + h times the fastest exchange of a stage's holdup, twice over. Slopes by the feed within FEED_BOUND of the largest one: of differences
 * over FEED_STEP the double build loses 1e-10/FEED_STEP, the float build its rounding over COLUMN_FLOW_PART. */
#include "dense_step.h"
#include "model/column_transition.h"

#define ROUNDINGS 32
#ifdef REFLUX_REAL_DOUBLE
#define STEP_BOUND 5e-6
#define FEED_BOUND 1e-6
#define FEED_STEP  1e-4
#else
#define STEP_BOUND 2e-3
#define FEED_BOUND 1e-3
#define FEED_STEP  2e-2
#endif

static struct column_blocks blocks;
static real_t numbers[STAGES * (3 * 9 + 2)];
static struct column_transition transition = {.factors = numbers};
static real_t v[N_MOST];

void setUp(void)
{
    make_column(3, 0.8, COLUMN_HOLDUP_MOLAR);
}

void tearDown(void) {}

static void make(double h)
{
    TEST_ASSERT_EQUAL(ERR_OK, column_transition_make(&column, x, (real_t)h, &transition));
    TEST_ASSERT_EQUAL(STAGES, transition.stages);
    TEST_ASSERT_EQUAL(fractions(), transition.m);
}

/* Mol exchanged in a second over what is there, at the stage where that is most. */
static double fastest(void)
{
    double most = 0;
    for (size_t s = 0; s < STAGES; s++) {
        double flows = fabs((double)column.liquid[s]) + fabs((double)column.vapour_flow[s]) +
                       (s > 0 ? fabs((double)column.vapour_flow[s - 1]) : 0) +
                       (s < TOP ? fabs((double)column.liquid[s + 1]) : 0);
        most = fmax(most, flows / (double)column.holdup[s]);
    }
    return most;
}

static void agrees_with_the_step(double h)
{
    double largest = 0;
    TEST_ASSERT_EQUAL(
        ERR_OK, column_implicit_step(&column, truncated, x, rates, (real_t)h, NULL, 0, &blocks));
    make(h);
    for (size_t i = 0; i < states(); i++) {
        v[i] = (real_t)h * rates[i];
        largest = fmax(largest, fabs((double)blocks.change[i]));
    }
    column_transition_apply(&transition, v);
    double bound = ROUNDINGS * (double)REAL_EPSILON * (1 + 2 * h * fastest()) * largest;
    for (size_t i = 0; i < states(); i++)
        TEST_ASSERT_DOUBLE_WITHIN(bound, (double)blocks.change[i], (double)v[i]);
}

/* dense_step solves for h rates; so rates are made what is to be carried. */
static void agrees_with_the_full_matrix(double h, size_t one)
{
    double d[N_MOST];
    make(h);
    for (size_t i = 0; i < states(); i++) {
        v[i] = one < states() ? (i == one ? REAL_C(1.0) : REAL_C(0.0))
                              : (real_t)sin(3.0 * (double)i + h);
        rates[i] = v[i] / (real_t)h;
    }
    column_transition_apply(&transition, v);
    dense_step(h, NULL, 0, d);
    double bound = STEP_BOUND * largest_of(d, states());
    for (size_t i = 0; i < states(); i++)
        TEST_ASSERT_DOUBLE_WITHIN(bound, d[i], (double)v[i]);
}

static const double lengths[] = {1, 60, 3600};

static void every_column(void check(double h))
{
    for (size_t c = 2; c <= MOST; c++)
        for (int form = COLUMN_HOLDUP_MOLAR; form <= COLUMN_HOLDUP_CONSERVATIVE; form++)
            for (int memory = 0; memory < 2; memory++) {
                make_column(c, memory ? 0.8 : 1, (enum column_holdup)form);
                for (int k = 0; k < 3; k++) {
                    rates_of_line();
                    check(lengths[k]);
                }
            }
}

static void any_deviations(double h)
{
    agrees_with_the_full_matrix(h, states());
}

static void rates_over_a_step_become_the_change_of_the_implicit_step(void)
{
    every_column(agrees_with_the_step);
}

static void any_deviations_become_those_of_the_full_matrix(void)
{
    every_column(any_deviations);
}

static void each_column_of_the_matrix_is_that_of_the_full_inverse(void)
{
    for (size_t c = 2; c <= MOST; c++) {
        make_column(c, 0.8, COLUMN_HOLDUP_MOLAR);
        for (size_t one = 0; one < states(); one++) {
            rates_of_line();
            agrees_with_the_full_matrix(60, one);
        }
    }
}

/* Margules with one constant for every pair, by the distance of a mole fraction from 1. */
static void margules(void *context, const real_t *fraction, real_t temperature, real_t *gamma)
{
    const size_t *c = context;
    (void)temperature;
    for (size_t j = 0; j < *c; j++)
        gamma[j] =
            real_exp(REAL_C(0.4) * (REAL_C(1.0) - fraction[j]) * (REAL_C(1.0) - fraction[j]));
}

static void activity_coefficients_are_held_as_the_step_holds_them(void)
{
    for (size_t c = 2; c <= MOST; c++) {
        make_column(c, 0.8, COLUMN_HOLDUP_MOLAR);
        config.activity = margules;
        config.activity_context = &config.components;
        struct column_inputs inputs = column.inputs;
        TEST_ASSERT_EQUAL(ERR_OK, column_init(&column, &config, &fault));
        TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
        rates_of_line();
        for (int k = 0; k < 3; k++)
            agrees_with_the_step(lengths[k]);
    }
}

static void with_inputs(struct column_inputs inputs)
{
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, column_set_inputs(&column, &inputs, &fault), fault.field);
    rates_of_line();
}

static struct column_inputs flashing(void)
{
    struct column_inputs inputs = column.inputs;
    inputs.feed_basis = COLUMN_FLOW_MOLAR;
    inputs.feed_flow = REAL_C(0.015);
    inputs.feed_state = COLUMN_FEED_QUALITY;
    inputs.feed_quality = 0;
    inputs.boilup_given = true;
    inputs.boilup = inputs.heat = REAL_C(1e-3);
    inputs.reflux_flow = REAL_C(3e-7);
    return inputs;
}

static void a_feed_that_flashes_has_the_efficiency_that_is_left(void)
{
    with_inputs(flashing());
    TEST_ASSERT_TRUE(column.feed_efficiency > config.efficiency + REAL_C(0.01));
    agrees_with_the_full_matrix(60, states());
}

static void a_flow_that_is_not_there_carries_nothing(void)
{
    struct column_inputs inputs = column.inputs;
    inputs.reflux_flow = REAL_C(0.0);
    with_inputs(inputs);
    TEST_ASSERT_TRUE(column.liquid[TOP] == REAL_C(0.0));
    agrees_with_the_full_matrix(60, states());
}

static void a_step_without_length_leaves_things_where_they_are(void)
{
    rates_of_line();
    make(1e-5);
    for (size_t i = 0; i < states(); i++)
        v[i] = i % 3 ? REAL_C(1.0) : REAL_C(-0.5);
    column_transition_apply(&transition, v);
    for (size_t i = 0; i < states(); i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, i % 3 ? 1 : -0.5, (double)v[i]);
}

static void equations_without_a_solution_are_an_error(void)
{
    rates_of_line();
    column.holdup[4] = column.vapour_flow[4] = column.vapour_flow[3] = column.liquid[5] = 0;
    TEST_ASSERT_EQUAL(ERR_RANGE, column_transition_make(&column, x, 60, &transition));
    rates_of_line();
    column.holdup[5] = (real_t)NAN;
    TEST_ASSERT_EQUAL(ERR_RANGE, column_transition_make(&column, x, 60, &transition));
    rates_of_line();
    column.holdup[5] = (real_t)INFINITY;
    TEST_ASSERT_EQUAL(ERR_RANGE, column_transition_make(&column, x, 60, &transition));
}

/* ---- slopes by the feed ---- */

static real_t slope[N_MOST], flow_slope[N_MOST], work[N_MOST];

/* Rates at other inputs, x as it is. */
static void rates_at(struct column_inputs inputs, real_t *out)
{
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
    TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, out));
}

static void is_the_difference(struct column_inputs up, struct column_inputs down, double over)
{
    struct column_inputs kept = column.inputs;
    real_t above[N_MOST], below[N_MOST];
    double most = 0;
    rates_at(up, above);
    rates_at(down, below);
    rates_at(kept, work);
    for (size_t i = 0; i < states(); i++)
        most = fmax(most, fabs((double)slope[i]));
    TEST_ASSERT_TRUE(most > 0);
    for (size_t i = 0; i < states(); i++)
        TEST_ASSERT_DOUBLE_WITHIN(FEED_BOUND * most, ((double)above[i] - (double)below[i]) / over,
                                  (double)slope[i]);
}

/* All bases of the feed's flow, subcooled and by quality; flows of about the same size, far from limits. */
static void every_feed(void check(void))
{
    for (size_t c = 2; c <= MOST; c++)
        for (int basis = COLUMN_FLOW_MOLAR; basis <= COLUMN_FLOW_VOLUME; basis++)
            for (int quality = 0; quality < (basis == COLUMN_FLOW_VOLUME ? 1 : 2); quality++) {
                make_column(c, 0.8, COLUMN_HOLDUP_MOLAR);
                struct column_inputs inputs = column.inputs;
                inputs.feed_basis = (enum column_basis)basis;
                inputs.feed_flow = basis == COLUMN_FLOW_MOLAR  ? REAL_C(0.015)
                                   : basis == COLUMN_FLOW_MASS ? REAL_C(0.0024)
                                                               : inputs.feed_flow;
                inputs.feed_state = quality ? COLUMN_FEED_QUALITY : COLUMN_FEED_TEMPERATURE;
                inputs.feed_quality = REAL_C(0.9);
                with_inputs(inputs);
                TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
                TEST_ASSERT_TRUE(column.flows.distillate > REAL_C(0.1) * column.flows.feed);
                TEST_ASSERT_TRUE(column.flows.bottoms > REAL_C(0.1) * column.flows.feed);
                check();
            }
}

/* The part that goes by the mole fraction in volumes is a quotient, so that over FEED_STEP its curvature is left: (a step)^2/3 of
 * itself, below the bound. */
static void by_fraction(void)
{
    column_feed_flow_slope(&column, x, flow_slope, work);
    for (size_t j = 0; j < fractions(); j++) {
        struct column_inputs up = column.inputs, down = column.inputs;
        column_feed_slopes(&column, x, j, slope);
        real_t moles = column_feed_moles_slope(&column, j);
        TEST_ASSERT_TRUE((column.inputs.feed_basis == COLUMN_FLOW_MOLAR) == (moles == 0) ||
                         components[j].molar_mass == components[fractions()].molar_mass);
        for (size_t i = 0; i < states(); i++)
            slope[i] += moles * flow_slope[i];
        up.feed_fraction[j] += (real_t)FEED_STEP;
        up.feed_fraction[fractions()] -= (real_t)FEED_STEP;
        down.feed_fraction[j] -= (real_t)FEED_STEP;
        down.feed_fraction[fractions()] += (real_t)FEED_STEP;
        is_the_difference(up, down, 2 * FEED_STEP);
    }
}

static void by_flow(void)
{
    struct column_inputs up = column.inputs, down = column.inputs;
    column_feed_flow_slope(&column, x, slope, work);
    up.feed_flow *= (real_t)(1 + FEED_STEP);
    down.feed_flow *= (real_t)(1 - FEED_STEP);
    is_the_difference(up, down, 2 * FEED_STEP);
}

static void slopes_by_the_feeds_fractions_are_differences_of_rates(void)
{
    every_feed(by_fraction);
}

static void slopes_by_the_feeds_flow_are_differences_of_rates(void)
{
    every_feed(by_flow);
}

/* The boil-up reaches what the cold feed condenses of it: the slope is the one with the limit on. */
static void a_cold_feed_that_takes_all_vapour_has_the_slope_of_that(void)
{
    struct column_inputs inputs = column.inputs;
    inputs.heat = REAL_C(20.0);
    with_inputs(inputs);
    TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
    TEST_ASSERT_TRUE(column.flows.condensed_by_feed == column.flows.boilup_wanted);
    by_flow();
}

static void the_column_is_as_it_was_after_slopes(void)
{
    static struct column before;
    const struct column_inputs cases[] = {column.inputs, flashing()};
    for (int k = 0; k < 2; k++) {
        with_inputs(cases[k]);
        TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
        before = column;
        column_feed_flow_slope(&column, x, slope, work);
        TEST_ASSERT_TRUE(column.feed_molar == before.feed_molar);
        for (size_t s = 0; s < STAGES; s++) {
            TEST_ASSERT_TRUE(column.liquid[s] == before.liquid[s]);
            TEST_ASSERT_TRUE(column.vapour_flow[s] == before.vapour_flow[s]);
        }
        TEST_ASSERT_TRUE(column.feed_efficiency == before.feed_efficiency);
        for (size_t i = 0; i < STAGES * 3; i++)
            TEST_ASSERT_DOUBLE_WITHIN(16 * (double)REAL_EPSILON, (double)before.vapour[i],
                                      (double)column.vapour[i]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(rates_over_a_step_become_the_change_of_the_implicit_step);
    RUN_TEST(any_deviations_become_those_of_the_full_matrix);
    RUN_TEST(each_column_of_the_matrix_is_that_of_the_full_inverse);
    RUN_TEST(activity_coefficients_are_held_as_the_step_holds_them);
    RUN_TEST(a_feed_that_flashes_has_the_efficiency_that_is_left);
    RUN_TEST(a_flow_that_is_not_there_carries_nothing);
    RUN_TEST(a_step_without_length_leaves_things_where_they_are);
    RUN_TEST(equations_without_a_solution_are_an_error);
    RUN_TEST(slopes_by_the_feeds_fractions_are_differences_of_rates);
    RUN_TEST(slopes_by_the_feeds_flow_are_differences_of_rates);
    RUN_TEST(a_cold_feed_that_takes_all_vapour_has_the_slope_of_that);
    RUN_TEST(the_column_is_as_it_was_after_slopes);
    return UNITY_END();
}
