/* Reads from a column's file what drives it: inputs, disturbances, and constants in their place. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/text.h"
#include "columns/column_reader.h"
#include "plants/plant_unit.h"

#define FRACTION_MEASURES (MEASURE_MOLE_FRACTION | MEASURE_MASS_FRACTION)

/* In the order of enum column_drive. The feed's temperature is in the file's temperature_range as well. */
static const struct column_quantity drives[DRIVE_COUNT] = {
    [DRIVE_REFLUX] = {"reflux", MEASURE_FLOW, 0, 0.0, 1e12, "flow of the reflux", "always needed"},
    [DRIVE_HEAT] = {"heat", MEASURE_POWER, 0, 0.0, 1e12, "duty of the reboiler; 1 cal = 4.184 J",
                    "this or boilup"},
    [DRIVE_BOILUP] = {"boilup", MEASURE_MOLAR_FLOW, 0, 0.0, 1e12, "vapour from the reboiler",
                      "this or heat"},
    [DRIVE_FEED] = {"feed", MEASURE_FLOW, 0, 0.0, 1e12, "flow of the feed", "always needed"},
    [DRIVE_FEED_FRACTION] = {"feed_fraction", FRACTION_MEASURES, 0, 0.0, 1.0,
                             "fraction of the component in the feed",
                             "of every component, or of every one but one, which has the rest"},
    [DRIVE_FEED_TEMPERATURE] = {"feed_temperature", MEASURE_TEMPERATURE, 0, 50.0, 1000.0,
                                "temperature of the feed, in `temperature_range`",
                                "this or feed_quality"},
    [DRIVE_FEED_QUALITY] = {"feed_quality", MEASURE_NUMBER, 0, 0.0, 2.0,
                            "heat to make vapour of a mole of feed over its heat of vaporisation; "
                            "1 a boiling liquid, 0 a dry vapour, above 1 a cold liquid",
                            "1"},
    [DRIVE_REFLUX_SUBCOOLING] = {"reflux_subcooling", MEASURE_DIFFERENCE, 0, 0.0, 100.0,
                                 "below the drum's bubble point", "0"},
    [DRIVE_HEAT_LOSS] = {"heat_loss", MEASURE_POWER, 0, 0.0, 1e12,
                         "taken off `heat`, which does not fall below 0 by it; only with `heat`",
                         "0"},
    [DRIVE_PRESSURE] = {"pressure", MEASURE_PRESSURE, 0, 100.0, 1e7, "in the condenser",
                        "always needed"},
    [DRIVE_DISTILLATE] = {"distillate", MEASURE_FLOW, 0, 0.0, 1e12, "flow of the distillate",
                          "needed with `levels`, where no level moves it"},
    [DRIVE_BOTTOMS] = {"bottoms", MEASURE_FLOW, 0, 0.0, 1e12, "flow of the bottoms",
                       "needed with `levels`, where no level moves it"},
};

const char *column_drive_name(enum column_drive is)
{
    return drives[is].name;
}

const struct column_quantity *column_drive_row(size_t k)
{
    return k < DRIVE_COUNT ? &drives[k] : NULL;
}

const struct column_unit *column_read_unit(struct column_reader *r, const json_t *object,
                                           unsigned measures, const char *what)
{
    struct json_walk *w = r->walk;
    const char *name = plant_read_unit(w, object);
    const struct column_unit *unit = column_unit_find(name, measures);
    size_t mark = walk_key(w, "unit");
    if (unit == NULL) {
        char names[200];
        column_unit_names(measures, names, sizeof(names));
        (void)walk_fail(w, "\"%s\" is not a unit of %s; must be one of %s", name, what, names);
        unit = column_unit_find("-", MEASURE_NUMBER);
    }
    column_need_unit(r, unit);
    walk_up(w, mark);
    return unit;
}

void column_read_span(struct column_reader *r, const json_t *object, struct plant_channel *c)
{
    struct json_walk *w = r->walk;
    c->lo = walk_field(w, object, column_input_keys, "lo"); /* as of every channel */
    c->hi = walk_field(w, object, column_input_keys, "hi");
    if (!(c->lo < c->hi)) {
        (void)walk_fail(w, "lo, %g, must be below hi, %g", c->lo, c->hi);
    }
}

