#include "model/column.h"

#include <string.h>

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

static real_t linear(real_t bottom, real_t top, size_t s, size_t n)
{
    return bottom + (top - bottom) * (real_t)s / (real_t)(n - 1);
}

enum err column_init(struct column *column, const struct column_config *config,
                     struct column_fault *fault)
{
    enum err err = column_validate(config, fault);
    if (err)
        return err;

    size_t n = config->stages, c = config->components;
    memset(column, 0, sizeof *column);
    column->config = config;
    column->n_states = n * (c - 1);
    column->vle.component = config->component;
    column->vle.n = c;
    column->vle.activity = config->activity;
    column->vle.activity_context = config->activity_context;
    column->vle.temperature_min = config->temperature_min;
    column->vle.temperature_max = config->temperature_max;
    for (size_t s = 0; s < n; s++) {
        real_t t = linear(config->holdup_temperature_bottom, config->holdup_temperature_top, s, n);
        column->temperature[s] = REAL_C(0.5) * (config->temperature_min + config->temperature_max);
        for (size_t j = 0; j < c; j++)
            column->molar_volume[s * c + j] =
                config->holdup == COLUMN_HOLDUP_MOLAR
                    ? ONE
                    : component_molar_volume(&config->component[j], t);
    }
    return ERR_OK;
}

static real_t moles_per_unit(const struct column_config *config, enum column_basis basis,
                             const real_t *x, real_t temperature)
{
    if (basis == COLUMN_FLOW_MASS)
        return ONE / mixture_molar_mass(config->component, config->components, x);
    if (basis == COLUMN_FLOW_VOLUME)
        return ONE / mixture_molar_volume(config->component, config->components, x, temperature);
    return ONE;
}

enum err column_set_inputs(struct column *column, const struct column_inputs *inputs,
                           struct column_fault *fault)
{
    const struct column_config *config = column->config;
    enum err err = column_validate_inputs(config, inputs, fault);
    if (err)
        return err;

    if (inputs->pressure_top != column->inputs.pressure_top)
        column->warm = false;
    column->inputs = *inputs;
    column->feed_molar =
        inputs->feed_flow *
        moles_per_unit(config, inputs->feed_basis, inputs->feed_fraction, inputs->feed_temperature);
    for (size_t s = 0; s < config->stages; s++)
        column->pressure[s] = linear(inputs->pressure_top + config->pressure_drop,
                                     inputs->pressure_top, s, config->stages);
    return ERR_OK;
}

real_t column_fraction(const struct column *column, const real_t *x, size_t s, size_t j)
{
    size_t m = column->config->components - 1;
    real_t last = ONE;

    if (j < m)
        return x[s * m + j];
    for (size_t i = 0; i < m; i++)
        last -= x[s * m + i];
    return last;
}

static void full_composition(const struct column *column, const real_t *x, size_t s, real_t *full)
{
    size_t m = column->config->components - 1;

    full[m] = ONE;
    for (size_t j = 0; j < m; j++) {
        full[j] = x[s * m + j];
        full[m] -= full[j];
    }
}

/* The lesser of value and limit (both 0 or more), rounded off where they are within the relative width. */
static real_t soft_limit(real_t value, real_t limit, real_t width)
{
    real_t w = width * limit;
    if (value <= limit - w)
        return value;
    if (value >= limit + w)
        return limit;
    real_t over = value - limit + w;
    return value - over * over / (REAL_C(4.0) * w);
}

/* The greater of value and 0, rounded off where value is within width of 0. */
static real_t soft_positive(real_t value, real_t width)
{
    if (value >= width)
        return value;
    if (value <= -width)
        return ZERO;
    return (value + width) * (value + width) / (REAL_C(4.0) * width);
}

/* Internal flows, Frau 2.4, with the limits described at struct column_flows. Never negative: D is confined
 * to 0 .. F, and what D cannot take is taken off the reflux (low side) or the vapour (high side). */
