/* A column: its inputs, and its outputs at a state. */
#include "model/column_inside.h"

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
    column->n_fractions = n * (c - 1);
    column->n_states = column->n_fractions + (config->hydraulic_time > ZERO ? n - 2 : 0) +
                       (config->levels == COLUMN_LEVELS_HOLDUPS ? 2 : 0);
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
        inputs->feed_flow * column_moles_per_unit(config, inputs->feed_basis, inputs->feed_fraction,
                                                  inputs->feed_temperature);
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

/* Holdups that are states. */
static enum err take_holdups(struct column *column, const real_t *x)
{
    for (size_t s = 0; s < column->config->stages; s++) {
        size_t at = column_holdup_state(column, s);
        if (at == column->n_states)
            continue;
        real_t relative = x[at];
        if (!isfinite(relative))
            return ERR_NOT_FINITE;
        if (relative < COLUMN_HOLDUP_LEAST)
            relative = COLUMN_HOLDUP_LEAST;
        column->holdup[s] = relative * column_nominal_holdup(column->config, s);
    }
    return ERR_OK;
}

/* near: of those of the last time, which are those of the present pressure. */
static enum err bubble_point(struct column *column, size_t s, const real_t *full, bool warm,
                             bool near, real_t *equilibrium)
{
    size_t at = s * column->config->components;
    real_t *t = &column->temperature[s], *k = &column->k[at], *dk = &column->dk[at];

    if (near && vle_bubble_point_near(&column->vle, full, t, equilibrium, k, dk))
        return ERR_OK;
    return vle_bubble_point(&column->vle, full, column->pressure[s], t, equilibrium, k, dk, warm);
}

static enum err evaluate(struct column *column, const real_t *x, bool near)
{
    const struct column_config *config = column->config;
    size_t c = config->components, top = config->stages - 1;
    real_t full[COLUMN_COMPONENTS_MAX], equilibrium[COLUMN_COMPONENTS_MAX];
    bool warm = column->warm;

    column->warm = false; /* until all stages are done */
    for (size_t s = 0; s <= top; s++) {
        real_t volume = ZERO;

        column_full_composition(column, x, s, full);
        for (size_t j = 0; j < c; j++) {
            if (!isfinite(full[j]))
                return ERR_NOT_FINITE;
            volume += full[j] * column->molar_volume[s * c + j];
        }
        enum err err = bubble_point(column, s, full, warm, near && warm, equilibrium);
        if (err)
            return err;
        column->holdup[s] = column_nominal_holdup(config, s) / volume;

        real_t *v = &column->vapour[s * c];
        if (s == 0 || s == top) { /* ideal reboiler; nothing leaves a total condenser as vapour */
            for (size_t j = 0; j < c; j++)
                v[j] = equilibrium[j];
        } else {
            for (size_t j = 0; j < c; j++)
                v[j] = v[j - c] + config->efficiency * (equilibrium[j] - v[j - c]);
        }
    }
    column->warm = true;
    column->feed_efficiency = config->efficiency;
    if (column_holdups_move(column)) {
        enum err err = take_holdups(column, x);
        if (err)
            return err;
    }
    column_flows_at(column, x);
    return ERR_OK;
}

enum err column_evaluate(struct column *column, const real_t *x)
{
    return evaluate(column, x, false);
}

enum err column_evaluate_near(struct column *column, const real_t *x)
{
    return evaluate(column, x, true);
}

enum err column_rates(struct column *column, const real_t *x, real_t *rates)
{
    enum err err = column_evaluate(column, x);
    if (!err)
        column_balances(column, x, rates);
    return err;
}

enum err column_rates_again(struct column *column, const real_t *x, real_t *rates)
{
    if (!column->warm)
        return column_rates(column, x, rates);
    column_flows_at(column, x);
    column_balances(column, x, rates);
    return ERR_OK;
}
