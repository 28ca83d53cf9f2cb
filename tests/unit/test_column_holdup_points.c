/* Columns of constant relative volatility with feed by quality, molar boil-up, levels and hydraulics, and with activity
 * coefficients, against tests/reference/column_holdups.csv (independent, double). Built twice, with real_t = float and =
 * double.
 *                 temperature    rates, relative to the largest    flows
 *   double        1e-6 K         1e-8                              1e-9
 *   float         2e-3 K         2e-4                              1e-5 */
#include "csv.h"
#include "holdup_columns.h"
#include "unity.h"

#include <string.h>

#ifdef REFLUX_REAL_DOUBLE
#define T_BOUND    1e-6
#define RATE_BOUND 1e-8
#define FLOW_BOUND 1e-9
#else
#define T_BOUND    2e-3
#define RATE_BOUND 2e-4
#define FLOW_BOUND 1e-5
#endif

#define FRACTIONS (2 * HOLDUP_STAGES)

/* A row of the table, as its second line says. */
struct row {
    double condenser_by, reboiler_by, levels, trays, model, q, boilup, subcooling, reflux,
        distillate, bottoms, feed, z[2];
    double reference[7]; /* R, D, B, L_E, L_S, V_S, V_E */
    double x[FRACTIONS], r[HOLDUP_STAGES], dx[FRACTIONS], dr[HOLDUP_STAGES], t[HOLDUP_STAGES];
    double flows[4]; /* D, B, R, V_S */
};

static struct column_config config;
static struct column column;
static struct column_fault fault;
static real_t x[FRACTIONS + HOLDUP_STAGES], rates[FRACTIONS + HOLDUP_STAGES];

void setUp(void) {}
void tearDown(void) {}

static void make(const struct row *row)
{
    struct column_inputs inputs = holdup_inputs();
    config = holdup_config((enum column_level_by)(int)row->condenser_by,
                           (enum column_level_by)(int)row->reboiler_by);
    if (row->model > 0)
        make_nonideal(&config, row->model > 1 ? &nrtl_tables : &wilson_tables);
    if (row->levels == 0)
        config.levels = COLUMN_LEVELS_PERFECT;
    if (row->trays == 0)
        config.hydraulic_time = 0;
    inputs.feed_flow = (real_t)row->feed;
    inputs.feed_quality = (real_t)row->q;
    inputs.feed_fraction[0] = (real_t)row->z[0];
    inputs.feed_fraction[1] = (real_t)row->z[1];
    inputs.feed_fraction[2] = (real_t)(1 - row->z[0] - row->z[1]);
    inputs.boilup = (real_t)row->boilup;
    inputs.reflux_flow = (real_t)row->reflux;
    inputs.reflux_subcooling = (real_t)row->subcooling;
    inputs.distillate_flow = (real_t)row->distillate;
    inputs.bottoms_flow = (real_t)row->bottoms;
    const struct column_flows reference = {
        .reflux = (real_t)row->reference[0],
        .distillate = (real_t)row->reference[1],
        .bottoms = (real_t)row->reference[2],
        .liquid_enriching = (real_t)row->reference[3],
        .liquid_stripping = (real_t)row->reference[4],
        .vapour_stripping = (real_t)row->reference[5],
        .vapour_enriching = (real_t)row->reference[6],
    };
    TEST_ASSERT_EQUAL(ERR_OK, column_init(&column, &config, &fault));
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
    column_take_reference(&column, &reference);
    for (size_t i = 0; i < FRACTIONS; i++)
        x[i] = (real_t)row->x[i];
    for (size_t s = 0; s < HOLDUP_STAGES; s++)
        if (column_holdup_state(&column, s) < column.n_states)
            x[column_holdup_state(&column, s)] = (real_t)row->r[s];
}

static double largest(const double *v, size_t n)
{
    double most = 0;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(v[i]));
    return most;
}

