/* A small binary column that can be cold, dry or boiling: component and energy balances of every stage, levels,
 * valves, condenser, heater.
 *
 * Stages count upwards: 0 the reboiler, 1 .. N-2 trays, N-1 the reflux drum. SI units: mol, s, K, Pa, W, J, m3, m.
 *
 * Equations, all ours
 *   stage       dn_j/dt = what comes in - what goes out, dU/dt = likewise with enthalpies - UA (T - T_ambient)
 *   energy      U = C_metal (T - T_ref) + sum n_j cp_j (T - Tb_j); solved for T, no iteration
 *   enthalpies  liquid cp_j (T - Tb_j), vapour lambda + cp_j (T - Tb_j): one molar heat of vaporisation for both
 *               components, so that molar flows are as constant as the frozen pilot assumes
 *   boiling     own vapour = k g(n) z^2 / (z + z0 + z^2 / z1), z = sum x_j P_j(T) / P - 1 where that is positive:
 *               nothing below the bubble point, a superheat of some 0.03 K at nominal boil-up, and at most k z1
 *               g(n) when drops fall onto hot metal. In equilibrium
 *   vapour      1 - E of the vapour from below passes a tray untouched, the rest mixes with its liquid: Murphree's
 *               efficiency E where the flow does not change, and condensation where the tray is cold
 *   liquid      overflow c (n - n_weir)^1.5, and weeping (n - n_film) / tau where vapour is too slow to carry it
 *   condenser   UA (T_top - T_water) / lambda moles per second can condense; the rest leaves by the vent
 *   film        n_film moles per stage neither boil nor drain: a composition is defined everywhere
 *   valves      fed by pump: opening times full flow; by gravity: times sqrt(level / nominal level); under 2.5 % shut
 *   heater      C dT/dt = Q - UA(covered) (T - T_B); its thermostat takes Q away between 280 and 300 degC
 *   level read  level + swell tanh(V / 2 mmol/s)
 * Everything is continuous with continuous slopes, so that an integrator of variable order passes over all of it.
 *
 * Boiling. A stage follows its bubble point without the differential-algebraic equation that a strict equality would be, because k is
 * large. On a cold tray z is below 0, so vapour that touches its liquid condenses and heats metal and liquid. When the tray boils the
 * front has reached the next one.
 * Efficiency. Pilot and Frau take v = v- + E (y* - v-). Here 1 - E passes untouched and E mixes, which is the same where the vapour flow
 * does not change along the column, and still means something where it does.
 * One lambda. With the true heats of vaporisation molar flows would grow by a tenth from bottom to top, and the bottom temperature moves
 * by 0.8 K for each percent of boil-up: another column than the frozen pilot. lambda is that of its reboiler, 34.2 kJ/mol.
 * Film. 0.5 ml on a tray, 50 ml in the reboiler; holdups cannot become negative.
 * Solver (stiff_solver.h: BDF, Newton, relative tolerance 1e-6). Its Jacobian must be full: cut off three trays below, it makes Newton
 * diverge, because what passes untouched meets a very stiff stage. */
#ifndef REFLUX_HOST_SIM_COLD_COLUMN_H
#define REFLUX_HOST_SIM_COLD_COLUMN_H

#include "model/properties.h"

#define COLD_STAGES_MAX 24
#define COLD_STATES_MAX (3 * COLD_STAGES_MAX + 2)

/* A stage: tray, or a vessel with a level when area is above 0. */
struct cold_stage {
    double metal;    /* J/K */
    double loss;     /* W/K to the surroundings */
    double film;     /* mol */
    double boilable; /* mol above the film at which half the boiling surface is wet */
};

/* A vessel: reboiler or drum. Its product leaves by gravity through a valve. */
struct cold_vessel {
    double area; /* m2 */
    /* m: nothing leaves by pump or valve below this level, all that is wanted 1 cm above */
    double outlet;
    double overflow; /* m: level of the overflow pipe, which leads to the product */
    double nominal;  /* m: level at which the product valve gives its full flow */
    /* m3/s through the open product valve at the nominal level; sqrt(level) elsewhere */
    double product_max;
};

