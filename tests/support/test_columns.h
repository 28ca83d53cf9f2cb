/* Columns the model's tests share, in whichever scalar type the test is built with. */
#ifndef REFLUX_TESTS_TEST_COLUMNS_H
#define REFLUX_TESTS_TEST_COLUMNS_H

#include "model/column.h"

/* TCE, PCE, and a made-up heavier homologue of PCE (its Antoine C lowered by 20 K), as in
 * tests/reference/pilot_reference.py. */
static const struct component test_components[3] = {
    {.name = "TCE",
     .antoine = {REAL_C(21.354957), REAL_C(3177.86676), REAL_C(-36.672)},
     .molar_mass = REAL_C(0.13138834),
     .density = {REAL_C(1991.141), REAL_C(-1.789634)},
     .vaporisation_heat = 31400,
     .boiling_point = REAL_C(360.36),
     .critical_temperature = REAL_C(571.05),
     .heat_capacity = REAL_C(124.4)},
    {.name = "PCE",
     .antoine = {REAL_C(20.9891453), REAL_C(3211.7424), REAL_C(-54.787)},
     .molar_mass = REAL_C(0.1658334),
     .density = {REAL_C(2111.059), REAL_C(-1.66525)},
     .vaporisation_heat = 34680,
     .boiling_point = REAL_C(394.45),
     .critical_temperature = REAL_C(620.05),
     .heat_capacity = REAL_C(143.4)},
    {.name = "heavy",
     .antoine = {REAL_C(20.9891453), REAL_C(3211.7424), REAL_C(-74.787)},
     .molar_mass = REAL_C(0.1658334),
     .density = {REAL_C(2111.059), REAL_C(-1.66525)},
     .vaporisation_heat = 34680,
     .boiling_point = REAL_C(394.45),
     .critical_temperature = REAL_C(620.05),
     .heat_capacity = REAL_C(143.4)},
};

/* Ten stages, three components, feed on stage 4, efficiency 0.7. */
static inline struct column_config ternary_config(enum column_holdup holdup)
{
    struct column_config config = {
        .stages = 10,
        .components = 3,
        .feed_stage = 4,
        .component = test_components,
        .efficiency = REAL_C(0.7),
        .pressure_drop = 3000,
        .holdup = holdup,
        .holdup_reboiler = holdup == COLUMN_HOLDUP_MOLAR ? REAL_C(8.0) : REAL_C(1e-3),
        .holdup_tray = holdup == COLUMN_HOLDUP_MOLAR ? REAL_C(0.3) : REAL_C(3e-5),
        .holdup_condenser = holdup == COLUMN_HOLDUP_MOLAR ? REAL_C(1.5) : REAL_C(1.5e-4),
        .holdup_temperature_bottom = 380,
        .holdup_temperature_top = 360,
        .temperature_min = 280,
        .temperature_max = 440,
        .limit_softness = REAL_C(0.02),
    };
    return config;
}

static inline struct column_inputs ternary_inputs(void)
{
    struct column_inputs inputs = {
        .feed_basis = COLUMN_FLOW_VOLUME,
        .feed_flow = REAL_C(1.5e-6),
        .feed_fraction = {REAL_C(0.3), REAL_C(0.45), REAL_C(0.25)},
        .feed_temperature = 335,
        .reflux_basis = COLUMN_FLOW_VOLUME,
        .reflux_flow = REAL_C(1.1e-6),
        .reflux_subcooling = 8,
        .heat = 700,
        .pressure_top = REAL_C(1e5),
    };
    return inputs;
}

/* A smooth profile inside the simplex, different on every stage. */
static inline void ternary_profile(real_t *x, real_t tilt)
{
    for (int s = 0; s < 10; s++) {
        real_t up = (real_t)s / REAL_C(9.0);
        x[2 * s] = REAL_C(0.1) + REAL_C(0.7) * up + tilt * up * (REAL_C(1.0) - up);
        x[2 * s + 1] = REAL_C(0.6) - REAL_C(0.45) * up;
    }
}

#endif
