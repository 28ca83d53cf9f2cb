/* Checks that the inputs, disturbances and constants of a column's file are right together. */
#include "columns/column_reader.h"

/* Its entry, or NULL. */
static const struct column_driven *driven(const struct column_reader *r, enum column_drive is)
{
    const struct column_terms *t = &r->file->terms;
    for (size_t k = 0; k < t->n_driven; k++) {
        if (t->driven[k].drive == is) {
            return &t->driven[k];
        }
    }
    return NULL;
}

static bool is_channel(const struct column_reader *r, const struct column_driven *d)
{
    return d != NULL && (size_t)(d - r->file->terms.driven) < r->file->terms.n_inputs;
}

static void check_fractions(struct column_reader *r)
{
    struct column_terms *t = &r->file->terms;
    size_t given = 0;
    bool has[COLUMN_COMPONENTS_MAX] = {false};
    const struct column_driven *first = driven(r, DRIVE_FEED_FRACTION);
    for (size_t k = 0; k < t->n_driven; k++) {
        if (t->driven[k].drive == DRIVE_FEED_FRACTION) {
            has[t->driven[k].component] = true;
            given++;
            if (t->driven[k].unit->measure != first->unit->measure) {
                (void)walk_fail(r->walk,
                                "feed fractions must all be of moles or all of mass (%%w); %s and "
                                "%s differ",
                                r->file->component[first->component].name,
                                r->file->component[t->driven[k].component].name);
            }
        }
    }
    size_t all = r->file->config.components;
    t->every_fraction = given == all;
    for (size_t j = 0; j < all; j++) {
        t->rest = has[j] ? t->rest : j;
    }
    if (given + 1 < all) {
        (void)walk_fail(r->walk,
                        "feed fractions of %zu components are given; must be of all %zu, or of "
                        "all but one, which has the rest",
                        given, all);
    }
}

/* A flow that a level moves is no channel's; the product of a vessel is given where no level moves it. */
static void check_level(struct column_reader *r, const char *vessel, enum column_level_by by,
                        enum column_drive product, enum column_drive internal)
{
    const struct column_driven *p = driven(r, product);
    const char *name = column_drive_name(product);
    if (by == COLUMN_LEVEL_BY_PRODUCT && p != NULL) {
        (void)walk_fail(r->walk, "%s: the level in the %s moves it, so it can be no %s", name,
                        vessel, is_channel(r, p) ? "channel" : "constant");
    } else if (by != COLUMN_LEVEL_BY_PRODUCT && p == NULL) {
        (void)walk_fail(r->walk,
                        "%s is missing: no level moves it, so it must be an input or a constant",
                        name);
    }
    if (by == COLUMN_LEVEL_BY_INTERNAL && is_channel(r, driven(r, internal))) {
        (void)walk_fail(r->walk,
                        "%s: the level in the %s moves it, so it can be no channel; as a constant "
                        "it has its nominal value",
                        column_drive_name(internal), vessel);
    }
}

static void check_levels(struct column_reader *r)
{
    const struct column_config *c = &r->file->config;
    if (c->levels == COLUMN_LEVELS_PERFECT) {
        const enum column_drive product[] = {DRIVE_DISTILLATE, DRIVE_BOTTOMS};
        for (size_t k = 0; k < 2; k++) {
            if (driven(r, product[k]) != NULL) {
                (void)walk_fail(r->walk,
                                "%s: with perfect levels it is what is left over; only with "
                                "levels can it be given",
                                column_drive_name(product[k]));
            }
        }
        return;
    }
    check_level(r, "condenser", c->condenser_level.by, DRIVE_DISTILLATE, DRIVE_REFLUX);
    check_level(r, "reboiler", c->reboiler_level.by, DRIVE_BOTTOMS, DRIVE_BOILUP);
    if (c->reboiler_level.by == COLUMN_LEVEL_BY_INTERNAL && is_channel(r, driven(r, DRIVE_HEAT))) {
        (void)walk_fail(r->walk, "heat: the level in the reboiler moves the boil-up, so it can be "
                                 "no channel; as a constant it has its nominal value");
    }
}

static void exclude(struct column_reader *r, enum column_drive a, enum column_drive b)
{
    if (driven(r, a) != NULL && driven(r, b) != NULL) {
        (void)walk_fail(r->walk, "%s and %s are both given; must be one of them",
                        column_drive_name(a), column_drive_name(b));
    }
}

/* A pure component must boil within the temperature range, whatever the pressure: a stage may come that near to it. */
static void check_boiling(struct column_reader *r)
{
    const struct column_config *c = &r->file->config;
    const struct column_driven *d = driven(r, DRIVE_PRESSURE);
    size_t k = (size_t)(d - r->file->terms.driven);
    bool channel = is_channel(r, d);
    double lowest = (channel ? r->channels[k].lo : d->value) * d->unit->in;
    double highest = (channel ? r->channels[k].hi : d->value) * d->unit->in + c->pressure_drop;
    size_t mark = walk_key(r->walk, "temperature_range");
    for (size_t j = 0; j < c->components; j++) {
        double slope;
        double cold = component_vapour_pressure(&c->component[j], c->temperature_min, &slope);
        double hot = component_vapour_pressure(&c->component[j], c->temperature_max, &slope);
        if (!(cold <= lowest && hot >= highest)) {
            (void)walk_fail(r->walk,
                            "%s has a vapour pressure of %.4g to %.4g Pa in it, the column has "
                            "%.4g to %.4g; must hold the boiling points of all components",
                            c->component[j].name, cold, hot, lowest, highest);
        }
    }
    walk_up(r->walk, mark);
}

/* The nominal values together. */
static void check_nominal(struct column_reader *r)
{
    struct column_inputs in;
    double u[COLUMN_DRIVES_MAX];
    for (size_t i = 0; i < r->n_channels; i++) {
        u[i] = r->channels[i].nominal;
    }
    const char *wrong = column_terms_inputs(&r->file->terms, &r->file->config, u, &in);
    if (wrong != NULL) {
        (void)walk_fail(r->walk, "what is nominal %s", wrong);
    }
}

void column_check_driven(struct column_reader *r)
{
    static const enum column_drive needed[] = {DRIVE_REFLUX, DRIVE_FEED, DRIVE_PRESSURE};
    for (size_t k = 0; k < 3; k++) {
        if (driven(r, needed[k]) == NULL) {
            (void)walk_fail(r->walk,
                            "%s is missing: it must be an input, a disturbance or a constant",
                            column_drive_name(needed[k]));
        }
    }
    exclude(r, DRIVE_HEAT, DRIVE_BOILUP);
    exclude(r, DRIVE_FEED_TEMPERATURE, DRIVE_FEED_QUALITY);
    exclude(r, DRIVE_HEAT_LOSS, DRIVE_BOILUP);
    if (driven(r, DRIVE_HEAT) == NULL && driven(r, DRIVE_BOILUP) == NULL) {
        (void)walk_fail(r->walk, "heat or boilup is missing: one of them must be an input, a "
                                 "disturbance or a constant");
    }
    const struct column_driven *feed = driven(r, DRIVE_FEED);
    if (feed != NULL && feed->unit->measure == MEASURE_VOLUME_FLOW &&
        driven(r, DRIVE_FEED_TEMPERATURE) == NULL) {
        (void)walk_fail(r->walk,
                        "feed is a volume, %s, and needs a feed_temperature; a feed with a "
                        "quality has none",
                        feed->unit->name);
    }
    check_fractions(r);
    check_levels(r);
    if (!r->walk->failed) {
        check_boiling(r);
        check_nominal(r);
    }
}
