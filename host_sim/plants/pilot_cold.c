/* The pilot column from cold: the column of plants/pilot.json (same mixture, trays, properties, feed and running state)
 * with what a start-up needs: an energy balance on every stage, levels, valves, condenser, heater. Equations:
 * cold_column.h; a start worked through: docs/use/pilot-cold.md.
 *
 * The source's own (T. O. Folami, PhD thesis, University of Aston in Birmingham, 1989, volume 2): what
 * docs/methods/column-model.md lists for the pilot; heater of 0.7 to 1.25 kW; the reboiler level that reads 8 +/- 2 cm too high
 * once vapour rises; total reflux for 10 to 15 minutes; distillate valve at 40 %; bottoms valve at 60 % or 10 % by the reboiler's level; valves
 * with a linear characteristic and a rangeability of 40:1, so that less than 2.5 % is no opening at all; reflux valve
 * between 12 and 60 %; the reboiler cools to about 30 degC in about 3 h (here 3.4 h). He has it, too, that his own
 * simulator, with no heat stored anywhere, was too fast for the plant.
 *
 * Ours, chosen so that his procedure works and that at rest this is the pilot:
 *   running     heater 0.823 kW, reflux valve 37.5 %, distillate valve 40 %, bottoms valve 39.6 %, feed valve 50 %: then
 *               every temperature is within 0.1 K of the pilot's, products within 1 % (the test pilot_cold)
 *   energy      one molar heat of vaporisation, that of the pilot's reboiler, so that molar flows are as constant as
 *               there; heat capacities from plants/pilot.json, also for vapour
 *   metal       reboiler 6 kJ/K, each tray with its piece of shell 0.3 kJ/K, drum 0.1 kJ/K
 *   losses      reboiler 1.6 W/K (the pilot's 0.15 kW), each lagged tray 0.02 W/K, drum and reflux line 0.1 W/K
 *   trays       25 ml at nominal flow as in the pilot, of which 20 ml stay behind the weir; they weep dry within half a
 *               minute when the vapour stops
 *   reboiler    100 cm2: 1.5 l at 15 cm. Heater between 3 and 5 cm, outlet at 1 cm, overflow to the product at 35 cm.
 *               Filled to 18 cm at the start: drum and trays take 4 cm, warm liquid needs a tenth more room
 *   drum        25 cm2: 0.15 l at 6 cm. Outlet at 0.5 cm, overflow to the product at 12 cm
 *   valves      reflux 12 l/h and feed 10 l/h when open, pumped; distillate 3.3 l/h and bottoms 10 l/h at nominal level,
 *               by gravity, so with the root of the level: drum and reboiler find a level by themselves
 *   condenser   50 W/K to 60 l/h of cooling water; the condensate leaves a little subcooled and the drum loses some more,
 *               together the pilot's 5 K. Vapour beyond its capacity leaves by the vent and is lost
 *   heater      0.4 kJ/K, 30 W/K to the liquid, 1 W/K when bare; a thermostat of its own takes the power away between
 *               280 and 300 degC
 *   feed        at 60 degC whatever the column does, as in the pilot
 *   speeds, sensors  slew of actuators, lag, noise and resolution of instruments
 *
 * At the limits: nothing flows out of an empty vessel, nothing boils off a dry stage, a full vessel runs over into the
 * product. Faults of the process are inputs: `supply` (cooling water fails), `leak` (the reboiler runs dry), `loss`
 * (lagging gone), `swell` (the level reads wrong). */
#include "columns/cold_column.h"
#include "columns/cold_states.h"
#include "columns/stiff_solver.h"
#include "plants/plant.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const struct plant_class plant_pilot_cold;

static const struct component components[2] = {
#include "plants/pilot_properties.inc"
};

