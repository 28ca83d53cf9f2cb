/* Reads the conditions of a column's nominal state and the values that follow from it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/text.h"
#include "columns/column_reader.h"

/* Index of the entry that is seen under this name. */
static size_t find_seen(struct column_reader *r, const char *name)
{
    const struct column_terms *t = &r->file->terms;
    size_t mark = walk_key(r->walk, "channel");
    size_t found = 0;
    while (found < t->n_seen && strcmp(r->channels[t->n_inputs + found].name, name) != 0) {
        found++;
    }
    if (found == t->n_seen) {
        found = 0;
        (void)walk_fail(r->walk, "\"%s\" is neither an output nor a truth", name);
    } else if (t->seen[found].sight == SIGHT_LOG_FRACTION) {
        (void)walk_fail(r->walk, "%s is a logarithm; must be met by the fraction itself", name);
    }
    walk_up(r->walk, mark);
    return found;
}

/* Index of what is trimmed: an input by its name, or a constant by what it is. */
static size_t find_driven(struct column_reader *r, const char *name)
{
    const struct column_terms *t = &r->file->terms;
    size_t mark = walk_key(r->walk, "trim");
    size_t found = t->n_driven;
    for (size_t k = 0; k < t->n_inputs; k++) {
        if (r->channels[k].kind == PLANT_MV && strcmp(r->channels[k].name, name) == 0) {
            found = k;
        }
    }
    for (size_t k = t->n_inputs; k < t->n_driven && found == t->n_driven; k++) {
        enum column_drive is = t->driven[k].drive;
        if ((is == DRIVE_REFLUX || is == DRIVE_HEAT || is == DRIVE_BOILUP) &&
            strcmp(column_drive_name(is), name) == 0) {
            found = k;
        }
    }
    if (found == t->n_driven) {
        found = 0;
        (void)walk_fail(
            r->walk,
            "\"%s\" is not an input, and not a constant reflux, heat or boilup that could be "
            "trimmed",
            name);
    } else if (t->driven[found].drive == DRIVE_DISTILLATE ||
               t->driven[found].drive == DRIVE_BOTTOMS) {
        (void)walk_fail(r->walk, "%s follows from the nominal state and cannot be trimmed", name);
    }
    walk_up(r->walk, mark);
    return found;
}

static void read_trim(struct column_reader *r, const json_t *object)
{
    struct json_walk *w = r->walk;
    const struct column_terms *t = &r->file->terms;
    if (!walk_object(w, object, trim_keys)) {
        return;
    }
    struct column_trim trim = {.seen = find_seen(r, walk_text(w, object, "channel", 40, NULL)),
                               .driven = find_driven(r, walk_text(w, object, "trim", 40, NULL))};
    if (w->failed) {
        return;
    }
    const struct plant_channel *c = &r->channels[t->n_inputs + trim.seen];
    const struct column_seen *seen = &t->seen[trim.seen];
    trim.value = walk_number(w, object, "value", c->lo, c->hi, NAN);
    bool fraction = seen->sight == SIGHT_FRACTION || seen->sight == SIGHT_VAPOUR_FRACTION;
    if (fraction && !(trim.value > 0.0 && trim.value < seen->unit->times)) {
        size_t mark = walk_key(w, "value");
        (void)walk_fail(w, "%g %s must be more than nothing and less than all, %g", trim.value,
                        c->unit, seen->unit->times);
        walk_up(w, mark);
    }
    bool channel = trim.driven < t->n_inputs;
    trim.lo = channel ? r->channels[trim.driven].lo : 0.0;
    trim.hi = channel ? r->channels[trim.driven].hi : COLUMN_BIG;
    for (size_t i = 0; i < r->n_trims; i++) {
        if (r->trim[i].driven == trim.driven) {
            (void)walk_fail(w, "an earlier entry has the same trim");
        } else if (r->trim[i].seen == trim.seen) {
            (void)walk_fail(w, "an earlier entry has the same channel");
        }
    }
    r->trim[r->n_trims] = trim;
    r->n_trims++;
}

static void read_trims(struct column_reader *r)
{
    struct json_walk *w = r->walk;
    const json_t *list = walk_get(w, r->root, "steady_state", false);
    if (list == NULL) {
        return;
    }
    size_t mark = walk_key(w, "steady_state");
    size_t n = walk_array(w, list, 0, r->file->terms.n_driven, "values");
    for (size_t i = 0; i < n && !w->failed; i++) {
        size_t inner = walk_index(w, i);
        read_trim(r, json_array_get(list, i));
        walk_up(w, inner);
    }
    walk_up(w, mark);
}

/* The nominal value of a product that is an input or a disturbance: its flow in the nominal state. */
static void take_product(struct column_reader *r, size_t k, const struct column *column,
                         const double *x)
{
    struct column_terms *t = &r->file->terms;
    struct plant_channel *c = &r->channels[k];
    const struct column_seen seen = {
        .sight = t->driven[k].drive == DRIVE_DISTILLATE ? SIGHT_DISTILLATE : SIGHT_BOTTOMS,
        .unit = t->driven[k].unit};
    const struct column_terms one = {.seen = &seen, .n_seen = 1};
    c->nominal = column_terms_value(&one, column, x, 0);
    c->safe = isnan(c->safe) ? c->nominal : c->safe;
    if (!(c->nominal >= c->lo && c->nominal <= c->hi)) {
        (void)walk_fail(r->walk, "%s is %.6g %s in the nominal state, outside its span, %g to %g",
                        c->name, c->nominal, c->unit, c->lo, c->hi);
    }
}

/* Looks for the nominal state where something hangs on it: trims, and products that are inputs. */
static void find_state(struct column_reader *r)
{
    struct json_walk *w = r->walk;
    struct column_file *file = r->file;
    bool wanted = r->n_trims > 0;
    for (size_t k = 0; k < file->terms.n_inputs; k++) {
        wanted = wanted || isnan(r->channels[k].nominal);
    }
    if (!wanted || w->failed) {
        return;
    }
    char reason[SIM_ERROR_SIZE] = "";
    struct column *column = calloc(1, sizeof(*column));
    double *x = calloc(file->config.stages * file->config.components, sizeof(*x));
    size_t mark = r->n_trims > 0 ? walk_key(w, "steady_state") : strlen(w->path);
    if (column == NULL || x == NULL) {
        (void)walk_fail(w, "out of memory");
    } else if (!column_trim_find(&file->config, &file->terms, r->channels, r->trim, r->n_trims,
                                 column, x, reason, sizeof(reason))) {
        (void)walk_fail(w, "%s", reason);
    }
    walk_up(w, mark);
    for (size_t k = 0; k < file->terms.n_inputs && !w->failed; k++) {
        if (isnan(r->channels[k].nominal)) {
            take_product(r, k, column, x);
        }
    }
    free(column);
    free(x);
}

void column_read_steady_state(struct column_reader *r)
{
    read_trims(r);
    find_state(r);
}