static void internal_flows(struct column *column, const real_t *x)
{
    const struct column_config *config = column->config;
    const struct component *component = config->component;
    const struct column_inputs *in = &column->inputs;
    struct column_flows *f = &column->flows;
    size_t c = config->components, top = config->stages - 1, feed = config->feed_stage - 1;
    real_t soft = config->limit_softness;
    real_t full[COLUMN_COMPONENTS_MAX];

    f->feed = column->feed_molar;

    full_composition(column, x, 0, full);
    f->boilup_wanted =
        in->heat / mixture_vaporisation_heat(component, c, full, column->temperature[0]);

    full_composition(column, x, feed, full);
    f->condensed_by_feed = f->feed * mixture_heat_capacity(component, c, full) *
                           (column->temperature[feed] - in->feed_temperature) /
                           mixture_vaporisation_heat(component, c, full, column->temperature[feed]);

    full_composition(column, x, top, full);
    real_t t_reflux = column->temperature[top] - in->reflux_subcooling;
    f->reflux_wanted = in->reflux_flow * moles_per_unit(config, in->reflux_basis, full, t_reflux);
    /* internal reflux per mole of reflux: 1 + dV_R / R */
    real_t gain = ONE + mixture_heat_capacity(component, c, full) * in->reflux_subcooling /
                            mixture_vaporisation_heat(component, c, full, column->temperature[top]);

    /* A feed condenses at most the vapour that meets it and flashes at most itself, less the share that
     * the limit on D below may round off. */
    if (f->condensed_by_feed > ZERO)
        f->condensed_by_feed = soft_limit(f->condensed_by_feed, f->boilup_wanted, soft);
    else
        f->condensed_by_feed = -soft_limit(-f->condensed_by_feed, (ONE - soft) * f->feed, soft);

    real_t vapour = f->boilup_wanted - f->condensed_by_feed;
    if (vapour < ZERO)
        vapour = ZERO; /* rounding */
    real_t wanted = soft_positive(vapour - gain * f->reflux_wanted, soft * vapour);
    if (vapour <= ZERO)
        wanted = ZERO;
    f->reflux = (vapour - wanted) / gain;
    f->distillate = soft_limit(wanted, f->feed, soft);
    if (f->reflux < ZERO)
        f->reflux = ZERO; /* rounding */

    f->condensed_by_reflux = (gain - ONE) * f->reflux;
    f->vapour_enriching = f->distillate + gain * f->reflux;
    f->vapour_stripping = f->vapour_enriching + f->condensed_by_feed;
    if (f->vapour_stripping < ZERO)
        f->vapour_stripping = ZERO; /* rounding */
    f->vapour_top = f->distillate + f->reflux;
    f->liquid_enriching = gain * f->reflux;
    f->liquid_stripping = f->liquid_enriching + f->feed + f->condensed_by_feed;
    f->bottoms = f->feed - f->distillate;
}

static void stage_flows(struct column *column)
{
    const struct column_config *config = column->config;
    const struct column_flows *f = &column->flows;
    size_t top = config->stages - 1, feed = config->feed_stage - 1;

    for (size_t s = 0; s <= top; s++) {
        column->liquid[s] = s <= feed ? f->liquid_stripping : f->liquid_enriching;
        column->vapour_flow[s] = s < feed ? f->vapour_stripping : f->vapour_enriching;
    }
    column->liquid[0] = f->bottoms;
    column->liquid[top] = f->reflux;
    column->vapour_flow[top - 1] = f->vapour_top;
    column->vapour_flow[top] = ZERO;
}

enum err column_evaluate(struct column *column, const real_t *x)
{
    const struct column_config *config = column->config;
    size_t c = config->components, top = config->stages - 1;
    real_t full[COLUMN_COMPONENTS_MAX], equilibrium[COLUMN_COMPONENTS_MAX];
    bool warm = column->warm;

    column->warm = false; /* until all stages are done */
    for (size_t s = 0; s <= top; s++) {
        real_t volume = ZERO;

        full_composition(column, x, s, full);
        for (size_t j = 0; j < c; j++) {
            if (!isfinite(full[j]))
                return ERR_NOT_FINITE;
            volume += full[j] * column->molar_volume[s * c + j];
        }
        enum err err =
            vle_bubble_point(&column->vle, full, column->pressure[s], &column->temperature[s],
                             equilibrium, &column->k[s * c], &column->dk[s * c], warm);
        if (err)
            return err;
        column->holdup[s] = (s == 0     ? config->holdup_reboiler
                             : s == top ? config->holdup_condenser
                                        : config->holdup_tray) /
                            volume;

        real_t *v = &column->vapour[s * c];
        for (size_t j = 0; j < c; j++) {
            if (s == 0 || s == top) /* ideal reboiler; nothing leaves a total condenser as vapour */
                v[j] = equilibrium[j];
            else
                v[j] = v[j - c] + config->efficiency * (equilibrium[j] - v[j - c]);
        }
    }
    column->warm = true;
    internal_flows(column, x);
    stage_flows(column);
    return ERR_OK;
}