static void compare(const struct row *row)
{
    double dx = RATE_BOUND * largest(row->dx, FRACTIONS);
    double dr = RATE_BOUND * fmax(largest(row->dr, HOLDUP_STAGES), 0.01);

    for (size_t i = 0; i < FRACTIONS; i++)
        TEST_ASSERT_DOUBLE_WITHIN(dx, row->dx[i], (double)rates[i]);
    for (size_t s = 0; s < HOLDUP_STAGES; s++) {
        size_t at = column_holdup_state(&column, s);
        TEST_ASSERT_DOUBLE_WITHIN(T_BOUND, row->t[s], (double)column.temperature[s]);
        TEST_ASSERT_TRUE(column_relative_holdup(&column, x, s) == (real_t)row->r[s]);
        if (at < column.n_states)
            TEST_ASSERT_DOUBLE_WITHIN(dr, row->dr[s], (double)rates[at]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(FLOW_BOUND, row->flows[0], (double)column.flows.distillate);
    TEST_ASSERT_DOUBLE_WITHIN(FLOW_BOUND, row->flows[1], (double)column.flows.bottoms);
    TEST_ASSERT_DOUBLE_WITHIN(FLOW_BOUND, row->flows[2], (double)column.flows.reflux);
    TEST_ASSERT_DOUBLE_WITHIN(FLOW_BOUND, row->flows[3], (double)column.flows.vapour_stripping);
}

/* d/dt of the moles of component j less what flows in and out. */
static double open_balance(size_t j)
{
    double sum = 0;
    for (size_t s = 0; s < HOLDUP_STAGES; s++) {
        size_t at = column_holdup_state(&column, s);
        double nominal = s == 0                   ? (double)config.holdup_reboiler
                         : s == HOLDUP_STAGES - 1 ? (double)config.holdup_condenser
                                                  : (double)config.holdup_tray;
        double growth = at < column.n_states ? nominal * (double)rates[at] : 0;
        sum += growth * (double)column_fraction(&column, x, s, j) +
               (double)column.holdup[s] * (double)rates[2 * s + j];
    }
    return sum - (double)(column.flows.feed * column.inputs.feed_fraction[j]) +
           (double)(column.flows.distillate * column_fraction(&column, x, HOLDUP_STAGES - 1, j)) +
           (double)(column.flows.bottoms * column_fraction(&column, x, 0, j));
}

static void rates_temperatures_and_flows_match_the_independent_reference(void)
{
    FILE *f = csv_open("reference/column_holdups.csv");
    struct row row;
    int rows = 0;
    while (csv_row(f, (double *)&row, sizeof row / sizeof(double))) {
        make(&row);
        TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
        compare(&row);
        for (size_t j = 0; j < 2; j++)
            TEST_ASSERT_DOUBLE_WITHIN(10 * FLOW_BOUND, 0, open_balance(j));
        TEST_ASSERT_EQUAL(ERR_OK, column_rates_again(&column, x, rates));
        compare(&row);
        rows++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL(40, rows);
}

/* New inputs at an old state, from a flash that leaves no vapour from below to one that does, and back. */
static void vapour_above_a_flash_follows_new_inputs(void)
{
    struct row row = {.levels = 0, .boilup = 2, .reflux = 1, .feed = 1, .z = {0.3, 0.4}};
    for (size_t s = 0; s < HOLDUP_STAGES; s++) {
        row.x[2 * s] = 0.1 + 0.05 * (double)s;
        row.x[2 * s + 1] = 0.3;
        row.r[s] = 1;
    }
    make(&row);
    TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
    for (int k = 0; k < 4; k++) {
        struct column_inputs inputs = column.inputs;
        real_t again[FRACTIONS + HOLDUP_STAGES];
        inputs.boilup = k % 2 ? 2 : REAL_C(0.1);
        TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
        TEST_ASSERT_EQUAL(ERR_OK, column_rates_again(&column, x, again));
        TEST_ASSERT_EQUAL(k % 2, column.feed_efficiency == config.efficiency);
        struct column fresh = column;
        TEST_ASSERT_EQUAL(ERR_OK, column_rates(&fresh, x, rates));
        for (size_t i = 0; i < column.n_states; i++)
            TEST_ASSERT_DOUBLE_WITHIN(RATE_BOUND, (double)rates[i], (double)again[i]);
    }
}

/* Flows do not depend on compositions here, so the band is the whole of it: against differences, in double. */
static void the_band_jacobian_is_that_of_the_mole_fractions_alone(void)
{
    enum { STRIDE = 16 };
    static real_t band[FRACTIONS * STRIDE + STRIDE];
    struct row row = {.levels = 1,
                      .trays = 1,
                      .condenser_by = 1,
                      .reboiler_by = 2,
                      .q = 0.9,
                      .boilup = 2,
                      .reflux = 1.6,
                      .feed = 1,
                      .z = {0.3, 0.4},
                      .reference = {1.6, 0.5, 0.5, 1.6, 2.5, 2, 2.1}};
    size_t lower, upper;
    for (size_t s = 0; s < HOLDUP_STAGES; s++) {
        row.x[2 * s] = 0.1 + 0.05 * (double)s;
        row.x[2 * s + 1] = 0.3;
        row.r[s] = 1.05 - 0.01 * (double)s;
    }
    make(&row);
    config.efficiency = 1; /* nothing is left out of the band then */
    TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
    column_jacobian_shape(&config, &lower, &upper);
    TEST_ASSERT_TRUE(lower + upper < STRIDE);
    for (size_t i = 0; i < sizeof band / sizeof band[0]; i++)
        band[i] = 77;
    column_jacobian(&column, x, band, STRIDE, upper);
    for (size_t i = FRACTIONS * STRIDE; i < sizeof band / sizeof band[0]; i++)
        TEST_ASSERT_TRUE(band[i] == 77);
    const real_t h = sizeof(real_t) > 4 ? REAL_C(1e-6) : REAL_C(1e-3);
    for (size_t col = 0; col < FRACTIONS; col++) {
        real_t above[FRACTIONS + HOLDUP_STAGES], below[FRACTIONS + HOLDUP_STAGES], here = x[col];
        x[col] = here + h;
        TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, above));
        x[col] = here - h;
        TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, below));
        x[col] = here;
        for (size_t at = 0; at < FRACTIONS; at++) {
            double slope = (double)(above[at] - below[at]) / (2 * (double)h);
            bool inside = at <= col + lower && col <= at + upper;
            double entry = inside ? (double)band[col * STRIDE + upper + at - col] : 0;
            TEST_ASSERT_DOUBLE_WITHIN(sizeof(real_t) > 4 ? 1e-6 : 2e-3, slope, entry);
        }
    }
}