/* Fails at the present path when a value in a unit is none that the quantity may have. */
static void check_value(struct column_reader *r, const struct column_driven *d, double value)
{
    const struct column_quantity *q = &drives[d->drive];
    const struct column_config *config = &r->file->config;
    bool feed = d->drive == DRIVE_FEED_TEMPERATURE;
    double si = (value + d->unit->offset) * d->unit->in;
    double lo = feed ? config->temperature_min : q->lo;
    double hi = feed ? config->temperature_max : q->hi;
    double to_unit = 1.0 / d->unit->in;
    if (!(si >= lo * (1.0 - 1e-12) && si <= hi * (1.0 + 1e-12))) {
        (void)walk_fail(r->walk, "%g %s is not valid for %s; must be %g to %g%s", value,
                        d->unit->name, q->name, lo * to_unit - d->unit->offset,
                        hi * to_unit - d->unit->offset, feed ? ", by $.temperature_range" : "");
    }
}

/* Asks for the properties of components that a quantity needs whatever its unit. */
static void check_needs(struct column_reader *r, const struct column_driven *d, double largest)
{
    if (d->drive == DRIVE_HEAT) {
        column_need(r, NEED_HEATS, "heat");
    } else if (d->drive == DRIVE_FEED_TEMPERATURE) {
        column_need(r, NEED_CAPACITY, "feed_temperature");
    } else if (d->drive == DRIVE_REFLUX_SUBCOOLING && largest > 0.0) {
        column_need(r, NEED_CAPACITY, "reflux_subcooling");
    }
}

/* The component of a fraction; only a fraction has one. */
static void read_of(struct column_reader *r, const json_t *object, struct column_driven *d)
{
    struct json_walk *w = r->walk;
    if (d->drive != DRIVE_FEED_FRACTION) {
        if (json_object_get(object, "of") != NULL) {
            size_t mark = walk_key(w, "of");
            (void)walk_fail(w, "only a feed_fraction is of a component");
            walk_up(w, mark);
        }
        return;
    }
    const json_t *of = walk_get(w, object, "of", true);
    size_t mark = walk_key(w, "of");
    d->component = column_component(r, of);
    walk_up(w, mark);
}

static const char *drive_name(size_t k)
{
    return drives[k].name;
}

static enum column_drive read_drive(struct column_reader *r, const json_t *object)
{
    return (enum column_drive)walk_choice(r->walk, object, "is", drive_name, DRIVE_COUNT,
                                          "drives no column");
}

/* One more entry, unless it is there already. */
static struct column_driven *add(struct column_reader *r, struct column_driven d)
{
    struct column_terms *t = &r->file->terms;
    for (size_t k = 0; k < t->n_driven; k++) {
        if (t->driven[k].drive == d.drive && t->driven[k].component == d.component) {
            (void)walk_fail(r->walk, "%s%s%s is given twice", drives[d.drive].name,
                            d.drive == DRIVE_FEED_FRACTION ? " of " : "",
                            d.drive == DRIVE_FEED_FRACTION ? r->file->component[d.component].name
                                                           : "");
        }
    }
    if (r->walk->failed || t->n_driven == COLUMN_DRIVES_MAX) {
        return NULL;
    }
    t->driven[t->n_driven] = d;
    t->n_driven++;
    return &t->driven[t->n_driven - 1];
}

static bool is_product(enum column_drive is)
{
    return is == DRIVE_DISTILLATE || is == DRIVE_BOTTOMS;
}

/* Products start with what the nominal state has of them (column_steady_json.c). */
static void read_nominal(struct column_reader *r, const json_t *object, struct plant_channel *c,
                         enum column_drive is)
{
    struct json_walk *w = r->walk;
    if (!is_product(is)) {
        c->nominal = walk_number(w, object, "nominal", c->lo, c->hi, NAN);
        return;
    }
    c->nominal = NAN;
    if (json_object_get(object, "nominal") != NULL) {
        size_t mark = walk_key(w, "nominal");
        (void)walk_fail(w, "%s follows from the nominal state and has no nominal of its own",
                        drives[is].name);
        walk_up(w, mark);
    }
}

