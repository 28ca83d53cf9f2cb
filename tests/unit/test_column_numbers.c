/* Every number of a column of ten stages for inputs of all sizes, to five digits: flows, temperatures, holdups and rates, in
 * each of the three forms of holdup, with the flows given in each of the three ways, without a feed, with a feed that is
 * cold or boiling, with too much heat or none, too much reflux or none, and a Jacobian of each form; and the ranges of
 * everything that a column can be given.
 *
 * Kept in reference/column_numbers.txt; how it is made anew: support/kept_transcript.h. How right the numbers have to be
 * say test_column.c, test_column_balances.c and test_pilot.c.
 */
#include <string.h>

#include "kept_transcript.h"
#include "model/column.h"
#include "ranges.h"
#include "test_columns.h"

#define STAGES 10
#define BAND   16

static struct column column;
static struct column_config config;
static struct column_inputs inputs;
static struct column_fault fault;
static struct component components[3];

void setUp(void)
{
    config = ternary_config(COLUMN_HOLDUP_VOLUMETRIC);
    inputs = ternary_inputs();
    memcpy(components, test_components, sizeof components);
    config.component = components;
}
void tearDown(void) {}

static void says(const char *what, const real_t *x, unsigned n, unsigned every)
{
    char text[TRANSCRIPT_LINE];
    size_t at = (size_t)snprintf(text, sizeof text, "%s", what);
    for (unsigned k = 0; k < n; k += every)
        at += (size_t)snprintf(text + at, sizeof text - at, " %.5g", (double)x[k]);
    kept_line("%s", text);
}

static void says_column(const char *what, const real_t *x)
{
    static real_t rates[2 * STAGES];
    kept_line("# %s, holdup %d, basis %d %d", what, config.holdup, inputs.feed_basis,
              inputs.reflux_basis);
    TEST_ASSERT_EQUAL_INT(ERR_OK, column_set_inputs(&column, &inputs, &fault));
    enum err err = column_rates(&column, x, rates);
    if (err) {
        kept_line("error %d", err);
        return;
    }
    const struct column_flows *f = &column.flows;
    kept_line("feed %.5g reflux %.5g liquid %.5g %.5g vapour %.5g %.5g %.5g products %.5g %.5g "
              "wanted %.5g %.5g condensed %.5g %.5g",
              (double)f->feed, (double)f->reflux, (double)f->liquid_enriching,
              (double)f->liquid_stripping, (double)f->vapour_stripping, (double)f->vapour_enriching,
              (double)f->vapour_top, (double)f->distillate, (double)f->bottoms,
              (double)f->reflux_wanted, (double)f->boilup_wanted, (double)f->condensed_by_feed,
              (double)f->condensed_by_reflux);
    says("liquid", column.liquid, STAGES, 1);
    says("rates", rates, 2 * STAGES, 3);
}

static void says_state(const real_t *x)
{
    static real_t band[2 * STAGES * BAND];
    size_t lower, upper;
    says("temperature", column.temperature, STAGES, 1);
    says("holdup", column.holdup, STAGES, 1);
    says("vapour flow", column.vapour_flow, STAGES, 1);
    says("vapour", column.vapour, 3 * STAGES, 4);
    column_jacobian_shape(&config, &lower, &upper);
    kept_line("shape %u %u", (unsigned)lower, (unsigned)upper);
    memset(band, 0, sizeof band);
    TEST_ASSERT_TRUE(lower + upper + 1 <= BAND);
    column_jacobian(&column, x, band, BAND, upper);
    for (unsigned k = 0; k < 2 * STAGES; k += 3)
        says("column", band + (size_t)k * BAND, (unsigned)(lower + upper + 1), 1);
}

static const struct {
    const char *name;
    double feed, reflux, heat, subcooling, cold;
} changes[] = {
    {"as it is", 1, 1, 1, 8, 335},
    {"no feed", 0, 1, 1, 8, 335},
    {"a cold feed", 1.5, 1, 1, 8, 285},
    {"a colder and larger feed", 8, 1, 0.4, 8, 282},
    {"a hot feed", 1, 1, 1, 8, 435},
    {"a large hot feed", 9, 1, 0.3, 0, 438},
    {"no reflux", 1, 0, 1, 8, 335},
    {"much reflux", 1, 4, 1, 30, 335},
    {"as much reflux as vapour", 1, 1.62, 1, 8, 335},
    {"no heat", 1, 1, 0, 8, 335},
    {"little heat", 1, 1, 0.05, 8, 335},
    {"much heat", 1, 1, 3, 0, 335},
    {"as much distillate as feed", 0.4, 0.9, 1.01, 8, 335},
    {"nothing at all", 0, 0, 0, 0, 335},
};