static void states_that_are_no_numbers_are_refused(void)
{
    struct row row = {.levels = 1, .trays = 1, .condenser_by = 1, .reboiler_by = 1, .feed = 1};
    for (size_t i = 0; i < FRACTIONS; i++)
        row.x[i] = 0.3;
    for (size_t s = 0; s < HOLDUP_STAGES; s++)
        row.r[s] = 1;
    make(&row);
    TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
    x[FRACTIONS + 3] = (real_t)NAN;
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, column_rates(&column, x, rates));
}

/* ---- activity ---- */

static real_t a[9], b[9], alpha[9];
static struct activity tables;

static void sound_tables(void)
{
    memcpy(a, interaction_a, sizeof a);
    memcpy(b, interaction_b, sizeof b);
    memcpy(alpha, interaction_alpha, sizeof alpha);
    tables = (struct activity){ACTIVITY_NRTL, 3, a, b, alpha};
}

static void refused(enum err code, const char *field, const char *wanted, size_t row, size_t entry)
{
    size_t at[2];
    TEST_ASSERT_EQUAL(code, activity_validate(&tables, 280, 440, &fault, &at[0], &at[1]));
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_EQUAL_STRING(wanted, fault.wanted);
    TEST_ASSERT_EQUAL_size_t(row, at[0]);
    TEST_ASSERT_EQUAL_size_t(entry, at[1]);
    sound_tables();
}

