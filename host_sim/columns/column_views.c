/* Reads the channels that are seen of a column from its file: outputs, which are measured, and truths, which are logged only. */
#include <math.h>
#include <string.h>

#include "bench/text.h"
#include "columns/column_reader.h"

/* In the order of enum column_sight. */
static const struct column_quantity sights[SIGHT_COUNT] = {
    [SIGHT_TEMPERATURE] = {"temperature", MEASURE_TEMPERATURE, KEY_STAGE | KEY_STAGES, 0.0, 0.0,
                           "of the liquid; with stages their mean", NULL},
    [SIGHT_TEMPERATURE_DIFFERENCE] = {"temperature_difference", MEASURE_DIFFERENCE, KEY_STAGES, 0.0,
                                      0.0, "the first stage less the second", NULL},
    [SIGHT_FRACTION] = {"fraction", MEASURE_MOLE_FRACTION | MEASURE_MASS_FRACTION,
                        KEY_STAGE | KEY_STAGES | KEY_OF, 0.0, 0.0,
                        "in the liquid; with stages their mean", NULL},
    [SIGHT_LOG_FRACTION] = {"log_fraction", MEASURE_NUMBER, KEY_STAGE | KEY_STAGES | KEY_OF, 0.0,
                            0.0,
                            "ln(x / (1 - x)) of that fraction, x held between 1e-12 and 1 - 1e-12",
                            NULL},
    [SIGHT_VAPOUR_FRACTION] = {"vapour_fraction", MEASURE_MOLE_FRACTION, KEY_STAGE | KEY_OF, 0.0,
                               0.0, "in the vapour leaving the stage, 1 to N-1", NULL},
    [SIGHT_LEVEL] = {"level", MEASURE_CAPACITY | MEASURE_AMOUNT, KEY_STAGE, 0.0, 0.0,
                     "% of the capacity (of the ends, with `levels`), or the holdup", NULL},
    [SIGHT_DISTILLATE] = {"distillate", MEASURE_FLOW, 0, 0.0, 0.0, "the stream as it flows", NULL},
    [SIGHT_BOTTOMS] = {"bottoms", MEASURE_FLOW, 0, 0.0, 0.0, "the stream as it flows", NULL},
    [SIGHT_REFLUX] = {"reflux", MEASURE_FLOW, 0, 0.0, 0.0, "the stream as it flows", NULL},
    [SIGHT_BOILUP] = {"boilup", MEASURE_MOLAR_FLOW, 0, 0.0, 0.0, "vapour leaving the reboiler",
                      NULL},
    [SIGHT_LIQUID_FLOW] = {"liquid_flow", MEASURE_MOLAR_FLOW, KEY_STAGE, 0.0, 0.0,
                           "what leaves the stage downwards", NULL},
    [SIGHT_VAPOUR_FLOW] = {"vapour_flow", MEASURE_MOLAR_FLOW, KEY_STAGE, 0.0, 0.0,
                           "what leaves the stage upwards", NULL},
    [SIGHT_HEAT] = {"heat", MEASURE_POWER, 0, 0.0, 0.0,
                    "what boils the liquid, the loss taken off: V_S h(c_1, T_1)", NULL},
    [SIGHT_FEED] = {"feed", MEASURE_FLOW, 0, 0.0, 0.0,
                    "as it is driven: a meter in its line; a unit of the feed's own kind (moles, "
                    "mass or volume)",
                    NULL},
    [SIGHT_FEED_TEMPERATURE] = {"feed_temperature", MEASURE_TEMPERATURE, 0, 0.0, 0.0,
                                "as it is driven: a thermometer in its line", NULL},
    [SIGHT_PRESSURE] = {"pressure", MEASURE_PRESSURE, 0, 0.0, 0.0,
                        "in the condenser, as it is driven: a pressure transmitter", NULL},
};

const struct column_quantity *column_sight_row(size_t k)
{
    return k < SIGHT_COUNT ? &sights[k] : NULL;
}

static const char *sight_name(size_t k)
{
    return sights[k].name;
}

static enum column_sight read_sight(struct column_reader *r, const json_t *object)
{
    return (enum column_sight)walk_choice(r->walk, object, "is", sight_name, SIGHT_COUNT,
                                          "is nothing to be seen of a column");
}

