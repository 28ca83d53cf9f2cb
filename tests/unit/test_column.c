/* The column model. Built twice, with real_t = float and = double.
 *
 * Accuracy contract, against tests/reference/column_points.csv (independent, double):
 *                 temperature    rates, relative to the largest    flows
 *   double        1e-6 K         1e-7                              1e-7
 *   float         2e-3 K         2e-4                              1e-4
 * so that the float build agrees with the double build within the sum. */
#include "csv.h"
#include "model/column.h"
#include "test_columns.h"
#include "unity.h"

#include <string.h>

#ifdef REFLUX_REAL_DOUBLE
#define T_BOUND    1e-6
#define RATE_BOUND 1e-7
#define FLOW_BOUND 1e-7
#define ROUNDING   1e-12
#else
#define T_BOUND    2e-3
#define RATE_BOUND 2e-4
#define FLOW_BOUND 1e-4
#define ROUNDING   2e-5
#endif

static struct column_config config;
static struct column column;
static struct column_fault fault;
static real_t x[20], rates[20];

static void make(enum column_holdup holdup)
{
    struct column_inputs inputs = ternary_inputs();
    config = ternary_config(holdup);
    TEST_ASSERT_EQUAL(ERR_OK, column_init(&column, &config, &fault));
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
}

void setUp(void)
{
    make(COLUMN_HOLDUP_MOLAR);
    ternary_profile(x, 0);
}

void tearDown(void) {}

static double largest(const real_t *v, int n)
{
    double max = 0;
    for (int i = 0; i < n; i++)
        max = fmax(max, fabs((double)v[i]));
    return max;
}

static void rates_temperatures_and_flows_match_the_independent_reference(void)
{
    FILE *f = csv_open("reference/column_points.csv");
    double row[53];
    int rows = 0;
    while (csv_row(f, row, 53)) {
        make((enum column_holdup)(int)row[0]);
        for (int i = 0; i < 20; i++)
            x[i] = (real_t)row[1 + i];
        TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
        double scale = 0;
        for (int i = 0; i < 20; i++)
            scale = fmax(scale, fabs(row[21 + i]));
        for (int i = 0; i < 20; i++)
            TEST_ASSERT_DOUBLE_WITHIN(RATE_BOUND * scale, row[21 + i], (double)rates[i]);
        for (int i = 0; i < 10; i++)
            TEST_ASSERT_DOUBLE_WITHIN(T_BOUND, row[41 + i], (double)column.temperature[i]);
        TEST_ASSERT_DOUBLE_WITHIN(FLOW_BOUND * row[51], row[51], (double)column.flows.distillate);
        TEST_ASSERT_DOUBLE_WITHIN(FLOW_BOUND * row[52], row[52], (double)column.flows.bottoms);
        rows++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL(8, rows);
}

/* An azeotrope in the extreme: activity coefficients that make every component boil alike. */
static void boil_alike(void *context, const real_t *at, real_t t, real_t *gamma)
{
    (void)context;
    (void)at;
    real_t slope, reference = component_vapour_pressure(&test_components[0], t, &slope);
    for (int j = 0; j < 3; j++)
        gamma[j] = reference / component_vapour_pressure(&test_components[j], t, &slope);
}

static void equal_compositions_everywhere_give_zero_rates(void)
{
    struct column_inputs inputs = ternary_inputs();
    for (int form = COLUMN_HOLDUP_MOLAR; form <= COLUMN_HOLDUP_CONSERVATIVE; form++) {
        config = ternary_config((enum column_holdup)form);
        config.activity = boil_alike;
        TEST_ASSERT_EQUAL(ERR_OK, column_init(&column, &config, &fault));
        TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
        for (int s = 0; s < 10; s++) {
            x[2 * s] = REAL_C(0.3);
            x[2 * s + 1] = REAL_C(0.45);
        }
        TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING, 0.0, largest(rates, 20));
    }
}

static void vapour_fractions_of_every_stage_add_up_to_one(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, column_evaluate(&column, x));
    for (size_t s = 0; s < 10; s++) {
        double sum = 0, liquid = 0;
        for (size_t j = 0; j < 3; j++) {
            sum += (double)column.vapour[s * 3 + j];
            liquid += (double)column_fraction(&column, x, s, j);
        }
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING * 100, 1.0, sum);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, liquid);
    }
}