#define TRAYS   10
#define STAGES  (TRAYS + 2)
#define STATES  (3 * STAGES + 2)
#define TOP     (STAGES - 1)       /* the drum */
#define TRAY(k) (STAGES - 1 - (k)) /* index of tray k, counted from the top */
#define KELVIN  273.15
#define MMHG    133.322
#define L_PER_H (1e-3 / 3600.0) /* m3/s */
#define TRAY_DATA                                                                                  \
    {                                                                                              \
        .metal = 300.0, .loss = 0.02, .film = 0.005, .boilable = 0.01                              \
    }

static const struct cold_config config = {
    .component = components,
    .stages = STAGES,
    .feed_stage = TRAY(7),
    .efficiency = 0.9,
    .pressure_drop = 1000.0,
    .latent = 34196.0,
    .boiling = 20.0,
    .boiling_onset = 1e-4,
    .boiling_limit = 0.02,
    .weir = 0.2,
    .weir_flow = 2.3,
    .weep_time = 10.0,
    .weep_vapour = 5e-3,
    .overflow_flow = 0.02,
    .stage = {{.metal = 6000.0, .loss = 1.6, .film = 0.5, .boilable = 0.2},
              TRAY_DATA,
              TRAY_DATA,
              TRAY_DATA,
              TRAY_DATA,
              TRAY_DATA,
              TRAY_DATA,
              TRAY_DATA,
              TRAY_DATA,
              TRAY_DATA,
              TRAY_DATA,
              {.metal = 100.0, .loss = 0.1, .film = 0.05, .boilable = 0.02}},
    .reboiler = {.area = 0.01,
                 .outlet = 0.01,
                 .overflow = 0.35,
                 .nominal = 0.15,
                 .product_max = 10.0 * L_PER_H},
    .drum = {.area = 0.0025,
             .outlet = 0.005,
             .overflow = 0.12,
             .nominal = 0.06,
             .product_max = 3.3 * L_PER_H},
    .reflux_max = 12.0 * L_PER_H,
    .feed_max = 10.0 * L_PER_H,
    .valve_min = 0.025,
    .heater_metal = 400.0,
    .heater_wet = 30.0,
    .heater_dry = 1.0,
    .heater_bottom = 0.03,
    .heater_top = 0.05,
    .heater_cut = 300.0 + KELVIN,
    .heater_cut_width = 20.0,
    .condenser = 50.0,
    .condenser_loss = 0.5,
    .condenser_water = 0.3 * 4180.0,
    .subcooling = 0.04,
    .water_max = 60.0 * L_PER_H,
    .swell_vapour = 2e-3,
};

#define HOUR       3600.0
#define SETTLE_MAX (4096.0 * HOUR)
#define SETTLED    1e-4 /* cold_states_unrest() */
#define FILL       0.18 /* m: reboiler level an operator leaves after filling, cold */

enum {
    QRB,
    V_REFLUX,
    V_DISTILLATE,
    V_BOTTOMS,
    V_FEED,
    V_WATER,
    FEED_TCE,
    FEED_T,
    AMBIENT,
    WATER_T,
    SUPPLY,
    SWELL,
    LOSS,
    LEAK,
    PRESSURE,
    N_INPUTS,
    T_FIRST = N_INPUTS,
    T_REBOILER = T_FIRST + 5,
    T_HEATER,
    LEVEL_B,
    LEVEL_D,
    FLOW_WATER,
    T_WATER,
    FLOW_F,
    FLOW_LR,
    FLOW_D,
    T_INTERNAL,
    T_DRUM = T_INTERNAL + 5,
    X_D,
    X_B,
    FLOW_B,
    TRUE_LEVEL,
    VAPOUR,
    VENT,
    CONDENSER,
    N_CHANNELS
};

/* Trays behind the temperature channels: those measured, then the others. */
static const int tray_of[10] = {1, 2, 7, 9, 10, 3, 4, 5, 6, 8};