/* The value at the path as a stage's index. */
static size_t stage_at(struct column_reader *r, const json_t *value)
{
    double stages = (double)r->file->config.stages;
    double s = walk_value(r->walk, value, 1.0, stages);
    if (!r->walk->failed && s != floor(s)) {
        (void)walk_fail(r->walk, "%g must be a whole number", s);
    }
    return r->walk->failed ? 0 : (size_t)s - 1;
}

/* Stages that make no difference: twice the same one. */
static void check_stages(struct column_reader *r, const struct column_seen *seen)
{
    for (size_t i = 0; i < seen->n_stages; i++) {
        for (size_t j = 0; j < i; j++) {
            if (seen->stage[i] == seen->stage[j]) {
                (void)walk_fail(r->walk, "stage %zu stands here twice", seen->stage[i] + 1);
            }
        }
    }
}

static void read_stages(struct column_reader *r, const json_t *object, struct column_seen *seen)
{
    struct json_walk *w = r->walk;
    unsigned keys = sights[seen->sight].keys;
    const json_t *one = json_object_get(object, "stage");
    const json_t *list = json_object_get(object, "stages");
    bool wrong_one = one != NULL && (keys & KEY_STAGE) == 0;
    if (wrong_one || (list != NULL && (keys & KEY_STAGES) == 0)) {
        size_t mark = walk_key(w, wrong_one ? "stage" : "stages");
        (void)walk_fail(w, "%s has %s", sights[seen->sight].name,
                        (keys & KEY_STAGES) != 0  ? "no stage, but stages, a list"
                        : (keys & KEY_STAGE) != 0 ? "no stages, but one stage"
                                                  : "no stage");
        walk_up(w, mark);
        return;
    }
    if ((keys & (KEY_STAGE | KEY_STAGES)) == 0 || w->failed) {
        return;
    }
    if (one != NULL && list != NULL) {
        (void)walk_fail(w, "has both stage and stages; must have one");
        return;
    }
    bool difference = seen->sight == SIGHT_TEMPERATURE_DIFFERENCE;
    const char *key = list != NULL || (keys & KEY_STAGE) == 0 ? "stages" : "stage";
    const json_t *value = walk_get(w, object, key, true);
    size_t mark = walk_key(w, key);
    size_t n = value == NULL  ? 0
               : list != NULL ? walk_array(w, list, difference ? 2 : 1,
                                           difference ? 2 : r->file->config.stages, "stages")
                              : 1;
    size_t *stage = walk_memory(w, n + 1, sizeof(*stage));
    for (size_t i = 0; i < n && stage != NULL; i++) {
        size_t inner = list != NULL ? walk_index(w, i) : strlen(w->path);
        stage[i] = stage_at(r, list != NULL ? json_array_get(list, i) : value);
        walk_up(w, inner);
    }
    seen->stage = stage;
    seen->n_stages = n;
    if (!w->failed && stage != NULL) {
        check_stages(r, seen);
    }
    walk_up(w, mark);
}

static void read_of(struct column_reader *r, const json_t *object, struct column_seen *seen)
{
    struct json_walk *w = r->walk;
    bool has = (sights[seen->sight].keys & KEY_OF) != 0;
    const json_t *of = walk_get(w, object, "of", has);
    if (of == NULL) {
        return;
    }
    size_t mark = walk_key(w, "of");
    if (!has) {
        (void)walk_fail(w, "%s is of no component", sights[seen->sight].name);
    }
    bool list = json_is_array(of);
    size_t n = list ? walk_array(w, of, 1, r->file->config.components, "components") : 1;
    size_t *component = walk_memory(w, n + 1, sizeof(*component));
    for (size_t i = 0; i < n && component != NULL; i++) {
        size_t inner = list ? walk_index(w, i) : strlen(w->path);
        component[i] = column_component(r, list ? json_array_get(of, i) : of);
        for (size_t k = 0; k < i && !w->failed; k++) {
            if (component[k] == component[i]) {
                (void)walk_fail(w, "%s stands here twice", r->file->component[component[i]].name);
            }
        }
        walk_up(w, inner);
    }
    seen->component = component;
    seen->n_components = n;
    walk_up(w, mark);
}

