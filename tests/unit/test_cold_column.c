/* Equations of the column that may be cold, dry or boiling: balances, limits, states. */
#include "columns/cold_states.h"
#include "columns/stiff_solver.h"
#include "model/vle.h"
#include "unity.h"

#include <math.h>
#include <string.h>

static const struct component components[2] = {
#include "plants/pilot_properties.inc"
};

#define STAGES 5
#define STATES (3 * STAGES + 2)
#define TRAY                                                                                       \
    {                                                                                              \
        .metal = 250.0, .loss = 0.05, .film = 0.004, .boilable = 0.02                              \
    }

static const struct cold_config config = {
    .component = components,
    .stages = STAGES,
    .feed_stage = 2,
    .efficiency = 0.7,
    .pressure_drop = 800.0,
    .latent = 33000.0,
    .boiling = 10.0,
    .boiling_onset = 2e-4,
    .boiling_limit = 0.05,
    .weir = 0.15,
    .weir_flow = 2.0,
    .weep_time = 8.0,
    .weep_vapour = 4e-3,
    .overflow_flow = 0.02,
    .stage = {{.metal = 2000.0, .loss = 1.0, .film = 0.4, .boilable = 0.3},
              TRAY,
              TRAY,
              TRAY,
              {.metal = 80.0, .loss = 0.2, .film = 0.04, .boilable = 0.03}},
    .reboiler =
        {.area = 0.008, .outlet = 0.01, .overflow = 0.3, .nominal = 0.1, .product_max = 3e-6},
    .drum = {.area = 0.002, .outlet = 0.006, .overflow = 0.1, .nominal = 0.05, .product_max = 1e-6},
    .reflux_max = 3e-6,
    .feed_max = 3e-6,
    .valve_min = 0.025,
    .heater_metal = 300.0,
    .heater_wet = 25.0,
    .heater_dry = 0.8,
    .heater_bottom = 0.02,
    .heater_top = 0.04,
    .heater_cut = 580.0,
    .heater_cut_width = 15.0,
    .condenser = 40.0,
    .condenser_loss = 0.4,
    .condenser_water = 900.0,
    .subcooling = 0.05,
    .water_max = 1.5e-5,
    .swell_vapour = 2e-3,
};

static struct cold_inputs u;
static unsigned seed;

static double uniform(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) / 16777216.0;
}

static double between(double lo, double hi)
{
    return lo + (hi - lo) * uniform();
}

static void random_inputs(void)
{
    u = (struct cold_inputs){
        .heat = between(0, 1500),
        .reflux = uniform(),
        .distillate = uniform(),
        .bottoms = uniform(),
        .feed = uniform(),
        .water = uniform(),
        .feed_fraction = uniform(),
        .feed_temperature = between(280, 390),
        .ambient = between(278, 313),
        .water_temperature = between(275, 313),
        .water_supply = uniform(),
        .pressure = between(8e4, 1.2e5),
        .swell = between(0, 0.1),
        .loss_factor = between(0, 3),
        .leak = uniform() < 0.5 ? 0 : between(0, 1e-5),
    };
}

static void random_state(double *y)
{
    double x[STATES], ignored[STATES];
    char err[80];
    for (size_t s = 0; s < STAGES; s++) {
        double most = s == 0 ? 20.0 : s == STAGES - 1 ? 2.0 : 0.3;
        x[3 * s] = uniform();
        x[3 * s + 1] = between(config.stage[s].film, most);
        x[3 * s + 2] = between(2.8, 4.0);
    }
    x[STATES - 2] = between(2.8, 5.9);
    x[STATES - 1] = between(2.75, 3.6);
    TEST_ASSERT_TRUE_MESSAGE(cold_states_set(&config, x, y, err, sizeof err), err);
    TEST_ASSERT_TRUE(cold_rates(&config, &u, y, ignored, NULL));
}

void setUp(void)
{
    seed = 5;
    random_inputs();
}

void tearDown(void) {}

static double sum3(const struct cold_stream *s, int j)
{
    return j < 2 ? s->n[j] : s->h;
}

/* Flows from the surroundings: component 0, component 1, energy. */
static double brought(const struct cold_outputs *o, int j)
{
    double in = sum3(&o->feed, j) - sum3(&o->distillate, j) - sum3(&o->bottoms, j) -
                sum3(&o->leak, j) - sum3(&o->vent, j);
    return j < 2 ? in : in + o->power - o->loss - o->cooled;
}