static void flows_of_every_section_balance(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, column_evaluate(&column, x));
    const struct column_flows *f = &column.flows;
    double all = (double)f->liquid_stripping * ROUNDING * 10;
    TEST_ASSERT_DOUBLE_WITHIN(all, (double)f->feed, (double)(f->distillate + f->bottoms));
    TEST_ASSERT_DOUBLE_WITHIN(all, (double)f->bottoms,
                              (double)(f->liquid_stripping - f->vapour_stripping));
    TEST_ASSERT_DOUBLE_WITHIN(all, (double)f->distillate, (double)(f->vapour_top - f->reflux));
    TEST_ASSERT_DOUBLE_WITHIN(all, (double)f->vapour_stripping,
                              (double)(f->vapour_enriching + f->condensed_by_feed));
    TEST_ASSERT_DOUBLE_WITHIN(all, (double)f->boilup_wanted, (double)f->vapour_stripping);
    TEST_ASSERT_DOUBLE_WITHIN(all, (double)f->reflux_wanted, (double)f->reflux);
}

/* d/dt of the moles of component j in the whole column, less what flows in and out, relative to the feed. */
static double unbalance_now(size_t j)
{
    struct column now = column;
    double gathered = 0;
    for (size_t s = 0; s < 10; s++) {
        double rate = j < 2 ? (double)rates[2 * s + j] : -(double)(rates[2 * s] + rates[2 * s + 1]);
        double holdup_rate = 0, volume = 0, growth = 0;
        for (size_t i = 0; i < 3; i++) {
            double v = (double)now.molar_volume[3 * s + i];
            volume += v * (double)column_fraction(&now, x, s, i);
            growth +=
                v * (i < 2 ? (double)rates[2 * s + i] : -(double)(rates[2 * s] + rates[2 * s + 1]));
        }
        if (config.holdup != COLUMN_HOLDUP_MOLAR)
            holdup_rate = -(double)now.holdup[s] * growth / volume;
        gathered +=
            (double)now.holdup[s] * rate + holdup_rate * (double)column_fraction(&now, x, s, j);
    }
    double in = (double)(now.flows.feed * now.inputs.feed_fraction[j]);
    double out = (double)(now.flows.distillate * column_fraction(&now, x, 9, j) +
                          now.flows.bottoms * column_fraction(&now, x, 0, j));
    return fabs(gathered - in + out) / (double)now.flows.feed;
}

static double unbalance(enum column_holdup form, size_t j)
{
    make(form);
    ternary_profile(x, REAL_C(0.3));
    TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
    return unbalance_now(j);
}

/* Without reflux a tray whose liquid turns denser gets nothing from above to keep its volume. */
static void a_tray_short_of_liquid_draws_it_from_below_and_the_balances_stay_closed(void)
{
    struct column_inputs inputs = ternary_inputs();
    inputs.reflux_flow = 0;
    inputs.reflux_subcooling = 0;
    make(COLUMN_HOLDUP_CONSERVATIVE);
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
    for (int s = 0; s < 10;
         s++) { /* heavier below: the volume of a mole falls on the trays above the feed */
        x[2 * s] = s < 5 ? REAL_C(0.9) : REAL_C(0.05);
        x[2 * s + 1] = s < 5 ? REAL_C(0.05) : REAL_C(0.9);
    }
    TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
    int drawing = 0;
    for (int s = 1; s < 9; s++)
        drawing += column.liquid[s] < 0;
    TEST_ASSERT_TRUE(drawing > 0);
    for (size_t j = 0; j < 3; j++)
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING * 10, 0.0, unbalance_now(j));

    /* at the edge of the simplex nothing is driven out of it */
    for (int s = 0; s < 10; s++) {
        x[2 * s] = s < 5 ? REAL_C(1.0) : REAL_C(0.0);
        x[2 * s + 1] = s < 5 ? REAL_C(0.0) : REAL_C(1.0);
    }
    TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
    for (int i = 0; i < 20; i++)
        TEST_ASSERT_TRUE(x[i] > 0 ? rates[i] <= 0 : rates[i] >= 0);
}

