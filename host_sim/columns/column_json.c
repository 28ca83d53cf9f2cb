#include "columns/column_json.h"

#include <math.h>
#include <string.h>

#include "bench/text.h"
#include "columns/column_reader.h"

/* The text under a key as one of a list (NULL at its end); its place there. */
static size_t read_choice(struct json_walk *w, const json_t *object, const char *key,
                          const char *const *choices)
{
    const char *text = walk_text(w, object, key, 40, NULL);
    size_t k = 0;
    while (choices[k] != NULL && strcmp(choices[k], text) != 0) {
        k++;
    }
    if (choices[k] != NULL || w->failed) {
        return choices[k] != NULL ? k : 0;
    }
    char list[120] = "";
    for (size_t i = 0; choices[i] != NULL; i++) {
        sim_append(list, sizeof(list), "%s%s",
                   i == 0                   ? ""
                   : choices[i + 1] != NULL ? ", "
                                            : " or ",
                   choices[i]);
    }
    size_t mark = walk_key(w, key);
    (void)walk_fail(w, "must be %s, is \"%s\"", list, text);
    walk_up(w, mark);
    return 0;
}

static size_t read_count(struct json_walk *w, const json_t *object, const char *key, size_t lo,
                         size_t hi)
{
    double x = walk_number(w, object, key, (double)lo, (double)hi, NAN);
    if (!w->failed && x != floor(x)) {
        size_t mark = walk_key(w, key);
        (void)walk_fail(w, "%g must be a whole number", x);
        walk_up(w, mark);
    }
    return w->failed ? lo : (size_t)x;
}

/* Two numbers under a key. */
static bool read_pair(struct json_walk *w, const json_t *object, const char *key, double lo,
                      double hi, double *pair)
{
    const json_t *list = walk_get(w, object, key, true);
    if (list == NULL) {
        return false;
    }
    size_t mark = walk_key(w, key);
    size_t n = walk_array(w, list, 2, 2, "numbers");
    for (size_t i = 0; i < n; i++) {
        size_t inner = walk_index(w, i);
        pair[i] = walk_value(w, json_array_get(list, i), lo, hi);
        walk_up(w, inner);
    }
    walk_up(w, mark);
    return !w->failed;
}

static void read_temperature_range(struct column_reader *r)
{
    struct json_walk *w = r->walk;
    double range[2] = {0};
    if (!read_pair(w, r->root, "temperature_range", 50.0, 1000.0, range)) {
        return;
    }
    if (!(range[1] >= range[0] + 1.0)) {
        size_t mark = walk_key(w, "temperature_range");
        (void)walk_fail(w, "must be [lowest, highest] in K, at least 1 K apart; is [%g, %g]",
                        range[0], range[1]);
        walk_up(w, mark);
    }
    r->file->config.temperature_min = range[0];
    r->file->config.temperature_max = range[1];
}

static void read_hydraulics(struct column_reader *r, const json_t *holdup)
{
    struct json_walk *w = r->walk;
    const json_t *object = walk_get(w, holdup, "hydraulics", false);
    if (object == NULL) {
        return;
    }
    size_t mark = walk_key(w, "hydraulics");
    if (r->file->config.holdup != COLUMN_HOLDUP_MOLAR) {
        (void)walk_fail(w, "holdups that move must have the form molar");
    } else if (walk_object(w, object, hydraulics_keys)) {
        r->file->config.hydraulic_time = walk_field(w, object, hydraulics_keys, "time");
        r->file->config.hydraulic_vapour = walk_field(w, object, hydraulics_keys, "vapour");
    }
    walk_up(w, mark);
}

static void read_holdup_temperatures(struct column_reader *r, const json_t *object)
{
    struct json_walk *w = r->walk;
    struct column_config *c = &r->file->config;
    double pair[2] = {0};
    if (c->holdup == COLUMN_HOLDUP_MOLAR) {
        if (json_object_get(object, "temperatures") != NULL) {
            size_t mark = walk_key(w, "temperatures");
            (void)walk_fail(w, "a molar holdup has no temperature");
            walk_up(w, mark);
        }
        return;
    }
    column_need(r, NEED_VOLUME, "a holdup in m3");
    if (read_pair(w, object, "temperatures", c->temperature_min, c->temperature_max, pair)) {
        c->holdup_temperature_bottom = pair[0];
        c->holdup_temperature_top = pair[1];
    }
}

static void read_holdup(struct column_reader *r)
{
    static const char *const forms[] = {"molar", "volumetric", "conservative", NULL};
    struct json_walk *w = r->walk;
    struct column_config *c = &r->file->config;
    const json_t *object = walk_get(w, r->root, "holdup", true);
    if (object == NULL) {
        return;
    }
    size_t mark = walk_key(w, "holdup");
    if (walk_object(w, object, holdup_keys)) {
        c->holdup = (enum column_holdup)read_choice(w, object, "form", forms);
        c->holdup_reboiler = walk_field(w, object, holdup_keys, "reboiler");
        c->holdup_tray = walk_field(w, object, holdup_keys, "tray");
        c->holdup_condenser = walk_field(w, object, holdup_keys, "condenser");
        read_holdup_temperatures(r, object);
        read_hydraulics(r, object);
    }
    walk_up(w, mark);
}