static double stored(const double *y, int j) /* also of rates */
{
    double sum = j < 2 ? 0 : config.heater_metal * y[0] + config.condenser_water * y[STATES - 1];
    for (size_t s = 0; s < STAGES; s++)
        sum += y[1 + 3 * s + (size_t)j];
    return sum;
}

static void what_the_stages_gain_is_what_the_surroundings_bring(void)
{
    struct cold_outputs o;
    double y[STATES], dy[STATES], worst = 0;
    for (int k = 0; k < 5000; k++) {
        random_inputs();
        random_state(y);
        TEST_ASSERT_TRUE(cold_rates(&config, &u, y, dy, &o));
        for (int j = 0; j < 3; j++) {
            double gross = j < 2 ? 1e-3 : 1e3;
            for (size_t s = 0; s < STAGES; s++)
                gross += fabs(sum3(&o.vapour[s], j)) + fabs(sum3(&o.liquid[s], j));
            worst = fmax(worst, fabs(stored(dy, j) - brought(&o, j)) / gross);
        }
    }
    printf("balances of 5000 states: within %.2g of what flows\n", worst);
    TEST_ASSERT_TRUE(worst < 1e-13);
}

/* States and, behind them, meters of what was brought in. */
static bool metered(void *context, const double *y, double *dy)
{
    struct cold_outputs o;
    (void)context;
    if (!cold_rates(&config, &u, y, dy, &o))
        return false;
    for (int j = 0; j < 3; j++)
        dy[STATES + j] = brought(&o, j);
    return true;
}

static void moles_and_heat_of_a_day_of_changing_inputs_balance(void)
{
    double y[STATES + 3] = {0}, absolute[STATES + 3], begun[3], worst[3] = {0}, turned[3] = {0};
    char err[200];
    cold_start(&config, 0.4, 293.0, 0.15, y);
    for (int i = 0; i < STATES + 3; i++)
        absolute[i] = 1e-6;
    struct stiff_problem problem = {
        .name = "test", .n = STATES + 3, .relative = 1e-7, .absolute = absolute, .rates = metered};
    struct stiff_solver *solver = stiff_solver_create(&problem, y, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(solver, err);
    for (int j = 0; j < 3; j++)
        begun[j] = stored(y, j);
    for (int hour = 1; hour <= 24; hour++) {
        random_inputs();
        if (hour % 2) {
            u.heat = between(700, 1250); /* mostly alive */
            u.water = u.water_supply = 1;
            u.leak = 0;
        }
        stiff_solver_restart(solver);
        TEST_ASSERT_TRUE_MESSAGE(stiff_solver_advance(solver, hour * 3600.0, err, sizeof err), err);
        const double *now = stiff_solver_state(solver);
        for (int j = 0; j < 3; j++) {
            worst[j] = fmax(worst[j], fabs(stored(now, j) - begun[j] - now[STATES + j]));
            turned[j] = fmax(turned[j], fabs(now[STATES + j]));
        }
    }
    stiff_solver_destroy(solver);
    printf("a day: %.2g and %.2g mol of %.0f and %.0f are missing, %.2g J of %.0f kJ\n", worst[0],
           worst[1], turned[0], turned[1], worst[2], turned[2] * 1e-3);
    TEST_ASSERT_TRUE(turned[0] > 1 && turned[1] > 1 && turned[2] > 1e5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, worst[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, worst[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, worst[2]);
}

static void temperature_and_energy_are_inverse(void)
{
    for (int k = 0; k < 1000; k++) {
        size_t s = (size_t)(uniform() * STAGES);
        double n[2] = {between(0, 10), between(0, 10)}, t = between(250, 450);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, t,
                                  cold_temperature(&config, s, n, cold_energy(&config, s, n, t)));
    }
}

static void the_rate_of_temperature_is_that_of_energy_and_moles(void)
{
    double n[3] = {3, 2, 0}, d[3] = {0.01, -0.02, 40}, h = 1e-3;
    n[2] = cold_energy(&config, 1, n, 350.0);
    double m[2] = {n[0] + h * d[0], n[1] + h * d[1]};
    double by_difference = (cold_temperature(&config, 1, m, n[2] + h * d[2]) - 350.0) / h;
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, by_difference, cold_temperature_rate(&config, 1, n, n[2], d));
}

/* One stage set to a composition and a temperature, the rest at films and 280 K. */
static void only(double *y, size_t s, double x, double holdup, double t)
{
    cold_start(&config, 0.5, 280.0, 0.0, y);
    y[1 + 3 * s] = x * holdup;
    y[2 + 3 * s] = (1 - x) * holdup;
    y[3 + 3 * s] = cold_energy(&config, s, &y[1 + 3 * s], t);
}

static void nothing_rises_below_the_bubble_point_and_above_it_the_equilibrium_vapour(void)
{
    struct vle vle = {
        .component = components, .n = 2, .temperature_min = 250, .temperature_max = 450};
    struct cold_outputs o;
    double y[STATES], dy[STATES], eq[2], k[2], dk[2];
    for (int i = 1; i < 20; i++) {
        double x[2] = {i / 20.0, 1 - i / 20.0}, t = 370;
        double pressure = u.pressure + config.pressure_drop;
        TEST_ASSERT_EQUAL(0, vle_bubble_point(&vle, x, pressure, &t, eq, k, dk, false));
        only(y, 0, x[0], 5.0, t - 1e-6);
        TEST_ASSERT_TRUE(cold_rates(&config, &u, y, dy, &o));
        TEST_ASSERT_TRUE(o.own[0] == 0.0);
        only(y, 0, x[0], 5.0, t + 0.05);
        TEST_ASSERT_TRUE(cold_rates(&config, &u, y, dy, &o));
        TEST_ASSERT_TRUE(o.own[0] > 1e-3);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, eq[0], o.vapour[0].n[0] / o.own[0]);
    }
}

