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
    refused(ERR_RANGE, "component.molar_mass", "1e-4 to 10 kg/mol: a mass or a volume needs it");
    components[2].molar_mass = 11;
    refused(ERR_RANGE, "component.molar_mass", "1e-4 to 10 kg/mol");
    components[1].density[1] = -6;
    refused(ERR_RANGE, "component.density",
            "1 to 30000 kg/m3 from temperature_min to temperature_max");
    components[1].vaporisation_heat = REAL_C(0.5);
    refused(ERR_RANGE, "component.vaporisation_heat", "1 to 1e6 J/mol");
    components[1].boiling_point = -1;
    refused(ERR_RANGE, "component.boiling_point", "1 to 2000 K");
    components[0].critical_temperature = 430;
    refused(ERR_RANGE, "component.critical_temperature", "above boiling_point and temperature_max");
    components[0].heat_capacity = REAL_C(0.5);
    refused(ERR_RANGE, "component.heat_capacity", "1 to 1e5 J/(mol K)");
}

static void a_property_that_is_not_given_is_named_where_something_needs_it(void)
{
    static const struct {
        size_t offset;
        const char *name, *mass, *volume, *holdup, *heat, *boilup, *temperature, *subcooling;
    } properties[] = {
#define HEATS    "heat, the feed's temperature or the reflux's subcooling needs it"
#define CAPACITY "1 to 1e5 J/(mol K): the feed's temperature or the reflux's subcooling needs it"
        {offsetof(struct component, molar_mass), "component.molar_mass",
         "1e-4 to 10 kg/mol: a mass or a volume needs it",
         "1e-4 to 10 kg/mol: a mass or a volume needs it",
         "1e-4 to 10 kg/mol: a mass or a volume needs it", NULL, NULL, NULL, NULL},
        {offsetof(struct component, density), "component.density", NULL,
         "1 to 30000 kg/m3: a volume needs it", "1 to 30000 kg/m3: a volume needs it", NULL, NULL,
         NULL, NULL},
        {offsetof(struct component, vaporisation_heat), "component.vaporisation_heat", NULL, NULL,
         NULL, "1 to 1e6 J/mol: " HEATS, NULL, "1 to 1e6 J/mol: " HEATS, "1 to 1e6 J/mol: " HEATS},
        {offsetof(struct component, boiling_point), "component.boiling_point", NULL, NULL, NULL,
         "1 to 2000 K: the heat of vaporisation needs it", NULL,
         "1 to 2000 K: the heat of vaporisation needs it",
         "1 to 2000 K: the heat of vaporisation needs it"},
        {offsetof(struct component, critical_temperature), "component.critical_temperature", NULL,
         NULL, NULL, "above temperature_max: the heat of vaporisation needs it", NULL,
         "above temperature_max: the heat of vaporisation needs it",
         "above temperature_max: the heat of vaporisation needs it"},
        {offsetof(struct component, heat_capacity), "component.heat_capacity", NULL, NULL, NULL,
         NULL, NULL, CAPACITY, CAPACITY},
    };
    for (size_t i = 0; i < sizeof properties / sizeof properties[0]; i++) {
        struct column_inputs base = ternary_inputs();
        base.feed_basis = base.reflux_basis = COLUMN_FLOW_MOLAR;
        base.feed_state = COLUMN_FEED_QUALITY;
        base.feed_quality = 1;
        base.feed_temperature = NAN; /* not used */
        base.reflux_subcooling = 0;
        base.boilup_given = true;
        base.heat = NAN; /* not used */
        struct column_inputs tried[6] = {base, base, base, base, base, base};
        tried[0].reflux_basis = COLUMN_FLOW_MASS;
        tried[1].reflux_basis = COLUMN_FLOW_VOLUME;
        tried[2].boilup_given = false;
        tried[2].heat = 0;
        tried[4].feed_state = COLUMN_FEED_TEMPERATURE;
        tried[4].feed_temperature = 335;
        tried[5].reflux_subcooling = 1;
        const char *wanted[6] = {properties[i].mass,        properties[i].volume,
                                 properties[i].heat,        properties[i].boilup,
                                 properties[i].temperature, properties[i].subcooling};
        *(real_t *)((char *)&components[1] + properties[i].offset) = 0;
        if (i == 1)
            components[1].density[1] = 0;
        enum err code = column_validate(&config, &fault);
        TEST_ASSERT_EQUAL(properties[i].holdup ? ERR_RANGE : ERR_OK, code);
        TEST_ASSERT_EQUAL_STRING(properties[i].holdup ? properties[i].holdup : "", fault.wanted);
        config.holdup = COLUMN_HOLDUP_MOLAR;
        TEST_ASSERT_EQUAL(ERR_OK, column_validate(&config, &fault));
        for (size_t k = 0; k < 6; k++) {
            code = column_validate_inputs(&config, &tried[k], &fault);
            TEST_ASSERT_EQUAL(wanted[k] ? ERR_RANGE : ERR_OK, code);
            TEST_ASSERT_EQUAL_STRING(wanted[k] ? properties[i].name : "", fault.field);
            TEST_ASSERT_EQUAL_STRING(wanted[k] ? wanted[k] : "", fault.wanted);
        }
        setUp();
    }
}