static void wrong_entries_of_activity_tables_are_named(void)
{
    sound_tables();
    refused(ERR_OK, "", "", 0, 0);
    tables.model = (enum activity_model)2;
    refused(ERR_RANGE, "activity.model", "one of enum activity_model", 0, 0);
    tables.components = 1;
    refused(ERR_RANGE, "activity.components", "those of the column", 0, 0);
    tables.a = NULL;
    refused(ERR_RANGE, "activity.a", "a row and a column for every component", 0, 0);
    tables.alpha = NULL;
    refused(ERR_RANGE, "activity.alpha", "a row and a column for every component", 0, 0);
    a[4] = REAL_C(0.1);
    refused(ERR_RANGE, "activity.a", "0 on the diagonal", 1, 1);
    b[8] = REAL_C(0.1);
    refused(ERR_RANGE, "activity.b", "0 on the diagonal", 2, 2);
    b[1] = (real_t)NAN;
    refused(ERR_NOT_FINITE, "activity.b", "a finite number of K", 0, 1);
    a[5] = (real_t)NAN;
    refused(ERR_NOT_FINITE, "activity.a", "such that a + b / T is -20 to 20 at every temperature",
            1, 2);
    b[3] = 5900; /* 21.07 - 0.7 at 280 K */
    refused(ERR_RANGE, "activity.a", "such that a + b / T is -20 to 20 at every temperature", 1, 0);
    alpha[2] = REAL_C(1.1);
    refused(ERR_RANGE, "activity.alpha", "0 to 1", 0, 2);
    alpha[7] = REAL_C(0.5);
    refused(ERR_RANGE, "activity.alpha", "symmetric", 1, 2);
    alpha[4] = REAL_C(-0.1);
    refused(ERR_RANGE, "activity.alpha", "0 to 1", 1, 1);
    tables.model = ACTIVITY_WILSON;
    tables.alpha = NULL;
    a[6] = REAL_C(-9.5); /* -9.82 at 280 K */
    refused(ERR_OK, "", "", 0, 0);
    tables.model = ACTIVITY_WILSON;
    a[6] = REAL_C(-9.7); /* -10.02 at 280 K */
    refused(ERR_RANGE, "activity.a", "such that a + b / T is -10 to 10 at every temperature", 2, 0);
}

static void activity_coefficients_stay_numbers_at_every_composition(void)
{
    static const double extreme[] = {-10, 10};
    for (int model = ACTIVITY_WILSON; model <= ACTIVITY_NRTL; model++)
        for (int k = 0; k < 64; k++) {
            sound_tables();
            tables.model = (enum activity_model)model;
            tables.b = NULL;
            for (int i = 0, bit = 0; i < 9; i++)
                if (i % 4)
                    a[i] = (real_t)((model == ACTIVITY_NRTL ? 2 : 1) * extreme[k >> bit++ & 1]);
            for (int i = 0; i < 9; i++)
                alpha[i] = 1;
            for (int i = 0; i < 4; i++) {
                real_t at[3] = {i == 0, i == 1, i == 2}, gamma[3];
                if (i == 3)
                    at[0] = at[1] = at[2] = REAL_C(1.0) / 3;
                activity_coefficients(&tables, at, 350, gamma);
                for (int j = 0; j < 3; j++) {
                    TEST_ASSERT_TRUE(isfinite(gamma[j]) && gamma[j] > 0);
                    if (i == j)
                        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, (double)gamma[j]);
                }
            }
        }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(rates_temperatures_and_flows_match_the_independent_reference);
    RUN_TEST(vapour_above_a_flash_follows_new_inputs);
    RUN_TEST(the_band_jacobian_is_that_of_the_mole_fractions_alone);
    RUN_TEST(states_that_are_no_numbers_are_refused);
    RUN_TEST(wrong_entries_of_activity_tables_are_named);
    RUN_TEST(activity_coefficients_stay_numbers_at_every_composition);
    return UNITY_END();
}
