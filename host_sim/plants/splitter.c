/* The industrial C3-C4 splitter (depropaniser) of A. Frau, PhD thesis, Universita degli Studi di Cagliari,
 * XXIII cycle: six components, 185 composition states.
 *
 * The source's own: ethane, propane, isobutane, butane, isopentane and pentane; 37 stages counted upwards
 * (1 kettle reboiler, 2 to 36 valve trays of 2 m diameter, 37 total condenser), feed on stage 19, tray
 * efficiency 0.8, reflux 5 K subcooled, constant liquid volume on every stage, volumetric feed and reflux in
 * m3/h, duty per hour, the feed (88.2 m3/h at 320 K and its composition), both steady states (impurities
 * isobutane in the distillate and propane in the bottoms, reflux, duty), her temperature sensors, and the
 * disturbance scenarios.
 *
 * The thesis leaves out property data, pressures, holdups and the state its volumes are measured at. Ours:
 *   properties      public handbook tables, see splitter_properties.inc; the liquid is taken as ideal
 *   pressure        17 bar in the condenser, where the distillate boils at 322 K, above cooling water, falling
 *                   by 0.252 bar over the column, 7 mbar a tray. From 14 to 17 bar all features are there; the
 *                   published reflux of SS2 comes nearer with rising pressure, its duty goes further off
 *   holdups         0.2 m3 on a tray (2 m diameter under 64 mm of liquid), 4 m3 in the reboiler, 4 m3 in the
 *                   condenser with its drum, at 375 K (bottom) to 322 K (top) linearly: with them the tray
 *                   temperatures settle about as fast as the source says (4 h in the enriching section)
 *   volumes         the feed's is taken at its own temperature, the reflux's at the drum's bubble point less
 *                   the subcooling, both at their own composition: as the stream passes the meter
 *   conservation    the conservative form of the model, where Frau's own closes the balances at rest only (its
 *                   price: when inputs jump far, B can turn negative for a moment, see docs/column-model.md)
 *   feed fractions  the six zXX are divided by their sum, so that each can be moved alone and her second
 *                   scenario, whose steps do not add up to zero, can be run
 *   duty            in Mcal/h, 1 cal = 4.184 J, all of it boiling: V = Q / heat of vaporisation in the reboiler
 *   feed range      up to 345 K, the warmest feed of her scenarios and 5 K more: a feed that flashes on a column
 *                   without boil-up is outside the model, whose tray vapour always starts at the reboiler
 *   speeds, sensors slew of the valves, lag, noise and resolution of the thermometers, tick
 * With these the published reflux and duty cut a little beside the mark, because the distillate is a small
 * difference of large flows. Nominal here is steady state 1 (SS1) at the published reflux, the duty trimmed
 * to 0.02 isobutane in the distillate. tests/unit/test_splitter.c prints what is needed beside what is
 * published for both.
 *
 * Isobutane in distillate and propane in bottoms are truths, not measured: the source has no analyser. */
#include "column_plant.h"

#include <math.h>

extern const struct plant_class plant_splitter;

/* Butane closes the sum: there is some on every stage. */
enum { C2, C3, IC4, IC5, NC5, NC4, COMPONENTS };

static const struct component components[COMPONENTS] = {
#include "splitter_properties.inc"
};

#define STAGES       37
#define M3_PER_H     (1.0 / 3600.0)     /* m3/s */
#define MCAL_PER_H   (4.184e6 / 3600.0) /* W */
#define BAR          1e5                /* Pa */
#define MOL_PER_KMOL 1e3

static const struct column_config config = {
    .stages = STAGES,
    .components = COMPONENTS,
    .feed_stage = 19,
    .component = components,
    .efficiency = 0.8,
    .pressure_drop = 0.252 * BAR,
    .holdup = COLUMN_HOLDUP_CONSERVATIVE,
    .holdup_reboiler = 4.0,
    .holdup_tray = 0.2,
    .holdup_condenser = 4.0,
    .holdup_temperature_bottom = 375.0,
    .holdup_temperature_top = 322.0,
    .temperature_min = 220.0,
    .temperature_max = 440.0,
    .limit_softness = 0.02,
};

enum {
    REFLUX,
    DUTY,
    FEED,
    FEED_T,
    Z_FIRST,
    SUBCOOLING = Z_FIRST + COMPONENTS,
    PRESSURE,
    N_INPUTS,
    T_FIRST = N_INPUTS,
    X_D = T_FIRST + STAGES,
    X_B,
    FLOW_D,
    FLOW_B,
    REFLUX_EFFECTIVE,
    VAPOUR,
    N_CHANNELS
};

