#include "columns/cold_column.h"

#include <math.h>
#include <string.h>

#define T_REF        360.0  /* K: of the metal's energy, near where the column runs */
#define OUTLET_WIDTH 0.01   /* m of level over which an outlet falls dry */
#define SOFT         0.02   /* relative width over which the condenser's limit sets in */
#define WATER_HEAT   4.18e6 /* J/(m3 K) */

size_t cold_states(const struct cold_config *c)
{
    return 3 * c->stages + 2;
}

static double square(double x)
{
    return x * x;
}

static double above(double x)
{
    return x > 0.0 ? x : 0.0;
}

/* 0 up to 0, 1 from 1 on. */
static double smooth_step(double x)
{
    return x <= 0.0 ? 0.0 : x >= 1.0 ? 1.0 : x * x * (3.0 - 2.0 * x);
}

/* 0 up to 0, then bending over the given width into x - width. */
static double smooth_above(double x, double width)
{
    return x > 0.0 ? x * x / (x + width) : 0.0;
}

/* The lesser of value and limit, rounded off where they are within SOFT. */
static double soft_limit(double value, double limit)
{
    double w = SOFT * limit;
    if (value <= limit - w)
        return value;
    if (value >= limit + w)
        return limit;
    return value - square(value - limit + w) / (4.0 * w);
}

static double liquid_heat(const struct component *c, double t)
{
    return c->heat_capacity * (t - c->boiling_point);
}

double cold_heat_capacity(const struct cold_config *c, size_t s, const double *n)
{
    return c->stage[s].metal + n[0] * c->component[0].heat_capacity +
           n[1] * c->component[1].heat_capacity;
}

double cold_energy(const struct cold_config *c, size_t s, const double *n, double t)
{
    return c->stage[s].metal * (t - T_REF) + n[0] * liquid_heat(&c->component[0], t) +
           n[1] * liquid_heat(&c->component[1], t);
}

double cold_temperature(const struct cold_config *c, size_t s, const double *n, double energy)
{
    return (energy - cold_energy(c, s, n, 0.0)) / cold_heat_capacity(c, s, n);
}

double cold_temperature_rate(const struct cold_config *c, size_t s, const double *n, double energy,
                             const double *d)
{
    double t = cold_temperature(c, s, n, energy);
    double carried =
        d[0] * liquid_heat(&c->component[0], t) + d[1] * liquid_heat(&c->component[1], t);
    return (d[2] - carried) / cold_heat_capacity(c, s, n);
}

/* Liquid of composition x at t, q mol/s. */
static struct cold_stream liquid_of(const struct cold_config *c, double x, double t, double q)
{
    struct cold_stream s = {.n = {q * x, q * (1.0 - x)}};
    s.h = s.n[0] * liquid_heat(&c->component[0], t) + s.n[1] * liquid_heat(&c->component[1], t);
    return s;
}

static void add(struct cold_stream *to, const struct cold_stream *s, double part)
{
    to->n[0] += part * s->n[0];
    to->n[1] += part * s->n[1];
    to->h += part * s->h;
}

static double molar_volume(const struct cold_config *c, double x, double t)
{
    return x * component_molar_volume(&c->component[0], t) +
           (1.0 - x) * component_molar_volume(&c->component[1], t);
}

static double opening(const struct cold_config *c, double valve)
{
    return valve < c->valve_min ? 0.0 : valve;
}

/* Part of a pumped or drained flow that a vessel of this level can give. */
static double available(const struct cold_vessel *v, double level)
{
    return smooth_step((level - v->outlet) / OUTLET_WIDTH);
}

/* m3/s through the product valve, and over the overflow pipe. */
static double product(const struct cold_config *c, const struct cold_vessel *v, double valve,
                      double level)
{
    double over = above(level - v->overflow);
    return opening(c, valve) * v->product_max * sqrt(above(level) / v->nominal) *
               available(v, level) +
           c->overflow_flow * over * sqrt(over);
}

/* Rate at which a liquid boils whose vapour pressure exceeds the pressure by the part z. */
static double eagerness(const struct cold_config *c, double z)
{
    return z > 0.0 ? z * z / (z + c->boiling_onset + z * z / c->boiling_limit) : 0.0;
}