static void vapour_condenses_on_a_cold_tray_but_for_the_part_that_passes_untouched(void)
{
    struct cold_outputs o;
    double y[STATES], dy[STATES];
    only(y, 0, 0.4, 5.0, 385.0);
    TEST_ASSERT_TRUE(cold_rates(&config, &u, y, dy, &o));
    double up = o.own[0];
    TEST_ASSERT_TRUE(up > 0.1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.3 * up, o.vapour[1].n[0] + o.vapour[1].n[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.7 * up, dy[4] + dy[5]);
    TEST_ASSERT_TRUE(dy[6] > 0.7 * up * config.latent * 0.9);
}

static void a_film_neither_boils_nor_drains_nor_leaks(void)
{
    struct cold_outputs o;
    double y[STATES], dy[STATES];
    u.leak = 1e-5;
    for (size_t s = 0; s < STAGES; s++) {
        only(y, s, 0.5, config.stage[s].film, 420.0);
        TEST_ASSERT_TRUE(cold_rates(&config, &u, y, dy, &o));
        TEST_ASSERT_TRUE(o.own[s] == 0.0);
        TEST_ASSERT_TRUE(o.liquid[s].n[0] == 0.0 && o.liquid[s].n[1] == 0.0);
        TEST_ASSERT_TRUE(o.leak.n[0] == 0.0);
    }
}

static void vapour_beyond_the_condenser_goes_to_the_vent_and_none_within_it(void)
{
    struct cold_outputs o;
    double y[STATES], dy[STATES];
    u.water = u.water_supply = 1;
    only(y, STAGES - 2, 0.9, 0.2, 362.0);
    y[STATES - 1] = 300.0;
    TEST_ASSERT_TRUE(cold_rates(&config, &u, y, dy, &o));
    double up = o.own[STAGES - 2], limit = config.condenser * (362.0 - 300.0) / config.latent;
    TEST_ASSERT_TRUE(up > 0.3);
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * limit, up - limit, o.vent.n[0] + o.vent.n[1]);
    only(y, STAGES - 2, 0.9, 0.2, 355.0); /* nothing boils */
    TEST_ASSERT_TRUE(cold_rates(&config, &u, y, dy, &o));
    TEST_ASSERT_TRUE(o.vent.n[0] == 0.0 && o.vent.n[1] == 0.0);
}

static void nothing_leaves_below_the_outlet_and_the_overflow_opens_above_the_brim(void)
{
    struct cold_outputs o;
    double y[STATES], dy[STATES];
    u.bottoms = 1;
    cold_start(&config, 0.5, 300.0, 0.0099, y);
    TEST_ASSERT_TRUE(cold_rates(&config, &u, y, dy, &o));
    TEST_ASSERT_TRUE(o.bottoms_volume == 0.0);
    cold_start(&config, 0.5, 300.0, config.reboiler.nominal, y);
    TEST_ASSERT_TRUE(cold_rates(&config, &u, y, dy, &o));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, config.reboiler.product_max, o.bottoms_volume);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, config.reboiler.nominal, o.level_reboiler);
    u.bottoms = 0.0249; /* shut: 40:1 */
    TEST_ASSERT_TRUE(cold_rates(&config, &u, y, dy, &o));
    TEST_ASSERT_TRUE(o.bottoms_volume == 0.0);
    cold_start(&config, 0.5, 300.0, config.reboiler.overflow + 0.01, y);
    TEST_ASSERT_TRUE(cold_rates(&config, &u, y, dy, &o));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2e-5, o.bottoms_volume);
}