static void new_inputs_at_the_same_state_need_no_new_bubble_points(void)
{
    struct column_inputs inputs = ternary_inputs();
    real_t again[20];
    make(COLUMN_HOLDUP_CONSERVATIVE);
    TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
    for (int k = 0; k < 4; k++) {
        inputs.heat *= REAL_C(1.1);
        inputs.reflux_flow *= REAL_C(0.9);
        if (k == 2) /* this asks for new ones */
            inputs.pressure_top *= REAL_C(1.05);
        TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
        TEST_ASSERT_EQUAL(ERR_OK, column_rates_again(&column, x, again));
        real_t distillate = column.flows.distillate, top = column.temperature[9];
        TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
        double scale = largest(rates, 20);
        for (int i = 0; i < 20; i++)
            TEST_ASSERT_DOUBLE_WITHIN(RATE_BOUND * scale, (double)rates[i], (double)again[i]);
        TEST_ASSERT_DOUBLE_WITHIN(T_BOUND, (double)column.temperature[9], (double)top);
        TEST_ASSERT_DOUBLE_WITHIN(FLOW_BOUND * (double)column.flows.feed,
                                  (double)column.flows.distillate, (double)distillate);
    }
}

static void conservative_and_molar_forms_close_every_component_balance_to_rounding(void)
{
    for (size_t j = 0; j < 3; j++) {
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING * 10, 0.0, unbalance(COLUMN_HOLDUP_CONSERVATIVE, j));
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING * 10, 0.0, unbalance(COLUMN_HOLDUP_MOLAR, j));
    }
}

static void the_form_of_the_source_leaves_the_total_balance_open_away_from_steady_state(void)
{
    TEST_ASSERT_TRUE(unbalance(COLUMN_HOLDUP_VOLUMETRIC, 1) > 5e-3);
}

/* Bisection in double on the defining equation, nothing shared with the model. */
static double bubble_by_bisection(const double *at, double pressure)
{
    double lo = 280, hi = 440;
    for (int i = 0; i < 100; i++) {
        double t = 0.5 * (lo + hi), sum = 0;
        for (int j = 0; j < 3; j++) {
            const real_t *a = test_components[j].antoine;
            sum += at[j] * exp((double)a[0] - (double)a[1] / ((double)a[2] + t));
        }
        *(sum > pressure ? &hi : &lo) = t;
    }
    return 0.5 * (lo + hi);
}

static void bubble_points_match_bisection_from_any_start(void)
{
    static const double points[][3] = {{1, 0, 0},          {0, 1, 0},         {0, 0, 1},
                                       {0.01, 0.01, 0.98}, {0.5, 0.25, 0.25}, {0.001, 0.999, 0},
                                       {0.9, 0, 0.1}};
    struct vle vle = {
        .component = test_components, .n = 3, .temperature_min = 280, .temperature_max = 440};
    for (size_t i = 0; i < sizeof points / sizeof points[0]; i++)
        for (double pressure = 3e4; pressure < 2e5; pressure *= 1.7)
            for (real_t start = 280; start <= 440; start += 40) {
                real_t at[3], y[3], k[3], dk[3], t = start;
                for (int j = 0; j < 3; j++)
                    at[j] = (real_t)points[i][j];
                TEST_ASSERT_EQUAL(
                    ERR_OK, vle_bubble_point(&vle, at, (real_t)pressure, &t, y, k, dk, false));
                TEST_ASSERT_DOUBLE_WITHIN(T_BOUND, bubble_by_bisection(points[i], pressure),
                                          (double)t);
            }
}

/* Contract of vle_bubble_point_near: 1e-4 of k at 1 K, with the square; rounding in float. */
static void one_step_nearby_gives_ratios_as_near_as_promised(void)
{
    struct vle vle = {
        .component = test_components, .n = 3, .temperature_min = 280, .temperature_max = 440};
    real_t begin[3] = {REAL_C(0.5), REAL_C(0.25), REAL_C(0.25)}, y[3], k0[3], dk0[3], t0 = 360;
    TEST_ASSERT_EQUAL(ERR_OK, vle_bubble_point(&vle, begin, REAL_C(1e5), &t0, y, k0, dk0, false));
    unsigned near = 0, far = 0;
    for (int i = -40; i <= 40; i++) {
        real_t at[3] = {begin[0] + REAL_C(0.005) * (real_t)i, begin[1], 0}, k[3], dk[3], t = t0;
        real_t whole[3], slopes[3], exact = t0;
        at[2] = 1 - at[0] - at[1];
        memcpy(k, k0, sizeof k);
        memcpy(dk, dk0, sizeof dk);
        TEST_ASSERT_EQUAL(ERR_OK,
                          vle_bubble_point(&vle, at, REAL_C(1e5), &exact, y, whole, slopes, false));
        double off = fabs((double)(exact - t0));
        bool done = vle_bubble_point_near(&vle, at, &t, y, k, dk);
        if (off > (double)VLE_NEAR_K * 1.02) {
            TEST_ASSERT_FALSE(done);
            TEST_ASSERT_TRUE(t == t0 && k[0] == k0[0] && dk[2] == dk0[2]);
            far++;
        } else if (off < (double)VLE_NEAR_K * 0.98) {
            TEST_ASSERT_TRUE(done);
            for (int j = 0; j < 3; j++) {
                double bound =
                    (double)whole[j] * (1e-4 * off * off + (T_BOUND > 1e-6 ? 1e-5 : 1e-9));
                TEST_ASSERT_DOUBLE_WITHIN(bound, (double)whole[j], (double)k[j]);
                TEST_ASSERT_DOUBLE_WITHIN(2e-2 * (double)slopes[j], (double)slopes[j],
                                          (double)dk[j]);
                TEST_ASSERT_TRUE(y[j] == at[j] * k[j]);
            }
            near++;
        }
    }
    TEST_ASSERT_TRUE(near > 5 && far > 5);
    vle.activity = boil_alike;
    TEST_ASSERT_FALSE(vle_bubble_point_near(&vle, begin, &t0, y, k0, dk0));
}