/* Temperature, composition and boiling of one stage. */
static void look_at(const struct cold_config *c, const struct cold_inputs *u, size_t s,
                    const double *n, double energy, struct cold_outputs *o)
{
    const struct cold_stage *stage = &c->stage[s];
    double holdup = n[0] + n[1], p[2], unused;
    double x = holdup > 0.0 ? n[0] / holdup : 0.5;
    double t = cold_temperature(c, s, n, energy);
    double pressure = u->pressure + c->pressure_drop * (1.0 - (double)s / (double)(c->stages - 1));

    x = x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x;
    o->temperature[s] = t;
    o->holdup[s] = holdup;
    o->fraction[s] = x;
    t = t < 200.0 ? 200.0 : t > 700.0 ? 700.0 : t; /* a trial state may be anywhere */
    for (size_t j = 0; j < 2; j++)
        p[j] = component_vapour_pressure(&c->component[j], t, &unused);
    double sum = x * p[0] + (1.0 - x) * p[1];
    double wet = above(holdup - stage->film);
    o->own[s] = c->boiling * wet / (wet + stage->boilable) * eagerness(c, sum / pressure - 1.0);
    o->vapour[s] = liquid_of(c, x * p[0] / sum, t, o->own[s]);
    o->vapour[s].h += o->own[s] * c->latent;
}

/* Flow that leaves a tray downwards, mol/s, over its weir and through its holes. */
static double down(const struct cold_config *c, double holdup, double film, double vapour)
{
    double over = above(holdup - c->weir);
    double holes = square(above(1.0 - vapour / c->weep_vapour));
    return c->weir_flow * over * sqrt(over) + above(holdup - film) / c->weep_time * holes;
}

/* Vapour of top tray and drum: what of it condenses runs into the drum. Returns the heat the water takes. */
static double condense(const struct cold_config *c, struct cold_outputs *o,
                       struct cold_stream *drum)
{
    size_t top = c->stages - 1;
    double t = o->temperature[top - 1], gap = smooth_above(t - o->water, 1.0);
    double cold = t - c->subcooling * gap, part = 0.0;
    struct cold_stream in = o->vapour[top - 1];

    add(&in, &o->vapour[top], 1.0);
    double moles = in.n[0] + in.n[1];
    if (moles > 0.0)
        part = soft_limit(moles, c->condenser * gap / c->latent) / moles;
    struct cold_stream condensate = {.n = {part * in.n[0], part * in.n[1]}};
    condensate.h = condensate.n[0] * liquid_heat(&c->component[0], cold) +
                   condensate.n[1] * liquid_heat(&c->component[1], cold);
    add(drum, &condensate, 1.0);
    o->vent = (struct cold_stream){0};
    add(&o->vent, &in, 1.0 - part);
    return part * in.h - condensate.h;
}

/* Streams that valves, pumps and the leak decide. */
static void outside(const struct cold_config *c, const struct cold_inputs *u,
                    struct cold_outputs *o)
{
    size_t top = c->stages - 1;
    double x0 = o->fraction[0], t0 = o->temperature[0];
    double x1 = o->fraction[top], t1 = o->temperature[top];
    double v0 = molar_volume(c, x0, t0), v1 = molar_volume(c, x1, t1);
    double wet = above(o->holdup[0] - c->stage[0].film);

    o->level_reboiler = o->holdup[0] * v0 / c->reboiler.area;
    o->level_drum = o->holdup[top] * v1 / c->drum.area;
    o->bottoms_volume = product(c, &c->reboiler, u->bottoms, o->level_reboiler);
    o->distillate_volume = product(c, &c->drum, u->distillate, o->level_drum);
    o->reflux_volume = opening(c, u->reflux) * c->reflux_max * available(&c->drum, o->level_drum);
    o->feed_volume = opening(c, u->feed) * c->feed_max;
    o->water_volume = opening(c, u->water) * u->water_supply * c->water_max;
    o->bottoms = liquid_of(c, x0, t0, o->bottoms_volume / v0);
    o->leak = liquid_of(c, x0, t0, u->leak / v0 * wet / (wet + c->stage[0].boilable));
    o->distillate = liquid_of(c, x1, t1, o->distillate_volume / v1);
    o->liquid[top] = liquid_of(c, x1, t1, o->reflux_volume / v1);
    o->feed = liquid_of(c, u->feed_fraction, u->feed_temperature,
                        o->feed_volume / molar_volume(c, u->feed_fraction, u->feed_temperature));
    o->liquid[0] = o->bottoms;
}