static void the_heater_gives_up_heat_by_its_covered_part_and_its_thermostat_takes_the_power(void)
{
    struct cold_outputs o;
    double y[STATES], dy[STATES];
    u.heat = 1000;
    cold_start(&config, 0.5, 300.0, 0.1, y);
    y[0] = 340.0;
    TEST_ASSERT_TRUE(cold_rates(&config, &u, y, dy, &o));
    TEST_ASSERT_TRUE(o.covered == 1.0 && o.power == 1000.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, (1000.0 - 25.0 * 40.0) / 300.0, dy[0]);
    cold_start(&config, 0.5, 300.0, 0.015, y);
    y[0] = 340.0;
    TEST_ASSERT_TRUE(cold_rates(&config, &u, y, dy, &o));
    TEST_ASSERT_TRUE(o.covered == 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, (1000.0 - 0.8 * 40.0) / 300.0, dy[0]);
    y[0] = 580.0;
    TEST_ASSERT_TRUE(cold_rates(&config, &u, y, dy, &o));
    TEST_ASSERT_TRUE(o.power == 0.0 && dy[0] < 0);
}

static void states_that_are_no_numbers_are_refused(void)
{
    double y[STATES], dy[STATES];
    for (int i = 0; i < STATES; i++) {
        cold_start(&config, 0.5, 300.0, 0.1, y);
        y[i] = i % 2 ? NAN : INFINITY;
        TEST_ASSERT_FALSE(cold_rates(&config, &u, y, dy, NULL));
    }
}

static void states_as_read_and_as_integrated_are_inverse_and_nonsense_is_refused_in_words(void)
{
    double y[STATES], back[STATES], x[STATES], dx[STATES], dy[STATES];
    char err[80];
    for (int k = 0; k < 200; k++) {
        random_state(y);
        cold_states_get(&config, y, x);
        TEST_ASSERT_TRUE(cold_states_set(&config, x, back, err, sizeof err));
        for (int i = 0; i < STATES; i++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-9 * (1 + fabs(y[i])), y[i], back[i]);
        cold_states_rates(&config, &u, y, dx);
        TEST_ASSERT_TRUE(cold_rates(&config, &u, y, dy, NULL));
        double h = 1e-8; /* a small step in y is one in x */
        for (int i = 0; i < STATES; i++)
            back[i] = y[i] + h * dy[i];
        double moved[STATES];
        cold_states_get(&config, back, moved);
        for (int i = 0; i < STATES; i++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-3 * fabs(dx[i]) + 1e-5, dx[i], (moved[i] - x[i]) / h);
    }
    x[0] = 1.5;
    TEST_ASSERT_FALSE(cold_states_set(&config, x, back, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("state 0 = 1.5 must be 0 to 1", err);
    x[0] = 0.5;
    x[STATES - 1] = NAN;
    TEST_ASSERT_FALSE(cold_states_set(&config, x, back, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("state 16 = nan must be 2 to 8", err);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_the_stages_gain_is_what_the_surroundings_bring);
    RUN_TEST(moles_and_heat_of_a_day_of_changing_inputs_balance);
    RUN_TEST(temperature_and_energy_are_inverse);
    RUN_TEST(the_rate_of_temperature_is_that_of_energy_and_moles);
    RUN_TEST(nothing_rises_below_the_bubble_point_and_above_it_the_equilibrium_vapour);
    RUN_TEST(vapour_condenses_on_a_cold_tray_but_for_the_part_that_passes_untouched);
    RUN_TEST(a_film_neither_boils_nor_drains_nor_leaks);
    RUN_TEST(vapour_beyond_the_condenser_goes_to_the_vent_and_none_within_it);
    RUN_TEST(nothing_leaves_below_the_outlet_and_the_overflow_opens_above_the_brim);
    RUN_TEST(the_heater_gives_up_heat_by_its_covered_part_and_its_thermostat_takes_the_power);
    RUN_TEST(states_that_are_no_numbers_are_refused);
    RUN_TEST(states_as_read_and_as_integrated_are_inverse_and_nonsense_is_refused_in_words);
    return UNITY_END();
}
