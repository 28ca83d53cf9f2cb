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
#include "column_solver.h"
#include "column_states.h"
#include "plant.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

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

struct plant {
    struct column_solver *solver;
    double input[N_INPUTS];
};

static struct column_inputs column_inputs_of(const double *u)
{
    double weight[2] = {u[FEED_TCE], 100.0 - u[FEED_TCE]};
    struct column_inputs in = {
        .feed_basis = COLUMN_FLOW_VOLUME,
        .feed_flow = u[FEED] * L_PER_H,
        .feed_temperature = u[FEED_T] + KELVIN,
        .reflux_basis = COLUMN_FLOW_VOLUME,
        .reflux_flow = u[LR] * L_PER_H,
        .reflux_subcooling = u[SUBCOOLING],
        .heat = fmax(u[QRB] - u[LOSS], 0.0) * 1e3,
        .pressure_top = u[PRESSURE] * MMHG,
    };
    mole_from_mass_fractions(components, 2, weight, in.feed_fraction);
    return in;
}

static void pilot_destroy(struct plant *p)
{
    if (p)
        column_solver_destroy(p->solver);
    free(p);
}

static struct plant *pilot_create(char *err, size_t err_size)
{
    struct plant *p = calloc(1, sizeof *p);

    if (!p) {
        snprintf(err, err_size, "pilot: no memory");
        return NULL;
    }
    for (size_t i = 0; i < N_INPUTS; i++)
        p->input[i] = channels[i].nominal;
    struct column_inputs in = column_inputs_of(p->input);
    p->solver = column_solver_create(&config, &in, NULL, err, err_size);
    if (!p->solver || !column_solver_settle(p->solver, err, err_size)) {
        pilot_destroy(p);
        return NULL;
    }
    return p;
}

static bool pilot_set_input(struct plant *p, size_t channel, double value, char *err,
                            size_t err_size)
{
    if (channel >= N_INPUTS) {
        snprintf(err, err_size, "pilot: channel %zu is not an input; inputs are 0 to %d", channel,
                 N_INPUTS - 1);
        return false;
    }
    const struct plant_channel *c = &channels[channel];
    if (!(value >= c->lo && value <= c->hi)) {
        snprintf(err, err_size, "pilot: %s = %g %s is outside %g to %g", c->name, value, c->unit,
                 c->lo, c->hi);
        return false;
    }
    if (value == p->input[channel])
        return true;

    double old = p->input[channel];
    p->input[channel] = value;
    struct column_inputs in = column_inputs_of(p->input);
    if (column_solver_set_inputs(p->solver, &in, err, err_size))
        return true;
    p->input[channel] = old;
    return false;
}

static bool pilot_advance(struct plant *p, double t, char *err, size_t err_size)
{
    return column_solver_advance(p->solver, t, err, err_size);
}

static bool pilot_settle(struct plant *p, char *err, size_t err_size)
{
    return column_solver_settle(p->solver, err, err_size);
}

static double weight_percent(const struct plant *p, size_t stage)
{
    const struct column *c = column_solver_column(p->solver);
    const double *x = column_solver_state(p->solver);
    double full[2] = {column_fraction(c, x, stage, 0), column_fraction(c, x, stage, 1)};
    return 100.0 * mass_fraction_of(components, 2, full, 0);
}

/* l/h of a liquid of the composition of a stage at temperature (K), from mol/s. */
static double litres_per_hour(const struct plant *p, double flow, size_t stage, double temperature)
{
    const struct column *c = column_solver_column(p->solver);
    const double *x = column_solver_state(p->solver);
    double full[2] = {column_fraction(c, x, stage, 0), column_fraction(c, x, stage, 1)};
    return flow * mixture_molar_volume(components, 2, full, temperature) / L_PER_H;
}

static double pilot_value(const struct plant *p, size_t channel)
{
    const struct column *c = column_solver_column(p->solver);
    double t_reflux = c->temperature[STAGES - 1] - p->input[SUBCOOLING];

    if (channel < N_INPUTS)
        return p->input[channel];
    if (channel < REBOILER_T)
        return c->temperature[STAGE(tray_of[channel - FIRST_MEASUREMENT])] - KELVIN;
    switch (channel) {
    case REBOILER_T:
        return c->temperature[0] - KELVIN;
    case X_D:
        return weight_percent(p, STAGES - 1);
    case X_B:
        return weight_percent(p, 0);
    case FLOW_D:
        return litres_per_hour(p, c->flows.distillate, STAGES - 1, t_reflux);
    case FLOW_B:
        return litres_per_hour(p, c->flows.bottoms, 0, c->temperature[0]);
    case REFLUX_EFFECTIVE:
        return litres_per_hour(p, c->flows.reflux, STAGES - 1, t_reflux);
    case VAPOUR:
        return c->flows.vapour_stripping * 3600.0;
    default:
        return NAN;
    }
}

static size_t pilot_state_count(const struct plant *p)
{
    return column_states_count(p->solver);
}

static void pilot_get_state(const struct plant *p, double *x)
{
    column_states_get(p->solver, x);
}

static bool pilot_set_state(struct plant *p, const double *x, char *err, size_t err_size)
{
    return column_solver_set_state(p->solver, x, err, err_size);
}

static bool pilot_rates(struct plant *p, double *rates, char *err, size_t err_size)
{
    return column_states_rates(p->solver, rates, err, err_size);
}

static const struct plant_states pilot_states = {
    .count = pilot_state_count,
    .unit = "mole fraction of trichloroethylene, reboiler first",
    .lo = 0.0,
    .hi = 1.0,
    .step = COLUMN_STATES_STEP,
    .get = pilot_get_state,
    .set = pilot_set_state,
    .rates = pilot_rates,
};

const struct plant_class plant_pilot = {
    .name = "pilot",
    .title = "10-tray pilot column, trichloroethylene / tetrachloroethylene",
    .source = "Folami (1989): mixture, trays, efficiency, gains. Flows, holdups and handbook "
              "property data "
              "are ours, fitted to his gains",
    .tick_s = 30.0,
    .channels = channels,
    .n_channels = N_CHANNELS,
    .create = pilot_create,
    .destroy = pilot_destroy,
    .set_input = pilot_set_input,
    .advance = pilot_advance,
    .value = pilot_value,
    .settle = pilot_settle,
    .states = &pilot_states,
};