/* Some stages near, some not. Four parts in 1e4 of k at 2 K are 0.02 K where k grows by 2 % a kelvin. */
static void a_column_near_the_last_one_is_evaluated_as_nearly(void)
{
    static struct column whole;
    for (int i = 0; i < 2; i++) {
        setUp();
        if (i == 0) /* nothing to be near to yet */
            TEST_ASSERT_EQUAL(ERR_OK, column_evaluate(&column, x));
        whole = column;
        for (size_t s = 0; s < config.stages; s++)
            x[2 * s] += REAL_C(0.01) * ((real_t)(s % 4) - REAL_C(1.5));
        TEST_ASSERT_EQUAL(ERR_OK, column_evaluate_near(&column, x));
        TEST_ASSERT_EQUAL(ERR_OK, column_evaluate(&whole, x));
        for (size_t s = 0; s < config.stages; s++)
            TEST_ASSERT_DOUBLE_WITHIN(2e-2, (double)whole.temperature[s],
                                      (double)column.temperature[s]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * (double)whole.flows.bottoms, (double)whole.flows.bottoms,
                                  (double)column.flows.bottoms);
    }
    x[4] = (real_t)NAN;
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, column_evaluate_near(&column, x));
}

/* A search that has run away before does no harm to the next one. */
static void a_start_far_from_every_temperature_of_the_plant_is_brought_back(void)
{
    struct vle vle = {
        .component = test_components, .n = 3, .temperature_min = 280, .temperature_max = 440};
    static const double half[3] = {0.5, 0.25, 0.25};
    static const real_t starts[] = {REAL_C(1e30), REAL_C(-1e30), REAL_C(441.0), REAL_C(279.0), 0};
    for (size_t i = 0; i < sizeof starts / sizeof starts[0]; i++) {
        real_t at[3] = {REAL_C(0.5), REAL_C(0.25), REAL_C(0.25)}, y[3], k[3], dk[3], t = starts[i];
        TEST_ASSERT_EQUAL(ERR_OK, vle_bubble_point(&vle, at, REAL_C(1e5), &t, y, k, dk, false));
        TEST_ASSERT_DOUBLE_WITHIN(T_BOUND, bubble_by_bisection(half, 1e5), (double)t);
    }
}

/* As many stages as there is room for: what lies behind the last of them is something else. */
static void the_largest_column_stays_in_its_memory(void)
{
    config.stages = COLUMN_STAGES_MAX;
    memset(&column, 0x55, sizeof column);
    TEST_ASSERT_EQUAL(ERR_OK, column_init(&column, &config, &fault));
    TEST_ASSERT_EQUAL_size_t(COLUMN_STAGES_MAX * 2, column.n_states);
    TEST_ASSERT_TRUE(column.temperature[COLUMN_STAGES_MAX - 1] == 360);
    TEST_ASSERT_TRUE(column.liquid[0] == 0); /* nothing has flown yet */
}

static void a_pressure_without_a_bubble_point_is_refused_and_the_start_kept(void)
{
    struct vle vle = {
        .component = test_components, .n = 3, .temperature_min = 280, .temperature_max = 440};
    real_t at[3] = {1, 0, 0}, y[3], k[3], dk[3], t = 300;
    TEST_ASSERT_EQUAL(ERR_RANGE, vle_bubble_point(&vle, at, REAL_C(1e7), &t, y, k, dk, false));
    TEST_ASSERT_EQUAL(ERR_RANGE, vle_bubble_point(&vle, at, REAL_C(10.0), &t, y, k, dk, false));
    TEST_ASSERT_TRUE(t == 300);
    at[0] = (real_t)NAN;
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, vle_bubble_point(&vle, at, REAL_C(1e5), &t, y, k, dk, false));
}

