/* Components of a column's file, and their activity coefficients. */
#include <math.h>
#include <string.h>

#include "bench/text.h"
#include "columns/column_reader.h"

#define CONSTANTS        7 /* of a vapour pressure */
#define COMPONENT_NAME   ((size_t)15)
#define CONSTANT_LARGEST 1e12

/* Three to seven constants; what is left out is 0. */
static void read_vapour_pressure(struct column_reader *r, const json_t *object, const char *key,
                                 double *constants)
{
    struct json_walk *w = r->walk;
    const json_t *list = walk_get(w, object, key, true);
    if (list == NULL) {
        return;
    }
    size_t mark = walk_key(w, key);
    size_t n = walk_array(w, list, 3, CONSTANTS, "constants");
    for (size_t i = 0; i < n; i++) {
        size_t inner = walk_index(w, i);
        constants[i] = walk_value(w, json_array_get(list, i), -CONSTANT_LARGEST, CONSTANT_LARGEST);
        walk_up(w, inner);
    }
    double coldest = r->file->config.temperature_min;
    if (n > 0 && constants[1] != 0.0 && !(constants[2] + coldest > 0.0)) {
        (void)walk_fail(w, "C + T, %g + %g, must be above 0 over the whole temperature_range",
                        constants[2], coldest);
    }
    walk_up(w, mark);
}

static void read_density(struct column_reader *r, const json_t *object, double *density)
{
    struct json_walk *w = r->walk;
    const struct column_config *config = &r->file->config;
    const json_t *value = walk_get(w, object, "density", false);
    if (value == NULL) {
        return;
    }
    size_t mark = walk_key(w, "density");
    if (json_is_array(value)) {
        size_t n = walk_array(w, value, 2, 2, "numbers");
        for (size_t i = 0; i < n; i++) {
            size_t inner = walk_index(w, i);
            density[i] = walk_value(w, json_array_get(value, i), -1e5, 1e5);
            walk_up(w, inner);
        }
    } else {
        density[0] = walk_value(w, value, 1.0, 30000.0);
    }
    for (int i = 0; i < 2; i++) {
        double t = i == 0 ? config->temperature_min : config->temperature_max;
        double at = density[0] + density[1] * t;
        if (!(at >= 1.0 && at <= 30000.0)) {
            (void)walk_fail(
                w, "is %g kg/m3 at %g K; must be 1 to 30000 over the whole temperature_range", at,
                t);
        }
    }
    walk_up(w, mark);
}

static void read_name(struct column_reader *r, const json_t *object, size_t j)
{
    struct json_walk *w = r->walk;
    struct component *c = r->file->component;
    c[j].name = walk_text(w, object, "name", COMPONENT_NAME, NULL);
    size_t mark = walk_key(w, "name");
    if (!plant_name_allowed(c[j].name)) {
        (void)walk_fail(w, "\"%s\" may only have letters, digits and underscores", c[j].name);
    }
    for (size_t i = 0; i < j; i++) {
        if (strcmp(c[i].name, c[j].name) == 0) {
            (void)walk_fail(w, "\"%s\" is the name of an earlier component too", c[j].name);
        }
    }
    walk_up(w, mark);
}

static void read_heats(struct column_reader *r, const json_t *object, struct component *c)
{
    struct json_walk *w = r->walk;
    double hottest = r->file->config.temperature_max;
    c->vaporisation_heat = walk_field(w, object, component_keys, "vaporisation_heat");
    c->boiling_point = walk_field(w, object, component_keys, "boiling_point");
    c->critical_temperature = walk_field(w, object, component_keys, "critical_temperature");
    c->heat_capacity = walk_field(w, object, component_keys, "heat_capacity");
    if (c->critical_temperature != 0.0 &&
        !(c->critical_temperature > c->boiling_point && c->critical_temperature > hottest)) {
        size_t mark = walk_key(w, "critical_temperature");
        (void)walk_fail(w,
                        "%g K must be above the boiling_point and above the temperature_range, "
                        "which ends at %g K",
                        c->critical_temperature, hottest);
        walk_up(w, mark);
    }
}

/* reference: of a liquid whose relative volatility is 1; NULL unless the file has one. */
static void read_component(struct column_reader *r, const json_t *object, size_t j,
                           const double *reference)
{
    struct json_walk *w = r->walk;
    struct component *c = &r->file->component[j];
    c->name = "";
    if (!walk_object(w, object, component_keys)) {
        return;
    }
    read_name(r, object, j);
    bool relative = json_object_get(object, "relative_volatility") != NULL;
    if (relative && json_object_get(object, "vapour_pressure") != NULL) {
        (void)walk_fail(w, "has both vapour_pressure and relative_volatility; must have one");
    } else if (relative && reference == NULL) {
        (void)walk_fail(w, "a relative_volatility needs $.reference_vapour_pressure");
    } else if (!relative && reference != NULL) {
        (void)walk_fail(w, "the key \"relative_volatility\" is missing; with a "
                           "reference_vapour_pressure every component has one");
    } else if (relative) {
        memcpy(c->antoine, reference, sizeof c->antoine);
        c->antoine[0] += log(walk_field(w, object, component_keys, "relative_volatility"));
    } else {
        read_vapour_pressure(r, object, "vapour_pressure", c->antoine);
    }
    c->molar_mass = walk_field(w, object, component_keys, "molar_mass");
    read_density(r, object, c->density);
    read_heats(r, object, c);
}

