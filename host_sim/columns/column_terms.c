#include "columns/column_terms.h"

static real_t greater(real_t a, real_t b)
{
    return a > b ? a : b;
}

static enum column_basis basis(const struct column_unit *unit)
{
    return unit->measure == MEASURE_MASS_FLOW     ? COLUMN_FLOW_MASS
           : unit->measure == MEASURE_VOLUME_FLOW ? COLUMN_FLOW_VOLUME
                                                  : COLUMN_FLOW_MOLAR;
}

/* Value of a driving quantity in its own unit. */
static real_t value_of(const struct column_terms *t, const real_t *u, size_t k)
{
    return k < t->n_inputs ? u[k] : (real_t)t->driven[k].value;
}

/* Fractions of the feed, all of them counted in the unit of the first, in which `whole` is all there is. */
static const char *feed_fractions(const struct column_terms *t, const struct column_config *config,
                                  const real_t *u, real_t *fraction)
{
    real_t part[COLUMN_COMPONENTS_MAX] = {REAL_C(0.0)}, sum = REAL_C(0.0), whole = REAL_C(0.0);
    bool mass = false;

    for (size_t k = 0; k < t->n_driven; k++) {
        const struct column_driven *d = &t->driven[k];
        if (d->drive != DRIVE_FEED_FRACTION)
            continue;
        if (whole == REAL_C(0.0))
            whole = (real_t)d->unit->times;
        mass = d->unit->measure == MEASURE_MASS_FRACTION;
        part[d->component] = value_of(t, u, k) * (whole / (real_t)d->unit->times);
        sum += part[d->component];
    }
    if (t->every_fraction) {
        if (!(sum >= (real_t)COLUMN_FRACTIONS_MIN * whole))
            return "leaves feed fractions that add up to less than 0.1";
        whole = sum;
    } else {
        if (!(sum <= whole * (REAL_C(1.0) + (real_t)COLUMN_FRACTIONS_ROUNDING)))
            return "leaves less than nothing for the component of the feed that has the rest";
        part[t->rest] = greater(whole - sum, REAL_C(0.0));
    }
    if (mass)
        mole_from_mass_fractions(config->component, config->components, part, fraction);
    else
        for (size_t j = 0; j < config->components; j++)
            fraction[j] = part[j] / whole;
    return NULL;
}

const char *column_terms_inputs(const struct column_terms *t, const struct column_config *config,
                                const real_t *u, struct column_inputs *in)
{
    real_t heat = REAL_C(0.0), loss = REAL_C(0.0), heat_in = REAL_C(1.0), loss_in = REAL_C(1.0);

    *in = (struct column_inputs){.feed_state = COLUMN_FEED_QUALITY, .feed_quality = REAL_C(1.0)};
    for (size_t k = 0; k < t->n_driven; k++) {
        const struct column_unit *unit = t->driven[k].unit;
        real_t value = value_of(t, u, k);
        real_t si = (value + (real_t)unit->offset) * (real_t)unit->in;

        switch (t->driven[k].drive) {
        case DRIVE_REFLUX:
            in->reflux_basis = basis(unit);
            in->reflux_flow = si;
            break;
        case DRIVE_HEAT:
            heat = value;
            heat_in = (real_t)unit->in;
            break;
        case DRIVE_HEAT_LOSS:
            loss = value;
            loss_in = (real_t)unit->in;
            break;
        case DRIVE_BOILUP:
            in->boilup_given = true;
            in->boilup = si;
            break;
        case DRIVE_FEED:
            in->feed_basis = basis(unit);
            in->feed_flow = si;
            break;
        case DRIVE_FEED_TEMPERATURE:
            in->feed_state = COLUMN_FEED_TEMPERATURE;
            in->feed_temperature = si;
            break;
        case DRIVE_FEED_QUALITY:
            in->feed_quality = si;
            break;
        case DRIVE_REFLUX_SUBCOOLING:
            in->reflux_subcooling = si;
            break;
        case DRIVE_PRESSURE:
            in->pressure_top = si;
            break;
        case DRIVE_DISTILLATE:
            in->distillate_basis = basis(unit);
            in->distillate_flow = si;
            break;
        case DRIVE_BOTTOMS:
            in->bottoms_basis = basis(unit);
            in->bottoms_flow = si;
            break;
        default: /* the feed's fractions: all together */
            break;
        }
    }
    /* Taken off in the heat's own unit: of two numbers in kW the difference is the exact one. */
    in->heat = greater(heat - loss * (loss_in / heat_in), REAL_C(0.0)) * heat_in;
    return feed_fractions(t, config, u, in->feed_fraction);
}

/* Mean over the stages of the sum over the components. */
static real_t fraction(const struct column_seen *c, const struct column *column, const real_t *x)
{
    const struct column_config *config = column->config;
    bool mass = c->unit->measure == MEASURE_MASS_FRACTION;
    real_t sum = REAL_C(0.0);

    for (size_t s = 0; s < c->n_stages; s++) {
        real_t full[COLUMN_COMPONENTS_MAX];
        for (size_t j = 0; j < config->components; j++)
            full[j] = column_fraction(column, x, c->stage[s], j);
        for (size_t j = 0; j < c->n_components; j++)
            sum += mass ? mass_fraction_of(config->component, config->components, full,
                                           c->component[j])
                        : full[c->component[j]];
    }
    return sum / (real_t)c->n_stages;
}