static void the_extended_terms_of_the_vapour_pressure_are_those_of_the_equation(void)
{
    static const double exponents[] = {1, 2, 6,
                                       1.5}; /* the first three have products of their own */
    for (int i = 0; i < 4; i++) {
        struct component c = test_components[0];
        double g = exponents[i], f = 0.1 / pow(350, g);
        c.antoine[3] = REAL_C(1e-3);
        c.antoine[4] = REAL_C(-0.5);
        c.antoine[5] = (real_t)f;
        c.antoine[6] = (real_t)g;
        real_t slope, p = component_vapour_pressure(&c, 350, &slope);
        double expected =
            exp(21.354957 - 3177.86676 / (350 - 36.672) + 0.35 - 0.5 * log(350) + 0.1);
        double rate = 3177.86676 / (313.328 * 313.328) + 1e-3 - 0.5 / 350 + g * 0.1 / 350;
        TEST_ASSERT_DOUBLE_WITHIN(expected * (FLOW_BOUND > 1e-6 ? 1e-5 : 1e-12), expected,
                                  (double)p);
        TEST_ASSERT_DOUBLE_WITHIN(expected * rate * (FLOW_BOUND > 1e-6 ? 1e-5 : 1e-10),
                                  expected * rate, (double)slope);
    }
}

static void vapour_pressures_of_all_components_are_those_of_each(void)
{
    real_t p[3], slopes[3];
    component_vapour_pressures(test_components, 3, 371, p, slopes);
    for (int j = 0; j < 3; j++) {
        real_t slope, alone = component_vapour_pressure(&test_components[j], 371, &slope);
        TEST_ASSERT_TRUE(p[j] == alone && slopes[j] == slope);
    }
}

static void a_state_that_is_no_number_is_refused(void)
{
    x[7] = (real_t)NAN;
    TEST_ASSERT_EQUAL(ERR_NOT_FINITE, column_rates(&column, x, rates));
    ternary_profile(x, 0);
    TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
}

static void flows_never_turn_negative_whatever_the_inputs(void)
{
    static const double feeds[] = {0, 1e-9, 1.5e-6, 1e-5}, refluxes[] = {0, 1e-9, 1.1e-6, 1e-4},
                        heats[] = {0, 0.01, 50, 700, 1e5}, colds[] = {0, 8, 100},
                        warms[] = {285, 335, 440};
    for (size_t n = 0; n < 4 * 4 * 5 * 3 * 3; n++) {
        struct column_inputs in = ternary_inputs();
        in.feed_flow = (real_t)feeds[n % 4];
        in.reflux_flow = (real_t)refluxes[n / 4 % 4];
        in.heat = (real_t)heats[n / 16 % 5];
        in.reflux_subcooling = (real_t)colds[n / 80 % 3];
        in.feed_temperature = (real_t)warms[n / 240];
        TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &in, &fault));
        TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));
        const struct column_flows *f = &column.flows;
        const real_t all[] = {f->reflux,           f->liquid_enriching, f->liquid_stripping,
                              f->vapour_stripping, f->vapour_enriching, f->vapour_top,
                              f->distillate,       f->bottoms};
        double size = 1e-30 + (double)f->liquid_stripping + (double)f->vapour_top + (double)f->feed;
        for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
            TEST_ASSERT_TRUE_MESSAGE(all[i] >= 0, "a flow is negative or NaN");
        TEST_ASSERT_DOUBLE_WITHIN(size * ROUNDING, (double)f->bottoms,
                                  (double)(f->liquid_stripping - f->vapour_stripping));
        TEST_ASSERT_DOUBLE_WITHIN(size * ROUNDING, (double)f->feed,
                                  (double)(f->distillate + f->bottoms));
        TEST_ASSERT_TRUE((double)f->boilup_wanted * (1 + ROUNDING) + size * ROUNDING >=
                         (double)f->vapour_stripping);
    }
}

#ifdef REFLUX_REAL_DOUBLE
/* Rates with the internal flows and holdups of the base point, by the same sums as the model's header says:
 * a difference quotient of column_rates would also move the flows, which the Jacobian holds. */