static void the_numbers_of_a_column_are_the_ones_kept(void)
{
    real_t x[2 * STAGES];
    const struct column_inputs usual = ternary_inputs();
    kept_open("reference/column_numbers.txt");
    for (int holdup = COLUMN_HOLDUP_MOLAR; holdup <= COLUMN_HOLDUP_CONSERVATIVE; holdup++) {
        config = ternary_config((enum column_holdup)holdup);
        ternary_profile(x, (real_t)(0.1 * holdup));
        TEST_ASSERT_EQUAL_INT(ERR_OK, column_init(&column, &config, &fault));
        for (unsigned i = 0; i < sizeof changes / sizeof changes[0]; i++) {
            inputs = usual;
            inputs.feed_flow *= (real_t)changes[i].feed;
            inputs.reflux_flow *= (real_t)changes[i].reflux;
            inputs.heat *= (real_t)changes[i].heat;
            inputs.reflux_subcooling = (real_t)changes[i].subcooling;
            inputs.feed_temperature = (real_t)changes[i].cold;
            says_column(changes[i].name, x);
            if (i == 0)
                says_state(x);
        }
        inputs = usual;
        inputs.feed_basis = (enum column_basis)holdup;
        inputs.reflux_basis = (enum column_basis)((holdup + 1) % 3);
        inputs.feed_flow = REAL_C(0.01);
        inputs.reflux_flow = REAL_C(0.009);
        inputs.pressure_top = REAL_C(6e4);
        says_column("another basis", x);
        inputs = usual;
        for (int turned = 0; turned < 2; turned++) {
            for (unsigned k = 0; k < STAGES; k++) /* heavy above: every tray's volume changes */
                x[2 * k] = turned ? (real_t)(0.9 - 0.08 * k) : (real_t)(0.1 + 0.08 * k);
            for (unsigned k = 0; k < STAGES; k++)
                x[2 * k + 1] = REAL_C(0.05);
            inputs.reflux_flow = REAL_C(0.0);
            says_column(turned ? "no reflux, heavy above" : "no reflux, light above", x);
        }
    }
    static const double exponents[] = {1, 2, 6, 1.5};
    for (unsigned i = 0; i < 4; i++) {
        static const double sizes[] = {1e-4, 1e-7, 1e-17, 1e-5};
        components[1].antoine[2] = REAL_C(-50.0) * (real_t)(i > 0);
        components[1].antoine[0] = REAL_C(17.0);
        components[1].antoine[3] = REAL_C(1e-3) * (real_t)(i > 1);
        components[1].antoine[4] = REAL_C(0.6);
        components[1].antoine[5] = (real_t)sizes[i];
        components[1].antoine[6] = (real_t)exponents[i];
        config = ternary_config(COLUMN_HOLDUP_VOLUMETRIC);
        config.component = components;
        inputs = usual;
        ternary_profile(x, REAL_C(0.1));
        TEST_ASSERT_EQUAL_INT(ERR_OK, column_init(&column, &config, &fault));
        says_column("a longer equation", x);
        says_state(x);
    }
    kept_close();
}

/* ---- ranges ---- */

static enum err try_config(void)
{
    return column_validate(&config, &fault);
}

static enum err try_inputs(void)
{
    return column_validate_inputs(&config, &inputs, &fault);
}

static enum err try_component(void)
{
    enum err err = column_validate(&config, &fault);
    TEST_ASSERT_TRUE(err == ERR_OK || fault.field[0] != '\0');
    return err;
}

