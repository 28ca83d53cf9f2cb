/* Flows of a column as its inputs ask for them, before levels and limits. Frau 2.4. */
#include "model/column_inside.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

real_t column_moles_per_unit(const struct column_config *config, enum column_basis basis,
                             const real_t *x, real_t temperature)
{
    if (basis == COLUMN_FLOW_MASS)
        return ONE / mixture_molar_mass(config->component, config->components, x);
    if (basis == COLUMN_FLOW_VOLUME)
        return ONE / mixture_molar_volume(config->component, config->components, x, temperature);
    return ONE;
}

real_t column_wanted_flows(struct column *column, const real_t *x)
{
    const struct column_config *config = column->config;
    const struct component *component = config->component;
    const struct column_inputs *in = &column->inputs;
    struct column_flows *f = &column->flows;
    size_t c = config->components, top = config->stages - 1, feed = config->feed_stage - 1;
    real_t full[COLUMN_COMPONENTS_MAX], gain = ONE;

    f->feed = column->feed_molar;
    if (in->boilup_given) {
        f->boilup_wanted = in->boilup;
    } else {
        column_full_composition(column, x, 0, full);
        f->boilup_wanted =
            in->heat / mixture_vaporisation_heat(component, c, full, column->temperature[0]);
    }
    if (in->feed_state == COLUMN_FEED_QUALITY) {
        f->condensed_by_feed = (in->feed_quality - ONE) * f->feed;
    } else {
        column_full_composition(column, x, feed, full);
        f->condensed_by_feed =
            f->feed * mixture_heat_capacity(component, c, full) *
            (column->temperature[feed] - in->feed_temperature) /
            mixture_vaporisation_heat(component, c, full, column->temperature[feed]);
    }
    column_full_composition(column, x, top, full);
    real_t t_reflux = column->temperature[top] - in->reflux_subcooling;
    f->reflux_wanted =
        in->reflux_flow * column_moles_per_unit(config, in->reflux_basis, full, t_reflux);
    if (in->reflux_subcooling > ZERO)
        gain = ONE + mixture_heat_capacity(component, c, full) * in->reflux_subcooling /
                         mixture_vaporisation_heat(component, c, full, column->temperature[top]);
    f->condensed_wanted = f->condensed_by_feed;
    f->reflux_gain = gain;
    return gain;
}

void column_limit_feed(struct column *column, real_t vapour)
{
    struct column_flows *f = &column->flows;
    real_t soft = column->config->limit_softness;

    /* By temperature it flashes less than itself by the share that the limit on D may round off; by quality it is what
     * it was said to be, and D takes up the rounding. */
    if (f->condensed_by_feed > ZERO)
        f->condensed_by_feed = column_soft_limit(f->condensed_by_feed, vapour, soft);
    else if (column->inputs.feed_state == COLUMN_FEED_TEMPERATURE)
        f->condensed_by_feed =
            -column_soft_limit(-f->condensed_by_feed, (ONE - soft) * f->feed, soft);
}