/* Ends of the column have no stage above or below that some of these would need. */
static void check_ends(struct column_reader *r, const struct column_seen *seen)
{
    const struct column_config *c = &r->file->config;
    struct json_walk *w = r->walk;
    size_t s = seen->n_stages > 0 ? seen->stage[0] : 0;
    size_t mark = walk_key(w, "stage");
    if ((seen->sight == SIGHT_VAPOUR_FRACTION || seen->sight == SIGHT_VAPOUR_FLOW) &&
        s == c->stages - 1) {
        (void)walk_fail(w, "no vapour leaves the condenser; must be 1 to %zu", c->stages - 1);
    }
    if (seen->sight == SIGHT_LEVEL && seen->unit->measure == MEASURE_CAPACITY &&
        (c->levels == COLUMN_LEVELS_PERFECT || (s != 0 && s != c->stages - 1))) {
        (void)walk_fail(w,
                        "only the reboiler, 1, and the condenser, %zu, have a level in %%, and "
                        "only with levels; others have mol or kmol",
                        c->stages);
    }
    walk_up(w, mark);
}

/* What is seen of the feed is what drives it, in its own kind of unit. */
static void check_feed(struct column_reader *r, const struct column_seen *seen)
{
    enum column_drive drive = seen->sight == SIGHT_FEED ? DRIVE_FEED : DRIVE_FEED_TEMPERATURE;
    const struct column_terms *t = &r->file->terms;
    if (seen->sight != SIGHT_FEED && seen->sight != SIGHT_FEED_TEMPERATURE) {
        return;
    }
    for (size_t k = 0; k < t->n_driven; k++) {
        if (t->driven[k].drive == drive && t->driven[k].unit->measure == seen->unit->measure) {
            return;
        }
    }
    size_t mark = walk_key(r->walk, "unit");
    (void)walk_fail(r->walk, "%s is seen in the kind of unit in which it is driven, and only then",
                    sights[seen->sight].name);
    walk_up(r->walk, mark);
}

/* Whole ticks are asked for when a run begins, whose tick may be another (instruments.c). */
static void read_sensor(struct column_reader *r, const json_t *object, struct plant_channel *c)
{
    struct json_walk *w = r->walk;
    c->lag_s = walk_field(w, object, column_output_keys, "lag_s");
    c->noise = walk_field(w, object, column_output_keys, "noise");
    c->resolution = walk_field(w, object, column_output_keys, "resolution");
    c->every_s = walk_field(w, object, column_output_keys, "every_s");
    c->delay_s = walk_field(w, object, column_output_keys, "delay_s");
}

static void read_view(struct column_reader *r, const json_t *object, enum plant_kind kind)
{
    struct json_walk *w = r->walk;
    struct plant_channel *c = &r->channels[r->n_channels];
    struct column_seen *seen = &r->seen[r->file->terms.n_seen];
    c->kind = kind;
    c->name = "";
    if (!walk_object(w, object, kind == PLANT_MEASUREMENT ? column_output_keys : truth_keys)) {
        return;
    }
    plant_read_name(w, object, r->channels, r->n_channels);
    seen->sight = read_sight(r, object);
    if (w->failed) {
        return;
    }
    read_stages(r, object, seen);
    read_of(r, object, seen);
    if (w->failed) {
        return;
    }
    seen->unit =
        column_read_unit(r, object, sights[seen->sight].measures, sights[seen->sight].name);
    if (seen->sight == SIGHT_HEAT) {
        column_need(r, NEED_HEATS, "heat");
    }
    c->unit = seen->unit->name;
    column_read_span(r, object, c);
    check_ends(r, seen);
    check_feed(r, seen);
    if (kind == PLANT_MEASUREMENT) {
        read_sensor(r, object, c);
    }
    r->n_channels++;
    r->file->terms.n_seen++;
}

void column_read_views(struct column_reader *r)
{
    r->file->terms.seen = r->seen;
    column_read_list(r, "outputs", PLANT_MEASUREMENT, read_view);
    column_read_list(r, "truths", PLANT_INTERNAL, read_view);
}
