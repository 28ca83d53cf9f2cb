/* Columns of constant relative volatility with everything that moves: drum, reboiler and trays. */
#ifndef REFLUX_TESTS_HOLDUP_COLUMNS_H
#define REFLUX_TESTS_HOLDUP_COLUMNS_H

#include "model/activity.h"

#define HOLDUP_STAGES ((size_t)12)

/* Volatilities 4, 2 and 1 of a liquid that boils at about 353 K, and heats that are the same at all temperatures. */
#define HOLDUP_COMPONENT(its_name, a)                                                              \
    {                                                                                              \
        .name = (its_name), .antoine = {(a), REAL_C(3200.0), REAL_C(-48.0)},                       \
        .vaporisation_heat = 30000, .boiling_point = 350, .critical_temperature = REAL_C(1e12),    \
        .heat_capacity = 150                                                                       \
    }
static const struct component volatile_components[3] = {
    HOLDUP_COMPONENT("light", REAL_C(22.0702943611)),
    HOLDUP_COMPONENT("middle", REAL_C(21.3771471806)),
    HOLDUP_COMPONENT("heavy", REAL_C(20.684)),
};

static const real_t interaction_a[9] = {
    0, REAL_C(0.4), REAL_C(-0.3), REAL_C(-0.7), 0, REAL_C(0.25), REAL_C(0.15), REAL_C(-0.5), 0};
static const real_t interaction_b[9] = {0, -250, 120, 80, 0, -180, -90, 140, 0};
static const real_t interaction_alpha[9] = {
    0, REAL_C(0.3), REAL_C(0.25), REAL_C(0.3), 0, REAL_C(0.4), REAL_C(0.25), REAL_C(0.4), 0};
static const struct activity wilson_tables = {ACTIVITY_WILSON, 3, interaction_a, interaction_b,
                                              NULL};
static const struct activity nrtl_tables = {ACTIVITY_NRTL, 3, interaction_a, interaction_b,
                                            interaction_alpha};

static inline void make_nonideal(struct column_config *config, const struct activity *tables)
{
    config->activity = activity_coefficients;
    config->activity_context = (void *)tables; /* it only reads them */
}

static inline struct column_config holdup_config(enum column_level_by condenser,
                                                 enum column_level_by reboiler)
{
    struct column_config config = {
        .stages = HOLDUP_STAGES,
        .components = 3,
        .feed_stage = 5,
        .component = volatile_components,
        .efficiency = REAL_C(0.8),
        .pressure_drop = 4000,
        .holdup = COLUMN_HOLDUP_MOLAR,
        .holdup_reboiler = 300,
        .holdup_tray = 12,
        .holdup_condenser = 200,
        .temperature_min = 280,
        .temperature_max = 440,
        .limit_softness = REAL_C(0.02),
        .hydraulic_time = 4,
        .hydraulic_vapour = REAL_C(0.3),
        .levels = COLUMN_LEVELS_HOLDUPS,
        .condenser_level = {condenser, condenser == COLUMN_LEVEL_FREE ? 0 : REAL_C(0.03)},
        .reboiler_level = {reboiler, reboiler == COLUMN_LEVEL_FREE ? 0 : REAL_C(0.02)},
        .level_capacity = 2,
    };
    return config;
}

static inline struct column_inputs holdup_inputs(void)
{
    struct column_inputs inputs = {
        .feed_flow = 1,
        .feed_fraction = {REAL_C(0.3), REAL_C(0.4), REAL_C(0.3)},
        .feed_state = COLUMN_FEED_QUALITY,
        .feed_quality = REAL_C(0.9),
        .reflux_flow = REAL_C(1.6),
        .boilup_given = true,
        .boilup = REAL_C(2.0),
        .pressure_top = REAL_C(1e5),
    };
    return inputs;
}

#endif