void column_read_components(struct column_reader *r)
{
    struct json_walk *w = r->walk;
    double reference[CONSTANTS] = {0};
    bool relative = json_object_get(r->root, "reference_vapour_pressure") != NULL;
    if (relative) {
        read_vapour_pressure(r, r->root, "reference_vapour_pressure", reference);
    }
    const json_t *list = walk_get(w, r->root, "components", true);
    if (list == NULL) {
        return;
    }
    size_t mark = walk_key(w, "components");
    size_t n = walk_list(w, list, column_keys, "components", "components");
    for (size_t j = 0; j < n; j++) {
        size_t inner = walk_index(w, j);
        read_component(r, json_array_get(list, j), j, relative ? reference : NULL);
        walk_up(w, inner);
    }
    walk_up(w, mark);
    r->file->config.component = r->file->component;
    r->file->config.components = n;
}

/* The first property of those needed that a component lacks. */
static const char *lacking(const struct component *c, unsigned needs)
{
    if ((needs & (NEED_MASS | NEED_VOLUME)) != 0 && c->molar_mass == 0.0) {
        return "molar_mass";
    }
    if ((needs & NEED_VOLUME) != 0 && c->density[0] == 0.0 && c->density[1] == 0.0) {
        return "density";
    }
    if ((needs & (NEED_HEATS | NEED_CAPACITY)) != 0) {
        if (c->vaporisation_heat == 0.0) {
            return "vaporisation_heat";
        }
        if (c->boiling_point == 0.0) {
            return "boiling_point";
        }
        if (c->critical_temperature == 0.0) {
            return "critical_temperature";
        }
    }
    return (needs & NEED_CAPACITY) != 0 && c->heat_capacity == 0.0 ? "heat_capacity" : NULL;
}

void column_need(struct column_reader *r, unsigned needs, const char *what)
{
    for (size_t j = 0; j < r->file->config.components; j++) {
        const char *name = lacking(&r->file->component[j], needs);
        if (name != NULL) {
            (void)walk_fail(r->walk, "%s needs the %s of every component; %s has none", what, name,
                            r->file->component[j].name);
        }
    }
}

void column_need_unit(struct column_reader *r, const struct column_unit *unit)
{
    char what[40];
    (void)snprintf(what, sizeof(what), "the unit %s", unit->name);
    if (unit->measure == MEASURE_MASS_FLOW || unit->measure == MEASURE_MASS_FRACTION) {
        column_need(r, NEED_MASS, what);
    } else if (unit->measure == MEASURE_VOLUME_FLOW) {
        column_need(r, NEED_VOLUME, what);
    }
}

size_t column_component(struct column_reader *r, const json_t *name)
{
    struct json_walk *w = r->walk;
    const struct column_config *config = &r->file->config;
    const char *text = json_string_value(name);
    if (w->failed) {
        return 0;
    }
    if (text == NULL) {
        (void)walk_fail(w, "must be the name of a component");
        return 0;
    }
    for (size_t j = 0; j < config->components; j++) {
        if (strcmp(config->component[j].name, text) == 0) {
            return j;
        }
    }
    char names[200] = "";
    for (size_t j = 0; j < config->components; j++) {
        sim_append(names, sizeof(names), " %s", config->component[j].name);
    }
    (void)walk_fail(w, "\"%.40s\" is not a component; there is%s", text, names);
    return 0;
}

/* Checks a table of activity coefficients and names the first wrong entry. */
static void check_activity(struct column_reader *r, const struct activity *table)
{
    const struct column_config *c = &r->file->config;
    struct column_fault fault;
    size_t row, column;
    if (!activity_validate(table, c->temperature_min, c->temperature_max, &fault, &row, &column)) {
        return;
    }
    const char *key = strrchr(fault.field, '.');
    size_t mark = walk_key(r->walk, key != NULL ? key + 1 : fault.field);
    size_t inner = walk_index(r->walk, row);
    (void)walk_index(r->walk, column);
    (void)walk_fail(r->walk, "must be %s", fault.wanted);
    walk_up(r->walk, inner);
    walk_up(r->walk, mark);
}

void column_read_activity(struct column_reader *r)
{
    struct json_walk *w = r->walk;
    struct activity *table = &r->file->activity;
    size_t n = r->file->config.components;
    const json_t *object = walk_get(w, r->root, "activity", false);
    if (object == NULL) {
        return;
    }
    size_t mark = walk_key(w, "activity");
    const char *model = json_string_value(json_object_get(object, "model"));
    bool is_wilson = model != NULL && strcmp(model, "wilson") == 0;
    if (walk_object(w, object, is_wilson ? wilson_keys : nrtl_keys)) {
        model = walk_text(w, object, "model", 20, NULL);
        if (!w->failed && !is_wilson && strcmp(model, "nrtl") != 0) {
            size_t inner = walk_key(w, "model");
            (void)walk_fail(w, "must be wilson or nrtl, is \"%s\"", model);
            walk_up(w, inner);
        }
        *table = (struct activity){.model = is_wilson ? ACTIVITY_WILSON : ACTIVITY_NRTL,
                                   .components = n,
                                   .a = walk_matrix(w, object, "a", n, n, 1.0, true),
                                   .b = walk_matrix(w, object, "b", n, n, 1.0, false)};
        if (!is_wilson) {
            table->alpha = walk_matrix(w, object, "alpha", n, n, 1.0, true);
        }
        if (!w->failed) {
            check_activity(r, table);
        }
        r->file->config.activity = activity_coefficients;
        r->file->config.activity_context = table;
    }
    walk_up(w, mark);
}
