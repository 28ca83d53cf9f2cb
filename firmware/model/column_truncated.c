/* A column some of whose temperatures are interpolated. */
#include "model/column_implicit.h"
#include "model/column_inside.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

static enum err own_bubble_point(struct column *column, const real_t *x, size_t s, bool warm)
{
    size_t c = column->config->components;
    real_t full[COLUMN_COMPONENTS_MAX], unused[COLUMN_COMPONENTS_MAX];

    column_full_composition(column, x, s, full);
    return vle_bubble_point(&column->vle, full, column->pressure[s], &column->temperature[s],
                            unused, &column->k[s * c], &column->dk[s * c], warm);
}

/* Frau (6.4) for any number of components: x of the last but one. */
static void close_by_bubble_point(const struct column *column, real_t *x, size_t s)
{
    size_t m = column->config->components - 1, last = m - 1;
    const real_t *k = &column->k[s * (m + 1)];
    real_t *here = &x[s * m], wanted = ONE - k[m], room = ONE;

    for (size_t j = 0; j < last; j++) {
        wanted -= here[j] * (k[j] - k[m]);
        room -= here[j];
    }
    here[last] = column_within(wanted / (k[last] - k[m]), room);
}

/* Stages between first and last, whose own temperatures are known. */
static void interpolate(struct column *column, enum column_between between, real_t *x, size_t first,
                        size_t last)
{
    size_t c = column->config->components;
    real_t pressure[COLUMN_COMPONENTS_MAX], slope[COLUMN_COMPONENTS_MAX];
    real_t low = column->temperature[first], rise = column->temperature[last] - low;

    for (size_t s = first + 1; s < last; s++) {
        real_t part = between == COLUMN_BETWEEN_MEAN ? REAL_C(0.5)
                                                     : (real_t)(s - first) / (real_t)(last - first);
        column->temperature[s] = low + part * rise;
        if (between == COLUMN_BETWEEN_LINE || s == first + 1)
            component_vapour_pressures(column->config->component, c, column->temperature[s],
                                       pressure, slope);
        for (size_t j = 0; j < c; j++) {
            column->k[s * c + j] = pressure[j] / column->pressure[s];
            column->dk[s * c + j] = slope[j] / column->pressure[s];
        }
        close_by_bubble_point(column, x, s);
    }
}

/* The vapour leaving a stage, of which at most a part is not what the equilibrium says: where x was kept within its limits. */
static void take_vapour(struct column *column, const real_t *x, size_t s)
{
    const struct column_config *config = column->config;
    size_t c = config->components;
    real_t full[COLUMN_COMPONENTS_MAX], sum = ZERO, volume = ZERO;
    real_t *v = &column->vapour[s * c];

    column_full_composition(column, x, s, full);
    for (size_t j = 0; j < c; j++) {
        volume += full[j] * column->molar_volume[s * c + j];
        full[j] *= column->k[s * c + j];
        sum += full[j];
    }
    column->holdup[s] = column_nominal_holdup(config, s) / volume;
    for (size_t j = 0; j < c; j++)
        v[j] = s == 0 || s == config->stages - 1
                   ? full[j] / sum
                   : v[j - c] + config->efficiency * (full[j] / sum - v[j - c]);
}

enum err column_truncated_rates(struct column *column, const bool *truncated,
                                enum column_between between, real_t *x, real_t *rates)
{
    size_t top = column->config->stages - 1, end = 0; /* end: the last stage before a region */
    bool warm = column->warm;

    column->warm = false;
    for (size_t i = 0; i < column->n_fractions; i++)
        if (!isfinite(x[i]))
            return ERR_NOT_FINITE;
    for (size_t s = 0; s <= top; s++) {
        if (truncated[s])
            continue;
        enum err err = own_bubble_point(column, x, s, warm);
        if (err)
            return err;
        if (s > end + 1)
            interpolate(column, between, x, end, s);
        end = s;
    }
    for (size_t s = 0; s <= top; s++)
        take_vapour(column, x, s);
    column->warm = true;
    column->feed_efficiency = column->config->efficiency;
    column_flows_at(column, x);
    column_balances(column, x, rates);
    return ERR_OK;
}