static real_t log_ratio(real_t x)
{
    const real_t margin = (real_t)COLUMN_LOG_MARGIN;
    x = x < margin ? margin : x > REAL_C(1.0) - margin ? REAL_C(1.0) - margin : x;
    return real_log(x / (REAL_C(1.0) - x));
}

static real_t vapour_fraction(const struct column_seen *c, const struct column *column)
{
    real_t sum = REAL_C(0.0);
    for (size_t j = 0; j < c->n_components; j++)
        sum += column->vapour[c->stage[0] * column->config->components + c->component[j]];
    return sum;
}

/* kg or m3 of a mole of the liquid of a stage at a temperature; 1 for molar flows. */
static real_t mole_size(const struct column_unit *unit, const struct column *column,
                        const real_t *x, size_t stage, real_t temperature)
{
    const struct column_config *config = column->config;
    real_t full[COLUMN_COMPONENTS_MAX];

    if (basis(unit) == COLUMN_FLOW_MOLAR)
        return REAL_C(1.0);
    for (size_t j = 0; j < config->components; j++)
        full[j] = column_fraction(column, x, stage, j);
    return basis(unit) == COLUMN_FLOW_MASS
               ? mixture_molar_mass(config->component, config->components, full)
               : mixture_molar_volume(config->component, config->components, full, temperature);
}

static real_t temperature(const struct column_seen *c, const struct column *column)
{
    real_t sum = REAL_C(0.0);
    for (size_t s = 0; s < c->n_stages; s++)
        sum += column->temperature[c->stage[s]];
    return sum / (real_t)c->n_stages;
}

real_t column_terms_holdup(const struct column *column, const real_t *x, size_t s)
{
    const struct column_config *config = column->config;

    if (column_holdup_state(column, s) == column->n_states)
        return column->holdup[s];
    return column_relative_holdup(column, x, s) * (s == 0 ? config->holdup_reboiler
                                                   : s == config->stages - 1
                                                       ? config->holdup_condenser
                                                       : config->holdup_tray);
}

static real_t level(const struct column_seen *c, const struct column *column, const real_t *x)
{
    size_t s = c->stage[0];

    if (c->unit->measure == MEASURE_CAPACITY)
        return column_relative_holdup(column, x, s) / column->config->level_capacity;
    return column_terms_holdup(column, x, s);
}

/* Heat that becomes vapour in the reboiler, W. */
static real_t boiling_heat(const struct column *column, const real_t *x)
{
    const struct column_config *config = column->config;
    real_t full[COLUMN_COMPONENTS_MAX];

    for (size_t j = 0; j < config->components; j++)
        full[j] = column_fraction(column, x, 0, j);
    return column->flows.vapour_stripping * mixture_vaporisation_heat(config->component,
                                                                      config->components, full,
                                                                      column->temperature[0]);
}

real_t column_terms_value(const struct column_terms *t, const struct column *column,
                          const real_t *x, size_t k)
{
    const struct column_seen *c = &t->seen[k];
    const struct column_unit *unit = c->unit;
    size_t top = column->config->stages - 1;
    real_t value = REAL_C(0.0), size = REAL_C(1.0);
    real_t cooled = column->temperature[top] - column->inputs.reflux_subcooling;

    switch (c->sight) {
    case SIGHT_TEMPERATURE:
        value = temperature(c, column);
        break;
    case SIGHT_TEMPERATURE_DIFFERENCE:
        value = column->temperature[c->stage[0]] - column->temperature[c->stage[1]];
        break;
    case SIGHT_FRACTION:
        value = fraction(c, column, x);
        break;
    case SIGHT_LOG_FRACTION:
        value = log_ratio(fraction(c, column, x));
        break;
    case SIGHT_VAPOUR_FRACTION:
        value = vapour_fraction(c, column);
        break;
    case SIGHT_LEVEL:
        value = level(c, column, x);
        break;
    case SIGHT_DISTILLATE:
        value = column->flows.distillate;
        size = mole_size(unit, column, x, top, cooled);
        break;
    case SIGHT_BOTTOMS:
        value = column->flows.bottoms;
        size = mole_size(unit, column, x, 0, column->temperature[0]);
        break;
    case SIGHT_REFLUX:
        value = column->flows.reflux;
        size = mole_size(unit, column, x, top, cooled);
        break;
    case SIGHT_BOILUP:
        value = column->flows.vapour_stripping;
        break;
    case SIGHT_LIQUID_FLOW:
        value = column->liquid[c->stage[0]];
        break;
    case SIGHT_VAPOUR_FLOW:
        value = column->vapour_flow[c->stage[0]];
        break;
    case SIGHT_HEAT:
        value = boiling_heat(column, x);
        break;
    case SIGHT_FEED: /* as it is metered, which is as it is driven */
        return column->inputs.feed_flow / (real_t)unit->in - (real_t)unit->offset;
    case SIGHT_PRESSURE: /* in the condenser */
        return column->inputs.pressure_top / (real_t)unit->in - (real_t)unit->offset;
    default: /* SIGHT_FEED_TEMPERATURE */
        return column->inputs.feed_temperature / (real_t)unit->in - (real_t)unit->offset;
    }
    return value * (real_t)unit->times / (real_t)unit->before * size / (real_t)unit->after -
           (real_t)unit->offset;
}