#define VALVE(n, at_safe, text)                                                                    \
    {                                                                                              \
        .kind = PLANT_MV, .name = (n), .unit = "%", .lo = 0.0, .hi = 100.0, .nominal = 0.0,        \
        .safe = (at_safe), .slew = 20.0, .help = (text)                                            \
    }
#define PARAMETER(n, u, low, high, at, text)                                                       \
    {                                                                                              \
        .kind = PLANT_DISTURBANCE, .name = (n), .unit = (u), .lo = (low), .hi = (high),            \
        .nominal = (at), .help = (text)                                                            \
    }
#define SENSOR(n, u, low, high, slow, rms, step, text)                                             \
    {                                                                                              \
        .kind = PLANT_MEASUREMENT, .name = (n), .unit = (u), .lo = (low), .hi = (high),            \
        .lag_s = (slow), .noise = (rms), .resolution = (step), .help = (text)                      \
    }
#define THERMOMETER(n, text) SENSOR(n, "degC", 0.0, 150.0, 5.0, 0.05, 0.01, text)
#define TRUTH(n, u, low, high, text)                                                               \
    {                                                                                              \
        .kind = PLANT_INTERNAL, .name = (n), .unit = (u), .lo = (low), .hi = (high),               \
        .help = (text)                                                                             \
    }

