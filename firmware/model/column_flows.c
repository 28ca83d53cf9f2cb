/* Flows of a column from its inputs, with levels held perfectly. Frau 2.4. */
#include "model/column_inside.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

/* The greater of value and 0, rounded off where value is within width of 0. */
static real_t soft_positive(real_t value, real_t width)
{
    if (value >= width)
        return value;
    if (value <= -width)
        return ZERO;
    return (value + width) * (value + width) / (REAL_C(4.0) * width);
}

/* Never negative: D is confined to 0 .. F, and what D cannot take is taken off the reflux (low side) or the vapour
 * (high side). */
static void perfect_level_flows(struct column *column)
{
    struct column_flows *f = &column->flows;
    real_t soft = column->config->limit_softness, gain = f->reflux_gain;

    column_limit_feed(column, f->boilup_wanted);
    real_t vapour = f->boilup_wanted - f->condensed_by_feed;
    if (vapour < ZERO)
        vapour = ZERO; /* rounding */
    real_t wanted = soft_positive(vapour - gain * f->reflux_wanted, soft * vapour);
    if (vapour <= ZERO)
        wanted = ZERO;
    f->reflux = (vapour - wanted) / gain;
    f->distillate = column_soft_limit(wanted, f->feed, soft);
    if (f->reflux < ZERO)
        f->reflux = ZERO; /* rounding */

    f->condensed_by_reflux = (gain - ONE) * f->reflux;
    f->vapour_enriching = f->distillate + gain * f->reflux;
    f->vapour_stripping = f->vapour_enriching + f->condensed_by_feed;
    if (f->vapour_stripping < ZERO) {
        /* a feed by temperature: rounding. By quality: the limit on D took more than the boil-up */
        if (column->inputs.feed_state == COLUMN_FEED_QUALITY) {
            f->distillate -= f->vapour_stripping;
            f->vapour_enriching -= f->vapour_stripping;
        }
        f->vapour_stripping = ZERO;
    }
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

/* Vapour of the feed tray and above, with the tray's efficiency as it is now. */
static void vapour_above_feed(struct column *column, const real_t *x)
{
    const struct column_config *config = column->config;
    size_t c = config->components, top = config->stages - 1, feed = config->feed_stage - 1;
    real_t full[COLUMN_COMPONENTS_MAX];

    for (size_t s = feed; s < top; s++) {
        real_t e = s == feed ? column->feed_efficiency : config->efficiency;
        real_t *v = &column->vapour[s * c];
        column_full_composition(column, x, s, full);
        for (size_t j = 0; j < c; j++)
            v[j] = v[j - c] + e * (full[j] * column->k[s * c + j] - v[j - c]);
    }
}

/* A feed that flashes where little or no vapour comes from below: what leaves the tray cannot be more of that vapour than
 * there is, the rest is in equilibrium. */
static void flash(struct column *column, const real_t *x)
{
    size_t feed = column->config->feed_stage - 1;
    real_t in = column->vapour_flow[feed - 1], out = column->vapour_flow[feed];
    real_t efficiency = column->config->efficiency;

    if ((ONE - efficiency) * out > in)
        efficiency = ONE - in / out;
    if (efficiency == column->feed_efficiency)
        return;
    column->feed_efficiency = efficiency;
    vapour_above_feed(column, x);
}

void column_flows_with_feed(struct column *column, const real_t *x, real_t part)
{
    column->flows.feed = column->feed_molar * part;
    column->flows.condensed_by_feed = column->flows.condensed_wanted * part;
    perfect_level_flows(column);
    stage_flows(column);
    flash(column, x);
}

void column_flows_at(struct column *column, const real_t *x)
{
    if (COLUMN_HOLDUPS_MOVE && column->config->levels == COLUMN_LEVELS_HOLDUPS)
        column_level_flows(column, x);
    else {
        (void)column_wanted_flows(column, x);
        perfect_level_flows(column);
    }
    stage_flows(column);
    if (COLUMN_HOLDUPS_MOVE && column->config->hydraulic_time > ZERO)
        column_tray_flows(column, x);
    flash(column, x);
}