/* Mean molar volume of a composition, by the volumes of a stage. */
static real_t mean_volume(const real_t *x, const real_t *volume, size_t m)
{
    real_t mean = volume[m];
    for (size_t j = 0; j < m; j++)
        mean += x[j] * (volume[j] - volume[m]);
    return mean;
}

/* Conservative form: the liquid leaving a stage, from what its molar holdup gives up. excess: what the flows
 * bring, mol/s. Where the stage needs more than that, it draws liquid from the stage below, of that one's
 * composition and volume: the balances stay closed and every mole fraction stays in [0, 1]. */
static real_t conservative_outflow(const struct column *column, const real_t *x, size_t s,
                                   real_t excess, real_t *rates)
{
    size_t m = column->config->components - 1;
    const real_t *here = &x[s * m], *volume = &column->molar_volume[s * (m + 1)];
    real_t mean = mean_volume(here, volume, m), growth = ZERO; /* of the molar volume, m3/(mol s) */

    for (size_t j = 0; j < m; j++)
        growth += (volume[j] - volume[m]) * rates[s * m + j];
    real_t out = excess + column->holdup[s] * growth / mean; /* excess - dH/dt */
    if (out >= ZERO || s == 0 || s == column->config->stages - 1)
        return out;
    real_t drawn = -out * mean / mean_volume(here - m, volume, m);
    for (size_t j = 0; j < m; j++)
        rates[s * m + j] += drawn * (x[(s - 1) * m + j] - here[j]) / column->holdup[s];
    return -drawn;
}

/* From the top down, because the conservative form hands the change of liquid flow downwards. Written with
 * the holdup's change taken out: H dc/dt = sum of in-flows times (c_in - c), which equals (3.2a)-(3.2f), as
 * repaired, whenever the flows of the stage balance. */
static void balances(struct column *column, const real_t *x, real_t *rates)
{
    const struct column_config *config = column->config;
    size_t c = config->components, m = c - 1;
    size_t top = config->stages - 1, feed = config->feed_stage - 1;

    for (size_t s = top + 1; s-- > 0;) {
        const real_t *here = &x[s * m];
        const real_t *v = &column->vapour[s * c];
        real_t liquid_in = s == top ? ZERO : column->liquid[s + 1];
        real_t vapour_in = s == 0 ? ZERO : column->vapour_flow[s - 1];
        real_t vapour_out = column->vapour_flow[s];
        real_t feed_in = s == feed ? column->flows.feed : ZERO;

        for (size_t j = 0; j < m; j++) {
            real_t sum = -vapour_out * (v[j] - here[j]);
            if (liquid_in > ZERO)
                sum += liquid_in * (here[m + j] - here[j]);
            if (s > 0)
                sum += vapour_in * (v[j - c] - here[j]);
            if (feed_in > ZERO)
                sum += feed_in * (column->inputs.feed_fraction[j] - here[j]);
            rates[s * m + j] = sum / column->holdup[s];
        }
        if (config->holdup != COLUMN_HOLDUP_CONSERVATIVE)
            continue;
        real_t out =
            conservative_outflow(column, x, s, liquid_in + vapour_in + feed_in - vapour_out, rates);
        if (s == top)
            column->flows.distillate = out - column->flows.reflux;
        else
            column->liquid[s] = out;
        if (s == 0)
            column->flows.bottoms = out;
    }
}

enum err column_rates(struct column *column, const real_t *x, real_t *rates)
{
    enum err err = column_evaluate(column, x);
    if (!err)
        balances(column, x, rates);
    return err;
}

enum err column_rates_again(struct column *column, const real_t *x, real_t *rates)
{
    if (!column->warm)
        return column_rates(column, x, rates);
    internal_flows(column, x);
    stage_flows(column);
    balances(column, x, rates);
    return ERR_OK;
}