/* clang-format off */
static const struct plant_channel channels[N_CHANNELS] = {
    [QRB]          = {.kind = PLANT_MV, .name = "Qrb", .unit = "kW", .lo = 0.0, .hi = 1.5, .nominal = 0.0,
                      .safe = 0.0, .slew = 0.25, .help = "reboiler heater"},
    [V_REFLUX]     = VALVE("vLr", 100.0, "reflux valve; 12 l/h open"),
    [V_DISTILLATE] = VALVE("vD", 0.0, "distillate valve; 3.3 l/h open at 6 cm in the drum"),
    [V_BOTTOMS]    = VALVE("vB", 0.0, "bottoms valve; 10 l/h open at 15 cm in the reboiler"),
    [V_FEED]       = VALVE("vF", 0.0, "feed valve; 10 l/h open"),
    [V_WATER]      = VALVE("vCW", 100.0, "cooling water valve; 60 l/h open"),
    [FEED_TCE]     = PARAMETER("xF", "%w", 0.0, 100.0, 36.0, "trichloroethylene in the feed, by weight"),
    [FEED_T]       = PARAMETER("TF", "degC", 10.0, 120.0, 60.0, "feed temperature"),
    [AMBIENT]      = PARAMETER("Tamb", "degC", 5.0, 40.0, 20.0, "temperature of the surroundings"),
    [WATER_T]      = PARAMETER("Tcw_in", "degC", 2.0, 40.0, 15.0, "cooling water supply temperature"),
    [SUPPLY]       = PARAMETER("supply", "-", 0.0, 1.0, 1.0, "part of the cooling water that is there"),
    [SWELL]        = PARAMETER("swell", "cm", 0.0, 12.0, 8.0, "reboiler level reads so much too high once boiling"),
    [LOSS]         = PARAMETER("loss", "-", 0.0, 3.0, 1.0, "factor on all heat losses"),
    [LEAK]         = PARAMETER("leak", "l/h", 0.0, 60.0, 0.0, "leak out of the reboiler"),
    [PRESSURE]     = PARAMETER("P", "mmHg", 600.0, 900.0, 760.0, "pressure in the condenser"),
    [T_FIRST]      = THERMOMETER("T1", "temperature of the top tray"),
    [T_FIRST + 1]  = THERMOMETER("T2", "temperature of tray 2"),
    [T_FIRST + 2]  = THERMOMETER("T7", "temperature of tray 7, the feed tray"),
    [T_FIRST + 3]  = THERMOMETER("T9", "temperature of tray 9"),
    [T_FIRST + 4]  = THERMOMETER("T10", "temperature of the bottom tray"),
    [T_REBOILER]   = SENSOR("TB", "degC", 0.0, 320.0, 5.0, 0.05, 0.01, "temperature of the reboiler's liquid"),
    [T_HEATER]     = SENSOR("Theater", "degC", 0.0, 400.0, 2.0, 0.5, 0.1, "temperature of the heater's metal"),
    [LEVEL_B]      = SENSOR("LB", "cm", 0.0, 50.0, 2.0, 0.1, 0.05, "reboiler level as read"),
    [LEVEL_D]      = SENSOR("LD", "cm", 0.0, 20.0, 2.0, 0.05, 0.02, "reflux drum level"),
    [FLOW_WATER]   = SENSOR("Fcw", "l/h", 0.0, 80.0, 1.0, 0.3, 0.1, "cooling water flow"),
    [T_WATER]      = SENSOR("Tcw", "degC", 0.0, 150.0, 5.0, 0.05, 0.01, "cooling water out"),
    [FLOW_F]       = SENSOR("F", "l/h", 0.0, 12.0, 1.0, 0.02, 0.01, "feed flow"),
    [FLOW_LR]      = SENSOR("Lr", "l/h", 0.0, 15.0, 1.0, 0.02, 0.01, "reflux flow"),
    [FLOW_D]       = SENSOR("D", "l/h", 0.0, 40.0, 1.0, 0.02, 0.01, "distillate flow"),
    [T_INTERNAL]     = TRUTH("T3", "degC", 0.0, 150.0, "temperature of tray 3"),
    [T_INTERNAL + 1] = TRUTH("T4", "degC", 0.0, 150.0, "temperature of tray 4"),
    [T_INTERNAL + 2] = TRUTH("T5", "degC", 0.0, 150.0, "temperature of tray 5"),
    [T_INTERNAL + 3] = TRUTH("T6", "degC", 0.0, 150.0, "temperature of tray 6"),
    [T_INTERNAL + 4] = TRUTH("T8", "degC", 0.0, 150.0, "temperature of tray 8"),
    [T_DRUM]       = TRUTH("TD", "degC", 0.0, 150.0, "temperature in the reflux drum"),
    [X_D]          = TRUTH("xD", "%w", 0.0, 100.0, "trichloroethylene in the drum, by weight"),
    [X_B]          = TRUTH("xB", "%w", 0.0, 100.0, "trichloroethylene in the reboiler, by weight"),
    [FLOW_B]       = TRUTH("B", "l/h", 0.0, 40.0, "bottoms flow, at reboiler temperature"),
    [TRUE_LEVEL]   = TRUTH("LB_true", "cm", 0.0, 50.0, "reboiler level"),
    [VAPOUR]       = TRUTH("V", "mol/h", 0.0, 5000.0, "vapour leaving the reboiler"),
    [VENT]         = TRUTH("vent", "mol/h", 0.0, 5000.0, "vapour the condenser did not condense, lost"),
    [CONDENSER]    = TRUTH("Qc", "kW", -10.0, 10.0, "heat carried off by the cooling water"),
};
/* clang-format on */

struct plant {
    struct stiff_solver *solver;
    double input[N_INPUTS];
    struct cold_inputs u;
    struct cold_outputs out; /* of the present state */
};

static double mole_fraction(double weight_percent)
{
    double weight[2] = {weight_percent, 100.0 - weight_percent}, x[2];
    mole_from_mass_fractions(components, 2, weight, x);
    return x[0];
}

static double weight_percent(double x)
{
    double full[2] = {x, 1.0 - x};
    return 100.0 * mass_fraction_of(components, 2, full, 0);
}