static void configs_and_inputs_have_the_ranges_that_are_stated(void)
{
    static const struct range configs[] = {
        RANGE(column_config, efficiency, 0.01, 1),
        RANGE(column_config, pressure_drop, 0, 1e7),
        ABOVE(column_config, holdup_reboiler, 0, 1e12),
        ABOVE(column_config, holdup_tray, 0, 1e12),
        ABOVE(column_config, holdup_condenser, 0, 1e12),
        RANGE(column_config, holdup_temperature_bottom, 280, 440),
        RANGE(column_config, holdup_temperature_top, 280, 440),
        RANGE(column_config, limit_softness, 0.001, 0.5),
    };
    static const struct range flows[] = {
        RANGE(column_inputs, feed_flow, 0, 1e12),
        RANGE(column_inputs, feed_temperature, 280, 440),
        RANGE(column_inputs, reflux_flow, 0, 1e12),
        RANGE(column_inputs, reflux_subcooling, 0, 100),
        RANGE(column_inputs, heat, 0, 1e12),
        RANGE(column_inputs, pressure_top, 100, 1e7),
        RANGE(column_inputs, feed_fraction[2], 0.249, 0.251),
    };
    static const struct range parts[] = {
        RANGE(component, antoine[0], -1e12, 1e12), RANGE(component, antoine[6], -1e12, 1e12),
        RANGE(component, molar_mass, 1e-4, 10),    RANGE(component, vaporisation_heat, 1, 1e6),
        RANGE(component, boiling_point, 1, 571),   RANGE(component, heat_capacity, 1, 1e5),
        ABOVE(component, antoine[2], -280, 1e12),
    };
    CHECK(config, configs, try_config);
    CHECK(inputs, flows, try_inputs);
    TEST_ASSERT_EQUAL_INT(ERR_OK, try_inputs());
    TEST_ASSERT_EQUAL_STRING("", fault.field);
    TEST_ASSERT_EQUAL_STRING("", fault.wanted);
    CHECK(components[0], parts, try_component);
}

static void temperatures_and_densities_have_the_ranges_that_are_stated(void)
{
    static const struct {
        double lo, hi, density, slope, critical;
        bool good;
    } cases[] = {
        {280, 440, 1991, -1.8, 571, true},    {50, 60, 1991, -1.8, 571, true},
        {49.9, 60, 1991, -1.8, 571, false},   {280, 281, 1991, -1.8, 571, true},
        {280, 280.9, 1991, -1.8, 571, false}, {280, 440, 1, 0, 571, true},
        {280, 440, 0.99, 0, 571, false},      {280, 440, 30000, 0, 571, true},
        {280, 440, 30030, 0, 571, false},     {280, 440, 441, -1, 571, true},
        {280, 440, 440.5, -1, 571, false},    {280, 440, 1000, 0, 440.5, true},
        {280, 440, 1000, 0, 439.5, false},    {280, 300, 1000, 0, 360.5, true},
        {280, 300, 1000, 0, 360.3, false},    {280, 1000, 1000, 0, 1001, true},
        {280, 1000.5, 1000, 0, 1001, false},
    };
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        config = ternary_config(COLUMN_HOLDUP_MOLAR);
        for (unsigned j = 0; j < 3; j++) {
            components[j] = test_components[0];
            components[j].antoine[2] = REAL_C(0.0);
            components[j].density[0] = (real_t)cases[i].density;
            components[j].density[1] = (real_t)cases[i].slope;
            components[j].critical_temperature = (real_t)cases[i].critical;
        }
        config.component = components;
        config.temperature_min = (real_t)cases[i].lo;
        config.temperature_max = (real_t)cases[i].hi;
        char message[40];
        snprintf(message, sizeof message, "case %u", i);
        TEST_ASSERT_EQUAL_INT_MESSAGE(cases[i].good ? ERR_OK : ERR_RANGE, try_config(), message);
    }
}

static void numbers_of_stages_and_components_have_the_ranges_that_are_stated(void)
{
    for (unsigned n = 0; n <= COLUMN_STAGES_MAX + 1u; n++) {
        config.stages = n;
        config.feed_stage = 2;
        TEST_ASSERT_EQUAL_INT(n >= 4 && n <= COLUMN_STAGES_MAX ? ERR_OK : ERR_RANGE, try_config());
    }
    config.stages = STAGES;
    for (unsigned n = 0; n <= STAGES + 1u; n++) {
        config.feed_stage = n;
        TEST_ASSERT_EQUAL_INT(n >= 2 && n <= STAGES - 2u ? ERR_OK : ERR_RANGE, try_config());
    }
    config.feed_stage = 4;
    static struct component many[COLUMN_COMPONENTS_MAX + 1];
    for (unsigned n = 0; n <= COLUMN_COMPONENTS_MAX; n++)
        many[n] = test_components[0];
    config.component = many;
    for (unsigned n = 0; n <= COLUMN_COMPONENTS_MAX + 1u; n++) {
        config.components = n;
        TEST_ASSERT_EQUAL_INT(n >= 2 && n <= COLUMN_COMPONENTS_MAX ? ERR_OK : ERR_RANGE,
                              try_config());
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_numbers_of_a_column_are_the_ones_kept);
    RUN_TEST(configs_and_inputs_have_the_ranges_that_are_stated);
    RUN_TEST(temperatures_and_densities_have_the_ranges_that_are_stated);
    RUN_TEST(numbers_of_stages_and_components_have_the_ranges_that_are_stated);
    return UNITY_END();
}