/* by: what may stand there, in the order of enum column_level_by. */
static void read_level(struct column_reader *r, const json_t *levels, const char *key,
                       const char *const *by, struct column_level *level)
{
    struct json_walk *w = r->walk;
    const json_t *object = walk_get(w, levels, key, true);
    if (object == NULL) {
        return;
    }
    size_t mark = walk_key(w, key);
    if (walk_object(w, object, level_keys)) {
        level->by = (enum column_level_by)read_choice(w, object, "by", by);
        if (level->by != COLUMN_LEVEL_FREE) {
            level->gain = walk_field(w, object, level_keys, "gain");
        } else if (json_object_get(object, "gain") != NULL) {
            (void)walk_fail(w, "has a gain, but no flow that it could move");
        }
    }
    walk_up(w, mark);
}

static void read_levels(struct column_reader *r)
{
    static const char *const drum[] = {"none", "distillate", "reflux", NULL};
    static const char *const bottom[] = {"none", "bottoms", "boilup", NULL};
    struct json_walk *w = r->walk;
    struct column_config *c = &r->file->config;
    const json_t *object = walk_get(w, r->root, "levels", false);
    if (object == NULL) {
        return;
    }
    size_t mark = walk_key(w, "levels");
    if (c->holdup != COLUMN_HOLDUP_MOLAR) {
        (void)walk_fail(w, "levels that rise and fall need a holdup of the form molar");
    } else if (walk_object(w, object, levels_keys)) {
        c->levels = COLUMN_LEVELS_HOLDUPS;
        c->level_capacity = walk_field(w, object, levels_keys, "capacity");
        if (c->level_capacity == 1.0) {
            (void)walk_fail(w, "capacity, 1, must be more than 1");
        }
        read_level(r, object, "condenser", drum, &c->condenser_level);
        read_level(r, object, "reboiler", bottom, &c->reboiler_level);
    }
    walk_up(w, mark);
}

static void read_structure(struct column_reader *r)
{
    struct json_walk *w = r->walk;
    struct column_config *c = &r->file->config;
    double version = walk_number(w, r->root, "column", 0.0, 1e6, NAN);
    if (version != 1.0) {
        size_t mark = walk_key(w, "column");
        (void)walk_fail(w, "%g is not a known version of this format; must be 1", version);
        walk_up(w, mark);
    }
    const struct file_key *stages = file_key_find(column_keys, "stages");
    c->stages = read_count(w, r->root, "stages", (size_t)stages->lo, (size_t)stages->hi);
    c->feed_stage = read_count(w, r->root, "feed_stage", 2, c->stages - 2);
    c->efficiency = walk_field(w, r->root, column_keys, "efficiency");
    c->pressure_drop = walk_field(w, r->root, column_keys, "pressure_drop");
    c->limit_softness = walk_field(w, r->root, column_keys, "limit_softness");
    read_temperature_range(r);
    if (!w->failed) {
        column_read_components(r);
    }
    if (!w->failed) {
        column_read_activity(r);
        read_holdup(r);
        read_levels(r);
    }
}

/* Asks the model itself; the reading above should have said it better. */
static void validate(struct column_reader *r)
{
    struct column_fault fault;
    if (!r->walk->failed && column_validate(&r->file->config, &fault)) {
        (void)walk_fail(r->walk, "%s must be %s", fault.field, fault.wanted);
    }
}

/* "mole fractions of TCE (PCE by closure), ..." */
static const char *state_text(struct column_reader *r)
{
    const struct column_config *c = &r->file->config;
    char text[400] = "mole fractions of";
    for (size_t j = 0; j + 1 < c->components; j++) {
        sim_append(text, sizeof(text), "%s %s", j > 0 ? "," : "", c->component[j].name);
    }
    sim_append(text, sizeof(text), " (%s by closure), stage by stage, reboiler first",
               c->component[c->components - 1].name);
    if (c->levels == COLUMN_LEVELS_HOLDUPS || c->hydraulic_time > 0.0) {
        sim_append(text, sizeof(text), "; then holdups that move, over their nominal ones");
    }
    size_t size = strlen(text) + 1;
    char *kept = walk_memory(r->walk, size, 1);
    return kept != NULL ? memcpy(kept, text, size) : "";
}

static void fill_class(struct column_reader *r)
{
    struct column_file *file = r->file;
    struct plant_class *class = r->class;
    file->plant =
        (struct column_plant){.class = class, .config = &file->config, .terms = &file->terms};
    file->states = (struct plant_states)COLUMN_PLANT_STATES(state_text(r));
    class->channels = r->channels;
    class->n_channels = r->n_channels;
    class->column = &file->plant;
    class->states = &file->states;
    class->destroy = column_plant_destroy;
    class->set_input = column_plant_set_input;
    class->advance = column_plant_advance;
    class->value = column_plant_value;
    class->settle = column_plant_settle;
    class->linearise = column_plant_linearise;
}

void column_json_read(struct json_walk *w, const json_t *root, struct plant_class *class)
{
    struct column_reader r = {.walk = w, .root = root, .class = class};
    size_t most = 3 * PLANT_CHANNELS_MAX + COLUMN_TRUTHS_MAX;
    r.file = walk_memory(w, 1, sizeof(*r.file));
    r.channels = walk_memory(w, most, sizeof(*r.channels));
    r.seen = walk_memory(w, most, sizeof(*r.seen));
    if (w->failed || !walk_object(w, root, column_keys)) {
        return;
    }
    plant_read_head(w, root, column_keys, class);
    read_structure(&r);
    validate(&r);
    if (!w->failed) {
        column_read_inputs(&r);
    }
    if (!w->failed) {
        column_read_views(&r);
    }
    if (!w->failed) {
        fill_class(&r);
        column_read_steady_state(&r);
    }
}