static double heater(const struct cold_config *c, const struct cold_inputs *u,
                     struct cold_outputs *o)
{
    double room = (c->heater_cut - o->heater) / c->heater_cut_width;

    o->covered =
        smooth_step((o->level_reboiler - c->heater_bottom) / (c->heater_top - c->heater_bottom));
    o->power = u->heat * smooth_step(room);
    return (c->heater_dry + (c->heater_wet - c->heater_dry) * o->covered) *
           (o->heater - o->temperature[0]);
}

bool cold_rates(const struct cold_config *c, const struct cold_inputs *u, const double *y,
                double *dy, struct cold_outputs *out)
{
    struct cold_outputs local, *o = out ? out : &local;
    struct cold_stream in[COLD_STAGES_MAX] = {{{0.0}, 0.0}};
    size_t top = c->stages - 1;

    for (size_t i = 0; i < cold_states(c); i++)
        if (!isfinite(y[i]))
            return false;
    o->heater = y[0];
    o->water = y[cold_states(c) - 1];
    for (size_t s = 0; s <= top; s++)
        look_at(c, u, s, &y[1 + 3 * s], y[3 + 3 * s], o);
    for (size_t s = 1; s < top; s++)
        add(&o->vapour[s], &o->vapour[s - 1], 1.0 - c->efficiency);
    outside(c, u, o);

    for (size_t s = 1; s < top; s++) {
        const struct cold_stream *below = &o->vapour[s - 1];
        o->liquid[s] =
            liquid_of(c, o->fraction[s], o->temperature[s],
                      down(c, o->holdup[s], c->stage[s].film, below->n[0] + below->n[1]));
        add(&in[s], below, 1.0);
    }
    for (size_t s = 0; s < top; s++)
        add(&in[s], &o->liquid[s + 1], 1.0);
    add(&in[c->feed_stage], &o->feed, 1.0);
    double to_water = condense(c, o, &in[top]);
    add(&in[0], &o->leak, -1.0);
    add(&in[top], &o->distillate, -1.0);
    double to_liquid = heater(c, u, o);
    in[0].h += to_liquid;

    o->loss = 0.0;
    for (size_t s = 0; s <= top; s++) {
        double lost = c->stage[s].loss * u->loss_factor * (o->temperature[s] - u->ambient);
        for (size_t j = 0; j < 2; j++)
            dy[1 + 3 * s + j] = in[s].n[j] - o->vapour[s].n[j] - o->liquid[s].n[j];
        dy[3 + 3 * s] = in[s].h - o->vapour[s].h - o->liquid[s].h - lost;
        o->loss += lost;
    }
    double lost = c->condenser_loss * u->loss_factor * (o->water - u->ambient);
    o->loss += lost;
    o->cooled = o->water_volume * WATER_HEAT * (o->water - u->water_temperature);
    dy[0] = (o->power - to_liquid) / c->heater_metal;
    dy[cold_states(c) - 1] = (to_water - o->cooled - lost) / c->condenser_water;
    double rise = o->vapour[0].n[0] + o->vapour[0].n[1];
    o->level_reading = o->level_reboiler + u->swell * tanh(rise / c->swell_vapour);
    return true;
}

void cold_start(const struct cold_config *c, double fraction, double t, double level, double *y)
{
    y[0] = t;
    y[cold_states(c) - 1] = t;
    for (size_t s = 0; s < c->stages; s++) {
        double holdup = c->stage[s].film;
        if (s == 0 && level * c->reboiler.area > holdup * molar_volume(c, fraction, t))
            holdup = level * c->reboiler.area / molar_volume(c, fraction, t);
        y[1 + 3 * s] = holdup * fraction;
        y[2 + 3 * s] = holdup * (1.0 - fraction);
        y[3 + 3 * s] = cold_energy(c, s, &y[1 + 3 * s], t);
    }
}