static struct cold_inputs cold_inputs_of(const double *u)
{
    return (struct cold_inputs){
        .heat = u[QRB] * 1e3,
        .reflux = u[V_REFLUX] * 0.01,
        .distillate = u[V_DISTILLATE] * 0.01,
        .bottoms = u[V_BOTTOMS] * 0.01,
        .feed = u[V_FEED] * 0.01,
        .water = u[V_WATER] * 0.01,
        .feed_fraction = mole_fraction(u[FEED_TCE]),
        .feed_temperature = u[FEED_T] + KELVIN,
        .ambient = u[AMBIENT] + KELVIN,
        .water_temperature = u[WATER_T] + KELVIN,
        .water_supply = u[SUPPLY],
        .pressure = u[PRESSURE] * MMHG,
        .swell = u[SWELL] * 0.01,
        .loss_factor = u[LOSS],
        .leak = u[LEAK] * L_PER_H,
    };
}

static bool rates(void *context, const double *y, double *dy)
{
    const struct plant *p = context;
    return cold_rates(&config, &p->u, y, dy, NULL);
}

static void refresh(struct plant *p)
{
    double unused[STATES];
    (void)cold_rates(&config, &p->u, stiff_solver_state(p->solver), unused, &p->out);
}

static void destroy(struct plant *p)
{
    if (p)
        stiff_solver_destroy(p->solver);
    free(p);
}

static struct plant *create(char *err, size_t err_size)
{
    struct plant *p = calloc(1, sizeof *p);
    double y[STATES], absolute[STATES];

    if (!p) {
        snprintf(err, err_size, "pilot-cold: no memory");
        return NULL;
    }
    for (size_t i = 0; i < N_INPUTS; i++)
        p->input[i] = channels[i].nominal;
    p->u = cold_inputs_of(p->input);
    cold_start(&config, p->u.feed_fraction, p->u.ambient, FILL, y);
    absolute[0] = absolute[STATES - 1] = 1e-4;
    for (size_t s = 0; s < STAGES; s++) {
        absolute[1 + 3 * s] = absolute[2 + 3 * s] = 1e-8;
        absolute[3 + 3 * s] = 1e-5 * config.stage[s].metal;
    }
    struct stiff_problem problem = {.name = "pilot-cold",
                                    .n = STATES,
                                    .relative = 1e-6,
                                    .absolute = absolute,
                                    .rates = rates,
                                    .context = p};
    p->solver = stiff_solver_create(&problem, y, err, err_size);
    if (!p->solver) {
        destroy(p);
        return NULL;
    }
    refresh(p);
    return p;
}

static bool set_input(struct plant *p, size_t channel, double value, char *err, size_t err_size)
{
    if (!plant_input_allowed(&plant_pilot_cold, N_INPUTS, channel, value, err, err_size))
        return false;
    if (value == p->input[channel])
        return true;
    p->input[channel] = value;
    p->u = cold_inputs_of(p->input);
    stiff_solver_restart(p->solver);
    refresh(p);
    return true;
}

static bool advance(struct plant *p, double t, char *err, size_t err_size)
{
    bool done = stiff_solver_advance(p->solver, t, err, err_size);
    refresh(p);
    return done;
}

static bool settle(struct plant *p, char *err, size_t err_size)
{
    double start = stiff_solver_time(p->solver), keep[STATES];
    bool sound = true, done = false;

    memcpy(keep, stiff_solver_state(p->solver), sizeof keep);
    stiff_solver_set(p->solver, 0.0, keep);
    for (double t = 4.0 * HOUR; sound && !done && t <= SETTLE_MAX; t *= 2.0) {
        sound = stiff_solver_advance(p->solver, t, err, err_size);
        done = sound && cold_states_unrest(&config, &p->u, stiff_solver_state(p->solver)) < SETTLED;
    }
    refresh(p);
    if (sound && p->u.heat > 0.0 && p->out.covered < 1.0) {
        snprintf(
            err, err_size,
            "pilot-cold: with these inputs the reboiler runs dry: heater on and %.1f cm of liquid",
            100.0 * p->out.level_reboiler);
        done = false;
    } else if (sound && !done) {
        snprintf(err, err_size, "pilot-cold: these inputs bring no steady state within %g h",
                 SETTLE_MAX / HOUR);
    }
    stiff_solver_set(p->solver, start, done ? stiff_solver_state(p->solver) : keep);
    refresh(p);
    return done;
}

