/* The pilot column: 10 trays, trichloroethylene (TCE) and tetrachloroethylene (PCE), of T. O. Folami,
 * PhD thesis, University of Aston in Birmingham, 1989, volume 2.
 *
 * The source's own: the mixture, 10 trays counted from the top, reboiler and reflux drum as two more
 * stages (12 states), 90 % tray efficiency, constant molar holdup, adiabatic column, reflux Lr in l/h and
 * reboiler heat Qrb in kW as manipulated variables, heater used at 0.7 to 1.25 kW, feed of 30/70 to 50/50 %
 * by weight, control interval 30 s, temperatures of trays 1, 2, 7, 9, 10, and the gains of T1 and T10 to
 * Lr and Qrb, [-0.5 3.56; -9.53 80.77] degC per l/h and per kW.
 *
 * Its dimensions, flows and property data are lost (they stood in volume 1). Ours, chosen so that every
 * gain is met within a factor 1.2:
 *   properties      public handbook tables, see pilot_properties.inc; the liquid is taken as ideal
 *   feed            5.0 l/h at 36 % by weight and 60 degC, onto tray 7
 *   reflux          4.5 l/h, 5 K below its bubble point
 *   heat            0.80 kW, of which 0.15 kW is lost from the reboiler to its surroundings
 *   pressure        760 mmHg in the condenser, 1000 Pa (7.5 mmHg) more in the reboiler: ten sieve trays
 *   tray            25 ml of liquid: a tray of about 50 mm diameter under 13 mm of liquid, the size that
 *                   the vapour of this heater (0.6 l/s) asks for; tray time constants come out at about 3 s,
 *                   where the source has 2 to 4 s
 *   reboiler        1.5 l, which sets the slow time constant (about 21 min)
 *   reflux drum     0.15 l
 * Volumes are turned into constant molar holdups at the densities of the nominal profile's ends.
 *
 * At the limits (see struct column_flows): with the heater off no vapour rises, the wanted reflux is cut
 * to nothing, the trays above the feed keep their liquid and the feed runs down into the reboiler and out
 * of the bottom. Reflux beyond what the condenser makes is cut (total reflux, D = 0); boil-up beyond what
 * reflux and feed can supply is cut (B = 0: the heater is then partly uncovered). Lr_eff and V show it. */
#include "column_plant.h"

#include <math.h>

extern const struct plant_class plant_pilot;

static const struct component components[2] = {
#include "pilot_properties.inc"
};

#define TRAYS              10
#define STAGES             (TRAYS + 2)
#define FEED_TRAY          7
#define KELVIN             273.15
#define MMHG               133.322
#define L_PER_H            (1e-3 / 3600.0) /* m3/s */
#define STAGE(k)           (STAGES - 1 - (k)) /* index of tray k, counted from the top, in the column */
#define MOL_PER_L_REBOILER 9.1  /* molar density of the liquid at about 110 degC and 20 % */
#define MOL_PER_L_TRAY     9.7  /* likewise at about 95 degC and 60 % */
#define MOL_PER_L_DRUM     10.3 /* likewise at about 85 degC and pure TCE */

static const struct column_config config = {
    .stages = STAGES,
    .components = 2,
    .feed_stage = STAGE(FEED_TRAY) + 1,
    .component = components,
    .efficiency = 0.9,
    .pressure_drop = 1000.0,
    .holdup = COLUMN_HOLDUP_MOLAR,
    .holdup_reboiler = 1.5 * MOL_PER_L_REBOILER,
    .holdup_tray = 0.025 * MOL_PER_L_TRAY,
    .holdup_condenser = 0.15 * MOL_PER_L_DRUM,
    .temperature_min = 280.0,
    .temperature_max = 430.0,
    .limit_softness = 0.02,
};

enum {
    LR,
    QRB,
    FEED,
    FEED_TCE,
    FEED_T,
    SUBCOOLING,
    LOSS,
    PRESSURE,
    N_INPUTS,
    FIRST_MEASUREMENT = N_INPUTS,
    FIRST_INTERNAL_TRAY = FIRST_MEASUREMENT + 5,
    REBOILER_T = FIRST_INTERNAL_TRAY + 5,
    X_D,
    X_B,
    FLOW_D,
    FLOW_B,
    REFLUX_EFFECTIVE,
    VAPOUR,
    N_CHANNELS
};