static void wrong_levels_and_hydraulics_are_named(void)
{
    config.holdup = COLUMN_HOLDUP_MOLAR;
    const struct column_config molar = config;
#define REFUSED(field, value, name, wanted)                                                        \
    config.field = (value);                                                                        \
    refused(ERR_RANGE, name, wanted);                                                              \
    config = molar;                                                                                \
    config.levels = COLUMN_LEVELS_HOLDUPS;                                                         \
    config.level_capacity = 2;                                                                     \
    config.hydraulic_time = 3
    REFUSED(hydraulic_time, -1, "hydraulic_time", "0, or 0.001 to 1e6 s");
    REFUSED(hydraulic_time, REAL_C(0.0001), "hydraulic_time", "0, or 0.001 to 1e6 s");
    REFUSED(hydraulic_vapour, 6, "hydraulic_vapour", "-5 to 5");
    REFUSED(levels, (enum column_levels)2, "levels", "one of enum column_levels");
    REFUSED(condenser_level.by, (enum column_level_by)3, "condenser_level.by",
            "one of enum column_level_by");
    REFUSED(reboiler_level.by, COLUMN_LEVEL_BY_PRODUCT, "reboiler_level.gain",
            "above 0, to 1000 1/s");
    REFUSED(condenser_level.by, COLUMN_LEVEL_BY_INTERNAL, "condenser_level.gain",
            "above 0, to 1000 1/s");
    REFUSED(level_capacity, 1, "level_capacity", "above 1, at most 10");
    REFUSED(level_capacity, 11, "level_capacity", "above 1, at most 10");
    TEST_ASSERT_EQUAL(ERR_OK, column_validate(&config, &fault));
    REFUSED(holdup, COLUMN_HOLDUP_CONSERVATIVE, "hydraulic_time", "0 unless the holdup is molar");
    config.hydraulic_time = 0;
    config.holdup = COLUMN_HOLDUP_VOLUMETRIC;
    refused(ERR_RANGE, "levels", "perfect unless the holdup is molar");
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
    bad = inputs, bad.boilup_given = true, bad.boilup = -1;
    check_inputs(&bad, ERR_RANGE, "boilup", "0 or more");
    bad = inputs, bad.feed_state = (enum column_feed_state)2;
    check_inputs(&bad, ERR_RANGE, "feed_state", "one of enum column_feed_state");
    bad = inputs, bad.feed_state = COLUMN_FEED_QUALITY, bad.feed_quality = REAL_C(2.1);
    check_inputs(&bad, ERR_RANGE, "feed_quality", "0 to 2");
    bad = inputs, bad.feed_state = COLUMN_FEED_QUALITY;
    check_inputs(&bad, ERR_RANGE, "feed_basis",
                 "moles or mass: a feed with a quality has no volume");
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
    RUN_TEST(a_property_that_is_not_given_is_named_where_something_needs_it);
    RUN_TEST(wrong_levels_and_hydraulics_are_named);
    RUN_TEST(wrong_inputs_are_named_and_the_old_ones_kept);
    RUN_TEST(the_same_flow_may_be_given_in_moles_mass_or_volume);
    RUN_TEST(mass_and_mole_fractions_turn_into_each_other);
    return UNITY_END();
}
