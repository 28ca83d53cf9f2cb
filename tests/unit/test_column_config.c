/* Every wrong field of a column's config and inputs is named, with the range it must be in. */
#include "model/column.h"
#include "test_columns.h"
#include "unity.h"

static struct column_config config;
static struct column_inputs inputs;
static struct component components[3];
static struct column column;
static struct column_fault fault;

void setUp(void)
{
    config = ternary_config(COLUMN_HOLDUP_VOLUMETRIC);
    inputs = ternary_inputs();
    for (int j = 0; j < 3; j++)
        components[j] = test_components[j];
    config.component = components;
}

void tearDown(void) {}

static void refused(enum err code, const char *field, const char *wanted)
{
    TEST_ASSERT_EQUAL(code, column_validate(&config, &fault));
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_EQUAL_STRING(wanted, fault.wanted);
    struct column before = column;
    TEST_ASSERT_EQUAL(code, column_init(&column, &config, &fault));
    TEST_ASSERT_EQUAL_MEMORY(&before, &column, sizeof column);
    setUp();
}

static void a_sound_config_is_accepted(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, column_validate(&config, &fault));
    TEST_ASSERT_EQUAL_STRING("", fault.field);
}

static void sizes_out_of_range_are_named(void)
{
    config.stages = 3;
    refused(ERR_RANGE, "stages", "4 to 200");
    config.stages = 201;
    refused(ERR_RANGE, "stages", "4 to 200");
    config.components = 1;
    refused(ERR_RANGE, "components", "2 to 10");
    config.feed_stage = 1;
    refused(ERR_RANGE, "feed_stage", "2 to stages - 2");
    config.feed_stage = 9;
    refused(ERR_RANGE, "feed_stage", "2 to stages - 2");
    config.component = NULL;
    refused(ERR_RANGE, "component", "an array of as many entries as components says");
}

static void numbers_out_of_range_are_named(void)
{
    config.efficiency = 0;
    refused(ERR_RANGE, "efficiency", "0.01 to 1");
    config.efficiency = 1.01;
    refused(ERR_RANGE, "efficiency", "0.01 to 1");
    config.pressure_drop = -1;
    refused(ERR_RANGE, "pressure_drop", "0 to 1e7 Pa");
    config.holdup = (enum column_holdup)3;
    refused(ERR_RANGE, "holdup", "one of enum column_holdup");
    config.holdup_reboiler = 0;
    refused(ERR_RANGE, "holdup_reboiler", "above 0");
    config.holdup_tray = -1;
    refused(ERR_RANGE, "holdup_tray", "above 0");
    config.holdup_condenser = 0;
    refused(ERR_RANGE, "holdup_condenser", "above 0");
    config.temperature_min = 10;
    refused(ERR_RANGE, "temperature_min", "50 to 1000 K");
    config.temperature_max = config.temperature_min;
    refused(ERR_RANGE, "temperature_max", "temperature_min + 1 to 1000 K");
    config.holdup_temperature_bottom = 0;
    refused(ERR_RANGE, "holdup_temperature_bottom", "temperature_min to temperature_max");
    config.holdup_temperature_top = 1000;
    refused(ERR_RANGE, "holdup_temperature_top", "temperature_min to temperature_max");
    config.limit_softness = 0;
    refused(ERR_RANGE, "limit_softness", "0.001 to 0.5");
}

static void numbers_that_are_none_are_named(void)
{
    config.efficiency = NAN;
    refused(ERR_NOT_FINITE, "efficiency", "0.01 to 1");
    config.holdup_tray = INFINITY;
    refused(ERR_NOT_FINITE, "holdup_tray", "above 0");
    components[1].antoine[1] = NAN;
    refused(ERR_NOT_FINITE, "component.antoine", "finite constants");
    components[2].critical_temperature = NAN;
    refused(ERR_RANGE, "component.critical_temperature", "above boiling_point and temperature_max");
}

static void wrong_component_data_is_named(void)
{
    components[0].antoine[2] = -300;
    refused(ERR_RANGE, "component.antoine", "C + T above 0 from temperature_min on");
    components[2].molar_mass = 0;
    refused(ERR_RANGE, "component.molar_mass", "1e-4 to 10 kg/mol");
    components[1].density[1] = -6;
    refused(ERR_RANGE, "component.density",
            "1 to 30000 kg/m3 from temperature_min to temperature_max");
    components[1].vaporisation_heat = 0;
    refused(ERR_RANGE, "component.vaporisation_heat", "1 to 1e6 J/mol");
    components[1].boiling_point = -1;
    refused(ERR_RANGE, "component.boiling_point", "1 to 2000 K");
    components[0].critical_temperature = 430;
    refused(ERR_RANGE, "component.critical_temperature", "above boiling_point and temperature_max");
    components[0].heat_capacity = 0;
    refused(ERR_RANGE, "component.heat_capacity", "1 to 1e5 J/(mol K)");
}