/* Trays behind the temperature channels, in channel order. */
static const int tray_of[10] = {1, 2, 7, 9, 10, 3, 4, 5, 6, 8};

#define SENSOR(tray, text)                                                                         \
    {                                                                                              \
        .kind = PLANT_MEASUREMENT, .name = "T" #tray, .unit = "degC", .lo = 70.0, .hi = 130.0,     \
        .lag_s = 5.0, .noise = 0.05, .resolution = 0.01, .help = (text)                            \
    }
#define TRUTH(n, u, low, high, text)                                                               \
    {                                                                                              \
        .kind = PLANT_INTERNAL, .name = (n), .unit = (u), .lo = (low), .hi = (high),               \
        .help = (text)                                                                             \
    }

/* clang-format off */
static const struct plant_channel channels[N_CHANNELS] = {
    [LR]         = {.kind = PLANT_MV, .name = "Lr", .unit = "l/h", .lo = 0.0, .hi = 12.0, .nominal = 4.5,
                    .safe = 4.5, .slew = 1.0, .help = "reflux flow"},
    [QRB]        = {.kind = PLANT_MV, .name = "Qrb", .unit = "kW", .lo = 0.0, .hi = 1.5, .nominal = 0.8,
                    .safe = 0.0, .slew = 0.25, .help = "reboiler heat"},
    [FEED]       = {.kind = PLANT_DISTURBANCE, .name = "F", .unit = "l/h", .lo = 0.0, .hi = 10.0,
                    .nominal = 5.0, .help = "feed flow"},
    [FEED_TCE]   = {.kind = PLANT_DISTURBANCE, .name = "xF", .unit = "%w", .lo = 0.0, .hi = 100.0,
                    .nominal = 36.0, .help = "trichloroethylene in the feed, by weight"},
    [FEED_T]     = {.kind = PLANT_DISTURBANCE, .name = "TF", .unit = "degC", .lo = 10.0, .hi = 120.0,
                    .nominal = 60.0, .help = "feed temperature"},
    [SUBCOOLING] = {.kind = PLANT_DISTURBANCE, .name = "dTr", .unit = "K", .lo = 0.0, .hi = 60.0,
                    .nominal = 5.0, .help = "reflux subcooling below its bubble point"},
    [LOSS]       = {.kind = PLANT_DISTURBANCE, .name = "Qloss", .unit = "kW", .lo = 0.0, .hi = 0.5,
                    .nominal = 0.15, .help = "heat lost from the reboiler"},
    [PRESSURE]   = {.kind = PLANT_DISTURBANCE, .name = "P", .unit = "mmHg", .lo = 600.0, .hi = 900.0,
                    .nominal = 760.0, .help = "pressure in the condenser"},
    [FIRST_MEASUREMENT]     = SENSOR(1, "temperature of the top tray"),
    [FIRST_MEASUREMENT + 1] = SENSOR(2, "temperature of tray 2"),
    [FIRST_MEASUREMENT + 2] = SENSOR(7, "temperature of tray 7, the feed tray"),
    [FIRST_MEASUREMENT + 3] = SENSOR(9, "temperature of tray 9"),
    [FIRST_MEASUREMENT + 4] = SENSOR(10, "temperature of the bottom tray"),
    [FIRST_INTERNAL_TRAY]     = TRUTH("T3", "degC", 70.0, 130.0, "temperature of tray 3"),
    [FIRST_INTERNAL_TRAY + 1] = TRUTH("T4", "degC", 70.0, 130.0, "temperature of tray 4"),
    [FIRST_INTERNAL_TRAY + 2] = TRUTH("T5", "degC", 70.0, 130.0, "temperature of tray 5"),
    [FIRST_INTERNAL_TRAY + 3] = TRUTH("T6", "degC", 70.0, 130.0, "temperature of tray 6"),
    [FIRST_INTERNAL_TRAY + 4] = TRUTH("T8", "degC", 70.0, 130.0, "temperature of tray 8"),
    [REBOILER_T]       = TRUTH("TB", "degC", 70.0, 130.0, "temperature of the reboiler"),
    [X_D]              = TRUTH("xD", "%w", 0.0, 100.0, "trichloroethylene in the distillate, by weight"),
    [X_B]              = TRUTH("xB", "%w", 0.0, 100.0, "trichloroethylene in the bottoms, by weight"),
    [FLOW_D]           = TRUTH("D", "l/h", 0.0, 20.0, "distillate flow, at reflux temperature"),
    [FLOW_B]           = TRUTH("B", "l/h", 0.0, 20.0, "bottoms flow, at reboiler temperature"),
    [REFLUX_EFFECTIVE] = TRUTH("Lr_eff", "l/h", 0.0, 12.0, "reflux the condenser could supply"),
    [VAPOUR]           = TRUTH("V", "mol/h", 0.0, 200.0, "vapour leaving the reboiler"),
};
/* clang-format on */