static size_t state_count(const struct plant *p)
{
    (void)p;
    return STATES;
}

static void get_state(const struct plant *p, double *x)
{
    cold_states_get(&config, stiff_solver_state(p->solver), x);
}

static bool set_state(struct plant *p, const double *x, char *err, size_t err_size)
{
    double y[STATES];

    if (!cold_states_set(&config, x, y, err, err_size))
        return false;
    stiff_solver_set(p->solver, stiff_solver_time(p->solver), y);
    refresh(p);
    return true;
}

static bool state_rates(struct plant *p, double *dx, char *err, size_t err_size)
{
    (void)err, (void)err_size; /* a state that could be set has rates */
    cold_states_rates(&config, &p->u, stiff_solver_state(p->solver), dx);
    return true;
}

static const struct plant_states states = {
    .count = state_count,
    .unit = COLD_STATES_UNIT,
    .lo = 0.0,
    .hi = COLD_STATES_MAX_VALUE,
    .step = COLD_STATES_STEP,
    .get = get_state,
    .set = set_state,
    .rates = state_rates,
};

static double litres_per_hour(double flow)
{
    return flow / L_PER_H;
}

static double moles_per_hour(const struct cold_stream *s)
{
    return (s->n[0] + s->n[1]) * 3600.0;
}

static double value(const struct plant *p, size_t channel)
{
    const struct cold_outputs *o = &p->out;

    if (channel < N_INPUTS)
        return p->input[channel];
    if (channel < T_REBOILER)
        return o->temperature[TRAY(tray_of[channel - T_FIRST])] - KELVIN;
    if (channel >= T_INTERNAL && channel < T_DRUM)
        return o->temperature[TRAY(tray_of[channel - T_INTERNAL + 5])] - KELVIN;
    switch (channel) {
    case T_REBOILER:
        return o->temperature[0] - KELVIN;
    case T_HEATER:
        return o->heater - KELVIN;
    case LEVEL_B:
        return o->level_reading * 100.0;
    case LEVEL_D:
        return o->level_drum * 100.0;
    case FLOW_WATER:
        return litres_per_hour(o->water_volume);
    case T_WATER:
        return o->water - KELVIN;
    case FLOW_F:
        return litres_per_hour(o->feed_volume);
    case FLOW_LR:
        return litres_per_hour(o->reflux_volume);
    case FLOW_D:
        return litres_per_hour(o->distillate_volume);
    case T_DRUM:
        return o->temperature[TOP] - KELVIN;
    case X_D:
        return weight_percent(o->fraction[TOP]);
    case X_B:
        return weight_percent(o->fraction[0]);
    case FLOW_B:
        return litres_per_hour(o->bottoms_volume);
    case TRUE_LEVEL:
        return o->level_reboiler * 100.0;
    case VAPOUR:
        return moles_per_hour(&o->vapour[0]);
    case VENT:
        return moles_per_hour(&o->vent);
    case CONDENSER:
        return o->cooled * 1e-3;
    default:
        return NAN;
    }
}

const struct plant_class plant_pilot_cold = {
    .name = "pilot-cold",
    .title = "the pilot column from cold: energy balance, levels, valves, condenser and heater",
    .source =
        "Folami (1989): as plant pilot; start-up and shut-down, heater range, valve openings and "
        "rangeability, level reading too high by 8 cm once boiling",
    .ours =
        "heat capacities and losses, vessels, valve sizes, condenser, heater, sensors; trimmed to "
        "the running state of plant pilot. Starts cold: nominal is switched off",
    .tick_s = 10.0,
    .channels = channels,
    .n_channels = N_CHANNELS,
    .create = create,
    .destroy = destroy,
    .set_input = set_input,
    .advance = advance,
    .value = value,
    .settle = settle,
    .states = &states,
};