static void read_channel(struct column_reader *r, const json_t *object, enum plant_kind kind)
{
    const struct file_key *keys = kind == PLANT_MV ? column_input_keys : column_disturbance_keys;
    struct json_walk *w = r->walk;
    struct plant_channel *c = &r->channels[r->n_channels];
    c->kind = kind;
    c->name = "";
    if (!walk_object(w, object, keys)) {
        return;
    }
    plant_read_name(w, object, r->channels, r->n_channels);
    struct column_driven d = {.drive = read_drive(r, object)};
    read_of(r, object, &d);
    if (w->failed) {
        return;
    }
    d.unit = column_read_unit(r, object, drives[d.drive].measures, drives[d.drive].name);
    c->unit = d.unit->name;
    column_read_span(r, object, c);
    for (int end = 0; end < 2 && !w->failed; end++) {
        size_t mark = walk_key(w, end == 0 ? "lo" : "hi");
        check_value(r, &d, end == 0 ? c->lo : c->hi);
        walk_up(w, mark);
    }
    check_needs(r, &d, c->hi);
    read_nominal(r, object, c, d.drive);
    if (kind == PLANT_MV) {
        c->safe = c->nominal; /* a product's comes later */
        if (json_object_get(object, "safe") != NULL) {
            c->safe = walk_number(w, object, "safe", c->lo, c->hi, NAN);
        }
        c->slew = walk_field(w, object, keys, "slew");
    }
    (void)add(r, d);
    r->n_channels++;
}

void column_read_list(struct column_reader *r, const char *key, enum plant_kind kind,
                      void (*read)(struct column_reader *r, const json_t *object,
                                   enum plant_kind kind))
{
    struct json_walk *w = r->walk;
    bool required = file_key_find(column_keys, key)->lo > 0.0;
    const json_t *list = walk_get(w, r->root, key, required);
    if (list == NULL) {
        return;
    }
    size_t mark = walk_key(w, key);
    size_t n = walk_list(w, list, column_keys, key, "channels");
    for (size_t i = 0; i < n && !w->failed; i++) {
        size_t inner = walk_index(w, i);
        read(r, json_array_get(list, i), kind);
        walk_up(w, inner);
    }
    walk_up(w, mark);
}

static void read_constant(struct column_reader *r, const json_t *object, enum column_drive is)
{
    struct json_walk *w = r->walk;
    if (!walk_object(w, object,
                     is == DRIVE_FEED_FRACTION ? constant_fraction_keys : constant_keys)) {
        return;
    }
    struct column_driven d = {.drive = is};
    read_of(r, object, &d);
    d.unit = column_read_unit(r, object, drives[is].measures, drives[is].name);
    d.value = walk_number(w, object, "value", -COLUMN_BIG, COLUMN_BIG, NAN);
    size_t mark = walk_key(w, "value");
    if (!w->failed) {
        check_value(r, &d, d.value);
    }
    walk_up(w, mark);
    check_needs(r, &d, d.value);
    (void)add(r, d);
}

static void read_constant_fractions(struct column_reader *r, const json_t *list)
{
    struct json_walk *w = r->walk;
    size_t n = walk_array(w, list, 1, COLUMN_COMPONENTS_MAX, "fractions");
    for (size_t i = 0; i < n && !w->failed; i++) {
        size_t inner = walk_index(w, i);
        read_constant(r, json_array_get(list, i), DRIVE_FEED_FRACTION);
        walk_up(w, inner);
    }
}

static void read_constants(struct column_reader *r)
{
    struct json_walk *w = r->walk;
    const json_t *object = walk_get(w, r->root, "constants", false);
    struct file_key known[DRIVE_COUNT + 1] = {{.name = NULL}};
    if (object == NULL) {
        return;
    }
    for (size_t k = 0; k < DRIVE_COUNT; k++) {
        known[k].name = drives[k].name;
    }
    size_t mark = walk_key(w, "constants");
    if (walk_object(w, object, known)) {
        for (size_t k = 0; k < DRIVE_COUNT && !w->failed; k++) { /* in an order of their own */
            const json_t *value = json_object_get(object, drives[k].name);
            size_t inner = walk_key(w, drives[k].name);
            if (value != NULL && k == DRIVE_FEED_FRACTION) {
                read_constant_fractions(r, value);
            } else if (value != NULL) {
                read_constant(r, value, (enum column_drive)k);
            }
            walk_up(w, inner);
        }
    }
    walk_up(w, mark);
}

void column_read_inputs(struct column_reader *r)
{
    column_read_list(r, "inputs", PLANT_MV, read_channel);
    column_read_list(r, "disturbances", PLANT_DISTURBANCE, read_channel);
    r->file->terms.n_inputs = r->n_channels;
    if (!r->walk->failed) {
        read_constants(r);
    }
    if (!r->walk->failed) {
        column_check_driven(r);
    }
}