struct cold_config {
    const struct component *component; /* [2]; the states count the first, then the second */
    size_t stages;                     /* N, 4 to COLD_STAGES_MAX */
    size_t feed_stage;                 /* index of the tray the feed enters */
    double efficiency;
    double pressure_drop; /* Pa, reboiler minus drum, whatever flows */
    double latent;        /* J/mol */
    double boiling;       /* k, mol/s */
    double boiling_onset; /* z0, - */
    double boiling_limit; /* z1, - */
    double weir;          /* mol of liquid on a tray at its weir */
    double weir_flow;     /* c, mol/s per mol^1.5 */
    double weep_time;     /* tau, s */
    double weep_vapour;   /* mol/s of vapour from below that stop weeping */
    double overflow_flow; /* m3/s per m^1.5 above a vessel's overflow */
    struct cold_stage stage[COLD_STAGES_MAX];
    struct cold_vessel reboiler, drum;
    double reflux_max, feed_max;      /* m3/s, pumped */
    double valve_min;                 /* fraction of opening below which a valve shuts */
    double heater_metal;              /* J/K */
    double heater_wet, heater_dry;    /* W/K from the heater to the reboiler, covered and bare */
    double heater_bottom, heater_top; /* m: levels between which it is partly covered */
    /* K; its thermostat takes the power away over the width up to cut */
    double heater_cut, heater_cut_width;
    double condenser;       /* UA, W/K */
    double condenser_loss;  /* W/K from the water to the surroundings */
    double condenser_water; /* J/K of the water in it */
    double subcooling;      /* part of T_top - T_water that the condensate is cooled by */
    double water_max;       /* m3/s */
    /* mol/s of vapour at which the level reading stands half way up to its offset */
    double swell_vapour;
};

/* Valves as fractions of opening, 0 to 1. */
struct cold_inputs {
    double heat; /* W */
    double reflux, distillate, bottoms, feed, water;
    double feed_fraction; /* of component 0, mole fraction */
    double feed_temperature, ambient, water_temperature;
    double water_supply; /* part of its full flow that is there */
    double pressure;     /* Pa in drum and condenser */
    double swell;        /* m: reads so much too high once boiling */
    double loss_factor;  /* on all losses to the surroundings */
    double leak;         /* m3/s out of the reboiler's bottom */
};

/* A stream: moles of each component and enthalpy, per second. */
struct cold_stream {
    double n[2], h;
};

/* Everything that follows from state and inputs. */
struct cold_outputs {
    double temperature[COLD_STAGES_MAX], holdup[COLD_STAGES_MAX], fraction[COLD_STAGES_MAX];
    double own[COLD_STAGES_MAX]; /* mol/s boiling off the stage's own liquid */
    /* leaving upwards, downwards */
    struct cold_stream vapour[COLD_STAGES_MAX], liquid[COLD_STAGES_MAX];
    struct cold_stream feed, distillate, bottoms, leak, vent;
    double reflux_volume, distillate_volume, bottoms_volume, feed_volume, water_volume; /* m3/s */
    double level_reboiler, level_drum; /* m, true */
    double level_reading;              /* m, of the reboiler */
    double heater, water;              /* K: heater metal, cooling water out */
    double power, loss, cooled; /* W: electric, to the surroundings, carried off by the water */
    double covered;             /* part of the heater under liquid */
};

/* Rates of the states y[cold_states()] and, when out is not NULL, everything else. y: heater temperature; for every
 * stage n_0, n_1, U; temperature of the cooling water. False when a state is no number. */
bool cold_rates(const struct cold_config *c, const struct cold_inputs *u, const double *y,
                double *dy, struct cold_outputs *out);

size_t cold_states(const struct cold_config *c);

/* Energy of a stage from its moles and temperature, and back. */
double cold_energy(const struct cold_config *c, size_t s, const double *n, double temperature);
double cold_temperature(const struct cold_config *c, size_t s, const double *n, double energy);
double cold_heat_capacity(const struct cold_config *c, size_t s,
                          const double *n); /* J/K, metal and liquid */

/* K/s at the rates of moles and energy d[3] = dn_0, dn_1, dU. */
double cold_temperature_rate(const struct cold_config *c, size_t s, const double *n, double energy,
                             const double *d);

/* Cold and switched off: everything at one temperature, films of the given composition, and so much liquid (m of
 * level) in the reboiler. */
void cold_start(const struct cold_config *c, double fraction, double temperature, double level,
                double *y);

#endif
