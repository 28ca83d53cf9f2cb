/* Checks every range of column_validate() and column_validate_inputs(): each setting at its ends, just inside and just outside. */
#include <string.h>

#include "model/column.h"
#include "ranges.h"
#include "test_columns.h"

#define STAGES 10

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
    RUN_TEST(configs_and_inputs_have_the_ranges_that_are_stated);
    RUN_TEST(temperatures_and_densities_have_the_ranges_that_are_stated);
    RUN_TEST(numbers_of_stages_and_components_have_the_ranges_that_are_stated);
    return UNITY_END();
}
