#include "plants/plant_json.h"

#include "bench/text.h"
#include "columns/column_json.h"
#include "linear/linear_plant.h"
#include "plants/plant_blocks.h"
#include "plants/plant_parts.h"
#include "plants/plant_unit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CHANNELS_MAX PLANT_CHANNELS_MAX

struct plant_file {
    struct plant_class class; /* first: the class is the file */
    struct linear_model model;
    json_t *root; /* its texts are pointed at */
    struct walk_memory *memory;
};

static void read_span(struct json_walk *w, const json_t *object, const struct file_key *keys,
                      struct plant_channel *c)
{
    c->unit = plant_read_unit(w, object);
    c->lo = walk_field(w, object, keys, "lo");
    c->hi = walk_field(w, object, keys, "hi");
    if (!(c->lo < c->hi)) {
        (void)walk_fail(w, "lo, %g, must be below hi, %g", c->lo, c->hi);
    }
    c->nominal = walk_number(w, object, "nominal", c->lo, c->hi, NAN);
}

static void read_input(struct json_walk *w, const json_t *object, const struct file_key *keys,
                       struct plant_channel *c)
{
    read_span(w, object, keys, c);
    if (c->kind == PLANT_MV) {
        c->safe = walk_number(w, object, "safe", c->lo, c->hi, c->nominal);
        c->slew = walk_field(w, object, keys, "slew");
    }
}

static void read_parameter(struct json_walk *w, const json_t *object, struct plant_channel *c)
{
    c->unit = "-";
    c->lo = 1.0;
    c->hi = walk_field(w, object, linear_parameter_keys, "values");
    c->nominal = walk_number(w, object, "nominal", 1.0, c->hi, 1.0);
    if (c->hi != floor(c->hi) || c->nominal != floor(c->nominal)) {
        (void)walk_fail(w, "values and nominal must be whole numbers");
    }
}

static void read_output(struct json_walk *w, const json_t *object, struct plant_channel *c)
{
    read_span(w, object, linear_output_keys, c);
    c->lag_s = walk_field(w, object, linear_output_keys, "lag_s");
    c->noise = walk_field(w, object, linear_output_keys, "noise");
    c->resolution = walk_field(w, object, linear_output_keys, "resolution");
}

/* One list of channels with these keys, appended to those before it; returns how many. */
static size_t read_list(struct json_walk *w, const json_t *root, const char *key,
                        enum plant_kind kind, const struct file_key *keys,
                        struct plant_channel *channels, size_t n)
{
    bool required = file_key_find(linear_keys, key)->lo > 0.0;
    const json_t *list = walk_get(w, root, key, required);
    if (list == NULL) {
        return 0;
    }
    size_t mark = walk_key(w, key);
    size_t count = walk_list(w, list, linear_keys, key, "channels");
    for (size_t i = 0; i < count; i++) {
        const json_t *object = json_array_get(list, i);
        size_t inner = walk_index(w, i);
        struct plant_channel *c = &channels[n + i];
        c->kind = kind;
        c->name = "";
        if (walk_object(w, object, keys)) {
            plant_read_name(w, object, channels, n + i);
            if (keys == linear_parameter_keys) {
                read_parameter(w, object, c);
            } else if (kind == PLANT_MEASUREMENT) {
                read_output(w, object, c);
            } else {
                read_input(w, object, keys, c);
            }
        }
        walk_up(w, inner);
    }
    walk_up(w, mark);
    return count;
}

static double time_unit(struct json_walk *w, const json_t *root, const char **name)
{
    *name = walk_text(w, root, "time_unit", 8, "s");
    if (strcmp(*name, "s") == 0) {
        return 1.0;
    }
    if (strcmp(*name, "min") == 0) {
        return 60.0;
    }
    if (strcmp(*name, "h") == 0) {
        return 3600.0;
    }
    size_t mark = walk_key(w, "time_unit");
    (void)walk_fail(w, "must be s, min or h, is \"%s\"", *name);
    walk_up(w, mark);
    return 1.0;
}

static void read_plant(struct json_walk *w, struct plant_file *file)
{
    const json_t *root = file->root;
    struct plant_class *c = &file->class;
    struct linear_model *m = &file->model;
    struct plant_channel *channels = walk_memory(w, 4 * CHANNELS_MAX, sizeof(*channels));
    if (channels == NULL || !walk_object(w, root, linear_keys)) {
        return;
    }
    plant_read_head(w, root, linear_keys, c);
    double unit_s = time_unit(w, root, &c->time_unit);
    size_t n = read_list(w, root, "inputs", PLANT_MV, linear_input_keys, channels, 0);
    m->n_mvs = n;
    n +=
        read_list(w, root, "disturbances", PLANT_DISTURBANCE, linear_disturbance_keys, channels, n);
    m->n_inputs = n;
    m->n_parameters =
        read_list(w, root, "parameters", PLANT_DISTURBANCE, linear_parameter_keys, channels, n);
    n += m->n_parameters;
    m->n_outputs =
        read_list(w, root, "outputs", PLANT_MEASUREMENT, linear_output_keys, channels, n);
    m->name = c->name;
    m->channels = channels;
    if (w->failed || !plant_blocks_read(w, root, unit_s, m)) {
        return;
    }
    c->channels = channels;
    c->n_channels = n + m->n_outputs;
    c->period_s = (double)m->period_ns / 1e9;
    if (m->period_ns != 0 && llround(c->tick_s * 1e9) != m->period_ns) {
        (void)walk_fail(w, "tick_s, %g, must be the period of a discrete plant, %g s", c->tick_s,
                        c->period_s);
    }
    c->model = m;
    c->destroy = linear_destroy;
    c->set_input = linear_set_input;
    c->advance = linear_advance;
    c->value = linear_value;
    c->settle = linear_settle;
}

struct plant_class *plant_json_read(const char *file_name, const char *text, size_t length,
                                    char *err, size_t err_size)
{
    json_error_t problem;
    struct plant_file *file = calloc(1, sizeof(*file));
    if (file == NULL) {
        (void)sim_fail(err, err_size, "%s: out of memory", file_name);
        return NULL;
    }
    file->root = json_loadb(text, length, JSON_REJECT_DUPLICATES, &problem);
    if (file->root == NULL) {
        walk_one_line(problem.text);
        (void)sim_fail(err, err_size, "%s:%d:%d: not JSON: %s", file_name, problem.line,
                       problem.column, problem.text);
        free(file);
        return NULL;
    }
    struct json_walk w = {.file = file_name, .path = "$", .err = err, .err_size = err_size};
    if (json_object_get(file->root, "column") != NULL) {
        column_json_read(&w, file->root, &file->class);
    } else {
        read_plant(&w, file);
    }
    file->memory = w.memory;
    if (w.failed) {
        plant_json_free(&file->class);
        return NULL;
    }
    return &file->class;
}

void plant_json_free(struct plant_class *class)
{
    struct plant_file *file = (struct plant_file *)class;
    if (file != NULL) {
        json_decref(file->root);
        walk_free(file->memory);
        free(file);
    }
}