static const char *inputs_of(const double *u, struct column_inputs *in)
{
    double weight[2] = {u[FEED_TCE], 100.0 - u[FEED_TCE]};
    *in = (struct column_inputs){
        .feed_basis = COLUMN_FLOW_VOLUME,
        .feed_flow = u[FEED] * L_PER_H,
        .feed_temperature = u[FEED_T] + KELVIN,
        .reflux_basis = COLUMN_FLOW_VOLUME,
        .reflux_flow = u[LR] * L_PER_H,
        .reflux_subcooling = u[SUBCOOLING],
        .heat = fmax(u[QRB] - u[LOSS], 0.0) * 1e3,
        .pressure_top = u[PRESSURE] * MMHG,
    };
    mole_from_mass_fractions(components, 2, weight, in->feed_fraction);
    return NULL;
}

static double weight_percent(const struct column *c, const double *x, size_t stage)
{
    double full[2] = {column_fraction(c, x, stage, 0), column_fraction(c, x, stage, 1)};
    return 100.0 * mass_fraction_of(components, 2, full, 0);
}

/* l/h of a liquid of the composition of a stage at temperature (K), from mol/s. */
static double litres_per_hour(const struct column *c, const double *x, double flow, size_t stage,
                              double temperature)
{
    double full[2] = {column_fraction(c, x, stage, 0), column_fraction(c, x, stage, 1)};
    return flow * mixture_molar_volume(components, 2, full, temperature) / L_PER_H;
}

static double value_of(const struct column *c, const double *x, const double *u, size_t channel)
{
    double t_reflux = c->temperature[STAGES - 1] - u[SUBCOOLING];

    if (channel < REBOILER_T)
        return c->temperature[STAGE(tray_of[channel - FIRST_MEASUREMENT])] - KELVIN;
    switch (channel) {
    case REBOILER_T:
        return c->temperature[0] - KELVIN;
    case X_D:
        return weight_percent(c, x, STAGES - 1);
    case X_B:
        return weight_percent(c, x, 0);
    case FLOW_D:
        return litres_per_hour(c, x, c->flows.distillate, STAGES - 1, t_reflux);
    case FLOW_B:
        return litres_per_hour(c, x, c->flows.bottoms, 0, c->temperature[0]);
    case REFLUX_EFFECTIVE:
        return litres_per_hour(c, x, c->flows.reflux, STAGES - 1, t_reflux);
    case VAPOUR:
        return c->flows.vapour_stripping * 3600.0;
    default:
        return NAN;
    }
}

static const struct plant_states states =
    COLUMN_PLANT_STATES("mole fraction of trichloroethylene, reboiler first");

static const struct column_plant about = {
    .class = &plant_pilot,
    .config = &config,
    .n_inputs = N_INPUTS,
    .inputs_of = inputs_of,
    .value = value_of,
};

static struct plant *create(char *err, size_t err_size)
{
    return column_plant_create(&about, err, err_size);
}

const struct plant_class plant_pilot = {
    .name = "pilot",
    .title = "10-tray pilot column, trichloroethylene / tetrachloroethylene",
    .source = "Folami (1989): mixture, trays, efficiency, gains. Flows, holdups and handbook "
              "property data "
              "are ours, fitted to his gains",
    .tick_s = 30.0,
    .channels = channels,
    .n_channels = N_CHANNELS,
    .create = create,
    COLUMN_PLANT_HOOKS,
    .states = &states,
};