/* Stages behind the temperature channels: first those measured, in channel order. */
static const int stage_of[STAGES] = {1,  5,  7,  12, 17, 19, 23, 27, 30, 31, 33, 34, 37,
                                     2,  3,  4,  6,  8,  9,  10, 11, 13, 14, 15, 16, 18,
                                     20, 21, 22, 24, 25, 26, 28, 29, 32, 35, 36};
/* Components behind the feed fractions, in channel order. */
static const int component_of[COMPONENTS] = {C2, C3, IC4, NC4, IC5, NC5};

#define SENSOR(stage)                                                                              \
    {                                                                                              \
        .kind = PLANT_MEASUREMENT, .name = "T" #stage, .unit = "K", .lo = 280.0, .hi = 400.0,      \
        .lag_s = 10.0, .noise = 0.05, .resolution = 0.01, .help = "temperature of stage " #stage   \
    }
#define TRAY(stage)                                                                                \
    {                                                                                              \
        .kind = PLANT_INTERNAL, .name = "T" #stage, .unit = "K", .lo = 280.0, .hi = 400.0,         \
        .help = "temperature of stage " #stage                                                     \
    }
#define FRACTION(n, high, at, text)                                                                \
    {                                                                                              \
        .kind = PLANT_DISTURBANCE, .name = (n), .unit = "-", .lo = 0.0, .hi = (high),              \
        .nominal = (at), .help = text " in the feed, mole fraction (divided by the sum)"           \
    }
#define TRUTH(n, u, high, text)                                                                    \
    {                                                                                              \
        .kind = PLANT_INTERNAL, .name = (n), .unit = (u), .lo = 0.0, .hi = (high), .help = (text)  \
    }

/* clang-format off */
static const struct plant_channel channels[N_CHANNELS] = {
    [REFLUX]     = {.kind = PLANT_MV, .name = "R", .unit = "m3/h", .lo = 0.0, .hi = 120.0, .nominal = 61.62,
                    .safe = 61.62, .slew = 2.0, .help = "reflux flow"},
    [DUTY]       = {.kind = PLANT_MV, .name = "Q", .unit = "Mcal/h", .lo = 0.0, .hi = 6000.0,
                    .nominal = 4143.046, .safe = 0.0, .slew = 50.0, .help = "reboiler duty"},
    [FEED]       = {.kind = PLANT_DISTURBANCE, .name = "F", .unit = "m3/h", .lo = 0.0, .hi = 150.0,
                    .nominal = 88.2, .help = "feed flow"},
    [FEED_T]     = {.kind = PLANT_DISTURBANCE, .name = "TF", .unit = "K", .lo = 280.0, .hi = 345.0,
                    .nominal = 320.0, .help = "feed temperature"},
    [Z_FIRST]     = FRACTION("zC2", 0.1, 0.0036, "ethane"),
    [Z_FIRST + 1] = FRACTION("zC3", 1.0, 0.281, "propane"),
    [Z_FIRST + 2] = FRACTION("ziC4", 1.0, 0.236, "isobutane"),
    [Z_FIRST + 3] = FRACTION("znC4", 1.0, 0.4746, "butane"),
    [Z_FIRST + 4] = FRACTION("ziC5", 1.0, 0.004, "isopentane"),
    [Z_FIRST + 5] = FRACTION("znC5", 1.0, 0.0008, "pentane"),
    [SUBCOOLING] = {.kind = PLANT_DISTURBANCE, .name = "dTr", .unit = "K", .lo = 0.0, .hi = 30.0,
                    .nominal = 5.0, .help = "reflux subcooling below its bubble point"},
    [PRESSURE]   = {.kind = PLANT_DISTURBANCE, .name = "P", .unit = "bar", .lo = 14.0, .hi = 18.0,
                    .nominal = 17.0, .help = "pressure in the condenser"},
    [T_FIRST]      = SENSOR(1),  [T_FIRST + 1]  = SENSOR(5),  [T_FIRST + 2]  = SENSOR(7),
    [T_FIRST + 3]  = SENSOR(12), [T_FIRST + 4]  = SENSOR(17), [T_FIRST + 5]  = SENSOR(19),
    [T_FIRST + 6]  = SENSOR(23), [T_FIRST + 7]  = SENSOR(27), [T_FIRST + 8]  = SENSOR(30),
    [T_FIRST + 9]  = SENSOR(31), [T_FIRST + 10] = SENSOR(33), [T_FIRST + 11] = SENSOR(34),
    [T_FIRST + 12] = SENSOR(37),
    [T_FIRST + 13] = TRAY(2),  [T_FIRST + 14] = TRAY(3),  [T_FIRST + 15] = TRAY(4),
    [T_FIRST + 16] = TRAY(6),  [T_FIRST + 17] = TRAY(8),  [T_FIRST + 18] = TRAY(9),
    [T_FIRST + 19] = TRAY(10), [T_FIRST + 20] = TRAY(11), [T_FIRST + 21] = TRAY(13),
    [T_FIRST + 22] = TRAY(14), [T_FIRST + 23] = TRAY(15), [T_FIRST + 24] = TRAY(16),
    [T_FIRST + 25] = TRAY(18), [T_FIRST + 26] = TRAY(20), [T_FIRST + 27] = TRAY(21),
    [T_FIRST + 28] = TRAY(22), [T_FIRST + 29] = TRAY(24), [T_FIRST + 30] = TRAY(25),
    [T_FIRST + 31] = TRAY(26), [T_FIRST + 32] = TRAY(28), [T_FIRST + 33] = TRAY(29),
    [T_FIRST + 34] = TRAY(32), [T_FIRST + 35] = TRAY(35), [T_FIRST + 36] = TRAY(36),
    [X_D]              = TRUTH("iC4_D", "-", 1.0, "isobutane in the distillate, mole fraction"),
    [X_B]              = TRUTH("C3_B", "-", 1.0, "propane in the bottoms, mole fraction"),
    [FLOW_D]           = TRUTH("D", "kmol/h", 1500.0, "distillate flow"),
    [FLOW_B]           = TRUTH("B", "kmol/h", 1500.0, "bottoms flow"),
    [REFLUX_EFFECTIVE] = TRUTH("R_eff", "m3/h", 120.0, "reflux the condenser could supply"),
    [VAPOUR]           = TRUTH("V", "kmol/h", 3000.0, "vapour leaving the reboiler"),
};
/* clang-format on */