static void check_inputs(const struct column_inputs *bad, enum err code, const char *field,
                         const char *wanted)
{
    TEST_ASSERT_EQUAL(ERR_OK, column_init(&column, &config, &fault));
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
    TEST_ASSERT_EQUAL(code, column_set_inputs(&column, bad, &fault));
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_EQUAL_STRING(wanted, fault.wanted);
    TEST_ASSERT_EQUAL_MEMORY(&inputs, &column.inputs, sizeof inputs);
}

static void wrong_inputs_are_named_and_the_old_ones_kept(void)
{
    struct column_inputs bad;

    bad = inputs, bad.feed_flow = -1;
    check_inputs(&bad, ERR_RANGE, "feed_flow", "0 or more");
    bad = inputs, bad.feed_temperature = NAN;
    check_inputs(&bad, ERR_NOT_FINITE, "feed_temperature", "temperature_min to temperature_max");
    bad = inputs, bad.reflux_flow = INFINITY;
    check_inputs(&bad, ERR_NOT_FINITE, "reflux_flow", "0 or more");
    bad = inputs, bad.reflux_subcooling = 101;
    check_inputs(&bad, ERR_RANGE, "reflux_subcooling", "0 to 100 K");
    bad = inputs, bad.heat = -1;
    check_inputs(&bad, ERR_RANGE, "heat", "0 or more");
    bad = inputs, bad.pressure_top = 0;
    check_inputs(&bad, ERR_RANGE, "pressure_top", "100 to 1e7 Pa");
    bad = inputs, bad.feed_fraction[1] = -0.1;
    check_inputs(&bad, ERR_RANGE, "feed_fraction", "0 to 1 each");
    bad = inputs, bad.feed_fraction[1] = 0.5;
    check_inputs(&bad, ERR_RANGE, "feed_fraction", "a sum of 1 within 1e-3");
    bad = inputs, bad.feed_basis = (enum column_basis)7;
    check_inputs(&bad, ERR_RANGE, "feed_basis", "one of enum column_basis");
    bad = inputs, bad.reflux_basis = (enum column_basis)7;
    check_inputs(&bad, ERR_RANGE, "reflux_basis", "one of enum column_basis");
}

static void the_same_flow_may_be_given_in_moles_mass_or_volume(void)
{
    real_t x[20], reference = 0;
    ternary_profile(x, 0);
    TEST_ASSERT_EQUAL(ERR_OK, column_init(&column, &config, &fault));
    for (int basis = COLUMN_FLOW_MOLAR; basis <= COLUMN_FLOW_VOLUME; basis++) {
        double volume = mixture_molar_volume(components, 3, inputs.feed_fraction, 335);
        double mass = mixture_molar_mass(components, 3, inputs.feed_fraction);
        inputs.feed_basis = (enum column_basis)basis;
        inputs.feed_flow = 0.01 * (basis == COLUMN_FLOW_MOLAR  ? 1.0
                                   : basis == COLUMN_FLOW_MASS ? mass
                                                               : volume);
        TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
        TEST_ASSERT_EQUAL(ERR_OK, column_evaluate(&column, x));
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.01, column.flows.feed);
    }

    /* Reflux: the composition and temperature of the drum count. */
    double full[3] = {x[18], x[19], 1 - x[18] - x[19]};
    reference = column.flows.reflux_wanted;
    inputs.reflux_basis = COLUMN_FLOW_MASS;
    inputs.reflux_flow = reference * mixture_molar_mass(components, 3, full);
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
    TEST_ASSERT_EQUAL(ERR_OK, column_evaluate(&column, x));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12 * reference, reference, column.flows.reflux_wanted);
}

static void mass_and_mole_fractions_turn_into_each_other(void)
{
    double w[3] = {20, 50, 30}, x[3];
    mole_from_mass_fractions(components, 3, w, x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 1, x[0] + x[1] + x[2]);
    for (size_t j = 0; j < 3; j++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, w[j] / 100, mass_fraction_of(components, 3, x, j));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_sound_config_is_accepted);
    RUN_TEST(sizes_out_of_range_are_named);
    RUN_TEST(numbers_out_of_range_are_named);
    RUN_TEST(numbers_that_are_none_are_named);
    RUN_TEST(wrong_component_data_is_named);
    RUN_TEST(wrong_inputs_are_named_and_the_old_ones_kept);
    RUN_TEST(the_same_flow_may_be_given_in_moles_mass_or_volume);
    RUN_TEST(mass_and_mole_fractions_turn_into_each_other);
    return UNITY_END();
}
