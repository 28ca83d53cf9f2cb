/* Holdups that move: drum and reboiler with their level controllers, trays with their hydraulics. tests/reference/column-equations.md. */
#include "model/column_inside.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

size_t column_holdup_state(const struct column *column, size_t s)
{
    const struct column_config *config = column->config;
    size_t top = config->stages - 1, first = column->n_fractions;
    bool levels = config->levels == COLUMN_LEVELS_HOLDUPS, trays = config->hydraulic_time > ZERO;

    if (s == 0 || s == top ? !levels : !trays)
        return column->n_states;
    if (s == top)
        return column->n_states - 1;
    return first + (trays ? s - (levels ? 0 : 1) : 0);
}

real_t column_relative_holdup(const struct column *column, const real_t *x, size_t s)
{
    size_t at = column_holdup_state(column, s);
    return at < column->n_states ? x[at] : ONE;
}

void column_take_reference(struct column *column, const struct column_flows *nominal)
{
    column->reference = *nominal;
}

/* The part of a flow that a vessel or a tray can still give. */
static real_t still_given(const struct column *column, real_t relative)
{
    real_t part = relative / column->config->limit_softness;
    return part <= ZERO ? ZERO : part >= ONE ? ONE : part;
}

/* mol/s wanted of a flow that a level moves. */
static real_t level_moves(const struct column_level *level, real_t reference, real_t nominal,
                          real_t relative)
{
    real_t flow = reference + level->gain * nominal * (relative - ONE);
    return flow > ZERO ? flow : ZERO;
}

static real_t overflow(const struct column_config *config, real_t nominal, real_t relative)
{
    real_t over = relative - config->level_capacity;
    return over > ZERO ? COLUMN_OVERFLOW_RATE * nominal * over : ZERO;
}

/* Products, wanted and flowing. */
static void products(struct column *column, const real_t *x, real_t drum, real_t reboiler)
{
    const struct column_config *config = column->config;
    const struct column_inputs *in = &column->inputs;
    struct column_flows *f = &column->flows;
    size_t top = config->stages - 1;
    real_t full[COLUMN_COMPONENTS_MAX];

    if (config->condenser_level.by == COLUMN_LEVEL_BY_PRODUCT) {
        f->distillate_wanted = level_moves(&config->condenser_level, column->reference.distillate,
                                           config->holdup_condenser, drum);
    } else {
        column_full_composition(column, x, top, full);
        f->distillate_wanted =
            in->distillate_flow *
            column_moles_per_unit(config, in->distillate_basis, full,
                                  column->temperature[top] - in->reflux_subcooling);
    }
    if (config->reboiler_level.by == COLUMN_LEVEL_BY_PRODUCT) {
        f->bottoms_wanted = level_moves(&config->reboiler_level, column->reference.bottoms,
                                        config->holdup_reboiler, reboiler);
    } else {
        column_full_composition(column, x, 0, full);
        f->bottoms_wanted = in->bottoms_flow * column_moles_per_unit(config, in->bottoms_basis,
                                                                     full, column->temperature[0]);
    }
    f->distillate = still_given(column, drum) * f->distillate_wanted +
                    overflow(config, config->holdup_condenser, drum);
    f->bottoms = still_given(column, reboiler) * f->bottoms_wanted +
                 overflow(config, config->holdup_reboiler, reboiler);
}

void column_level_flows(struct column *column, const real_t *x)
{
    const struct column_config *config = column->config;
    struct column_flows *f = &column->flows;
    size_t top = config->stages - 1;
    real_t drum = column_relative_holdup(column, x, top);
    real_t reboiler = column_relative_holdup(column, x, 0);
    real_t gain = column_wanted_flows(column, x);

    if (config->condenser_level.by == COLUMN_LEVEL_BY_INTERNAL)
        f->reflux_wanted = level_moves(&config->condenser_level, column->reference.reflux,
                                       config->holdup_condenser, drum);
    if (config->reboiler_level.by == COLUMN_LEVEL_BY_INTERNAL)
        f->boilup_wanted = level_moves(&config->reboiler_level, column->reference.vapour_stripping,
                                       config->holdup_reboiler, reboiler);
    f->reflux = still_given(column, drum) * f->reflux_wanted;
    f->vapour_stripping = still_given(column, reboiler) * f->boilup_wanted;
    column_limit_feed(column, f->vapour_stripping);
    f->vapour_enriching = f->vapour_stripping - f->condensed_by_feed;
    if (f->vapour_enriching < ZERO)
        f->vapour_enriching = ZERO; /* rounding */
    f->condensed_by_reflux =
        column_soft_limit((gain - ONE) * f->reflux, f->vapour_enriching, config->limit_softness);
    f->vapour_top = f->vapour_enriching - f->condensed_by_reflux;
    f->liquid_enriching = f->reflux + f->condensed_by_reflux;
    f->liquid_stripping = f->liquid_enriching + f->feed + f->condensed_by_feed;
    products(column, x, drum, reboiler);
}

void column_tray_flows(struct column *column, const real_t *x)
{
    const struct column_config *config = column->config;
    const struct column_flows *reference = &column->reference;
    size_t top = config->stages - 1, feed = config->feed_stage - 1;
    real_t flow_per_holdup = config->holdup_tray / config->hydraulic_time;

    for (size_t s = 1; s < top; s++) {
        real_t relative = column_relative_holdup(column, x, s);
        real_t liquid = s <= feed ? reference->liquid_stripping : reference->liquid_enriching;
        real_t vapour = s <= feed ? reference->vapour_stripping : reference->vapour_enriching;
        real_t flow = liquid + flow_per_holdup * (relative - ONE) +
                      config->hydraulic_vapour * (column->vapour_flow[s - 1] - vapour);
        column->liquid[s] = flow > ZERO ? still_given(column, relative) * flow : ZERO;
    }
    if (config->levels == COLUMN_LEVELS_PERFECT) {
        column->flows.bottoms = column->liquid[1] - column->vapour_flow[0];
        column->liquid[0] = column->flows.bottoms;
    }
}

void column_holdup_rates(const struct column *column, real_t *rates)
{
    const struct column_config *config = column->config;
    size_t top = config->stages - 1, feed = config->feed_stage - 1;

    for (size_t s = 0; s <= top; s++) {
        size_t at = column_holdup_state(column, s);
        if (at == column->n_states)
            continue;
        real_t net = -column->vapour_flow[s] - column->liquid[s];
        if (s > 0)
            net += column->vapour_flow[s - 1];
        if (s < top)
            net += column->liquid[s + 1];
        else
            net -= column->flows.distillate;
        if (s == feed)
            net += column->flows.feed;
        rates[at] = net / column_nominal_holdup(config, s);
    }
}