static void held_rates(const struct column *base, const double *at, double *out)
{
    struct column moved = *base;
    TEST_ASSERT_EQUAL(ERR_OK, column_evaluate(&moved, at));
    for (size_t s = 0; s < 10; s++)
        for (size_t j = 0; j < 2; j++) {
            double here = at[2 * s + j],
                   sum = -base->vapour_flow[s] * (moved.vapour[3 * s + j] - here);
            if (s < 9)
                sum += base->liquid[s + 1] * (at[2 * s + 2 + j] - here);
            if (s > 0)
                sum += base->vapour_flow[s - 1] * (moved.vapour[3 * s - 3 + j] - here);
            if (s == 3)
                sum += base->flows.feed * (base->inputs.feed_fraction[j] - here);
            out[2 * s + j] = sum / base->holdup[s];
        }
}

static void compare_jacobian(double efficiency)
{
    struct column_inputs inputs = ternary_inputs();
    config = ternary_config(COLUMN_HOLDUP_VOLUMETRIC);
    config.efficiency = efficiency;
    TEST_ASSERT_EQUAL(ERR_OK, column_init(&column, &config, &fault));
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
    TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, rates));

    size_t lower, upper;
    column_jacobian_shape(&config, &lower, &upper);
    double band[20 * 16], outside = 0, scale = 0;
    TEST_ASSERT_TRUE(lower + upper + 1 <= 16);
    column_jacobian(&column, x, band, 16, upper);
    for (int col = 0; col < 20; col++) {
        double above[20], below[20], h = 1e-5, keep = x[col];
        x[col] = keep + h;
        held_rates(&column, x, above);
        x[col] = keep - h;
        held_rates(&column, x, below);
        x[col] = keep;
        for (int row = 0; row < 20; row++) {
            double slope = (above[row] - below[row]) / (2 * h);
            scale = fmax(scale, fabs(slope));
            if (row - col <= (int)lower && col - row <= (int)upper) {
                if (row / 2 - col / 2 <= COLUMN_JACOBIAN_MEMORY)
                    TEST_ASSERT_DOUBLE_WITHIN(2e-6, slope, band[col * 16 + (int)upper + row - col]);
            } else {
                outside = fmax(outside, fabs(slope));
            }
        }
    }
    /* Part that is left out: the vapour's memory of stages further down than the band, (1 - E)^3 of it. */
    double allowed = efficiency < 1 ? pow(1 - efficiency, COLUMN_JACOBIAN_MEMORY) * scale : 1e-9;
    TEST_ASSERT_TRUE(outside <= allowed);
}

static void the_jacobian_matches_differences_inside_its_band(void)
{
    compare_jacobian(0.7);
    compare_jacobian(0.9);
}

static void the_jacobian_is_complete_with_ideal_trays(void)
{
    compare_jacobian(1.0);
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(rates_temperatures_and_flows_match_the_independent_reference);
    RUN_TEST(equal_compositions_everywhere_give_zero_rates);
    RUN_TEST(vapour_fractions_of_every_stage_add_up_to_one);
    RUN_TEST(flows_of_every_section_balance);
    RUN_TEST(conservative_and_molar_forms_close_every_component_balance_to_rounding);
    RUN_TEST(a_tray_short_of_liquid_draws_it_from_below_and_the_balances_stay_closed);
    RUN_TEST(new_inputs_at_the_same_state_need_no_new_bubble_points);
    RUN_TEST(the_form_of_the_source_leaves_the_total_balance_open_away_from_steady_state);
    RUN_TEST(bubble_points_match_bisection_from_any_start);
    RUN_TEST(one_step_nearby_gives_ratios_as_near_as_promised);
    RUN_TEST(a_column_near_the_last_one_is_evaluated_as_nearly);
    RUN_TEST(a_start_far_from_every_temperature_of_the_plant_is_brought_back);
    RUN_TEST(the_largest_column_stays_in_its_memory);
    RUN_TEST(a_pressure_without_a_bubble_point_is_refused_and_the_start_kept);
    RUN_TEST(the_extended_terms_of_the_vapour_pressure_are_those_of_the_equation);
    RUN_TEST(vapour_pressures_of_all_components_are_those_of_each);
    RUN_TEST(a_state_that_is_no_number_is_refused);
    RUN_TEST(flows_never_turn_negative_whatever_the_inputs);
#ifdef REFLUX_REAL_DOUBLE
    RUN_TEST(the_jacobian_matches_differences_inside_its_band);
    RUN_TEST(the_jacobian_is_complete_with_ideal_trays);
#endif
    return UNITY_END();
}