static const char *inputs_of(const double *u, struct column_inputs *in)
{
    double sum = 0.0;

    *in = (struct column_inputs){
        .feed_basis = COLUMN_FLOW_VOLUME,
        .feed_flow = u[FEED] * M3_PER_H,
        .feed_temperature = u[FEED_T],
        .reflux_basis = COLUMN_FLOW_VOLUME,
        .reflux_flow = u[REFLUX] * M3_PER_H,
        .reflux_subcooling = u[SUBCOOLING],
        .heat = u[DUTY] * MCAL_PER_H,
        .pressure_top = u[PRESSURE] * BAR,
    };
    for (size_t j = 0; j < COMPONENTS; j++)
        sum += u[Z_FIRST + j];
    if (!(sum >= 0.1))
        return "leaves feed fractions that add up to less than 0.1";
    for (size_t j = 0; j < COMPONENTS; j++)
        in->feed_fraction[component_of[j]] = u[Z_FIRST + j] / sum;
    return NULL;
}

/* The reflux flowing, m3/h at its own state. */
static double reflux_volume(const struct column *c, const double *x, double subcooling)
{
    double full[COMPONENTS];

    for (size_t j = 0; j < COMPONENTS; j++)
        full[j] = column_fraction(c, x, STAGES - 1, j);
    return c->flows.reflux / M3_PER_H *
           mixture_molar_volume(components, COMPONENTS, full,
                                c->temperature[STAGES - 1] - subcooling);
}

static double value_of(const struct column *c, const double *x, const double *u, size_t channel)
{
    const double kmol_per_h = 3600.0 / MOL_PER_KMOL;

    if (channel < X_D)
        return c->temperature[stage_of[channel - T_FIRST] - 1];
    switch (channel) {
    case X_D:
        return column_fraction(c, x, STAGES - 1, IC4);
    case X_B:
        return column_fraction(c, x, 0, C3);
    case FLOW_D:
        return c->flows.distillate * kmol_per_h;
    case FLOW_B:
        return c->flows.bottoms * kmol_per_h;
    case REFLUX_EFFECTIVE:
        return reflux_volume(c, x, u[SUBCOOLING]);
    case VAPOUR:
        return c->flows.vapour_stripping * kmol_per_h;
    default:
        return NAN;
    }
}

static const struct plant_states states = COLUMN_PLANT_STATES(
    "mole fraction of C2, C3, iC4, iC5, nC5 (nC4 by closure), stage by stage, reboiler first");

static const struct column_plant about = {
    .class = &plant_splitter,
    .config = &config,
    .n_inputs = N_INPUTS,
    .inputs_of = inputs_of,
    .value = value_of,
};

static struct plant *create(char *err, size_t err_size)
{
    return column_plant_create(&about, err, err_size);
}

const struct plant_class plant_splitter = {
    .name = "splitter",
    .title = "industrial six-component C3-C4 splitter, 37 stages",
    .source = "Frau, thesis, Cagliari: stages, feed, efficiency, subcooling, both steady states, "
              "scenarios",
    .ours =
        "handbook property data, pressures, holdups, states of the volumetric flows, actuators and "
        "sensors; duty trimmed to the published impurity",
    .tick_s = 30.0,
    .channels = channels,
    .n_channels = N_CHANNELS,
    .create = create,
    COLUMN_PLANT_HOOKS,
    .states = &states,
};
