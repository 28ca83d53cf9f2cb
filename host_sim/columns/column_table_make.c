#include "columns/column_table_make.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/text.h"
#include "columns/antoine_fit.h"
#include "model/activity.h"

struct subset {
    size_t index[COLUMN_TABLE_COMPONENTS]; /* in the column, the closing one last */
    size_t n;
};

/* Copies a name as a table can hold it: other characters become underscores, long names are cut. */
static void table_name(const char *from, char name[COLUMN_TABLE_NAME_SIZE])
{
    size_t n = 0;
    for (; n + 1 < COLUMN_TABLE_NAME_SIZE && from[n] != '\0'; n++) {
        name[n] = isalnum((unsigned char)from[n]) ? from[n] : '_';
    }
    name[n] = '\0';
}

static void put_name(const char *from, float *value)
{
    static const char letters[] = COLUMN_TABLE_LETTERS;
    char name[COLUMN_TABLE_NAME_SIZE] = "";
    table_name(from, name);
    for (size_t i = 0; i < COLUMN_TABLE_NAME; i++) {
        unsigned four = 0;
        for (size_t k = 0; k < 4 && 4 * i + k < strlen(name); k++) {
            four |= (unsigned)(strchr(letters, name[4 * i + k]) - letters + 1) << 6 * k;
        }
        value[i] = (float)four;
    }
}

/* ---- which components ---- */

static bool find_component(const struct column_config *c, const char *name, size_t *index,
                           char *err, size_t err_size)
{
    for (size_t j = 0; j < c->components; j++) {
        if (strcmp(c->component[j].name, name) == 0) {
            *index = j;
            return true;
        }
    }
    (void)sim_fail(err, err_size, "%s: no component of this column; there is", name);
    for (size_t j = 0; j < c->components; j++) {
        sim_append(err, err_size, " %s", c->component[j].name);
    }
    return false;
}

static bool add_component(struct subset *subset, const struct column_config *c, const char *name,
                          char *err, size_t err_size)
{
    size_t index;
    if (subset->n == COLUMN_TABLE_COMPONENTS) {
        return sim_fail(err, err_size,
                        "--components: a table has %d components at most; name those it shall have",
                        COLUMN_TABLE_COMPONENTS);
    }
    if (!find_component(c, name, &index, err, err_size)) {
        return false;
    }
    for (size_t k = 0; k < subset->n; k++) {
        if (subset->index[k] == index) {
            return sim_fail(err, err_size, "--components: %s stands there twice", name);
        }
    }
    subset->index[subset->n++] = index;
    return true;
}

static bool close_with(struct subset *subset, const struct column_config *c, const char *name,
                       char *err, size_t err_size)
{
    size_t index;
    if (!find_component(c, name, &index, err, err_size)) {
        return false;
    }
    for (size_t k = 0; k < subset->n; k++) {
        if (subset->index[k] == index) {
            memmove(&subset->index[k], &subset->index[k + 1],
                    (subset->n - 1 - k) * sizeof(subset->index[0]));
            subset->index[subset->n - 1] = index;
            return true;
        }
    }
    return sim_fail(err, err_size, "--closing %s: must be one of --components", name);
}

static bool choose(struct subset *subset, const struct column_config *c,
                   const struct table_wish *wish, char *err, size_t err_size)
{
    char name[64];
    *subset = (struct subset){.n = 0};
    for (size_t j = 0; wish->components == NULL && j < c->components; j++) {
        if (!add_component(subset, c, c->component[j].name, err, err_size)) {
            return false;
        }
    }
    for (const char *at = wish->components; at != NULL && *at != '\0';) {
        size_t n = strcspn(at, ",");
        (void)snprintf(name, sizeof(name), "%.*s", (int)(n < sizeof(name) ? n : sizeof(name) - 1),
                       at);
        if (!add_component(subset, c, name, err, err_size)) {
            return false;
        }
        at += n + (at[n] == ',');
    }
    if (subset->n < 2) {
        return sim_fail(err, err_size, "--components: must name two or more");
    }
    return wish->closing == NULL || close_with(subset, c, wish->closing, err, err_size);
}

/* Fractions of the subset: its closing component has all that the others have not. */
static void lump(const struct subset *subset, const double *full, size_t components, float *share)
{
    double all = 0.0;
    for (size_t j = 0; j < components; j++) {
        all += full[j];
    }
    double rest = 1.0;
    for (size_t k = 0; k + 1 < subset->n; k++) {
        double x = fmin(fmax(full[subset->index[k]] / all, 0.0), 1.0);
        share[k] = (float)x;
        rest -= (double)share[k];
    }
    share[subset->n - 1] = (float)fmax(rest, 0.0);
}

/* ---- what is truncated ---- */

static bool truncate(const char *text, const struct column_config *c, float bits[2], char *err,
                     size_t err_size)
{
    unsigned word[2] = {0, 0};
    for (const char *at = text; at != NULL && *at != '\0';) {
        char *end;
        unsigned long from = strtoul(at, &end, 10), to = from;
        bool good = end != at && isdigit((unsigned char)*at);
        if (good && *end == '-') {
            at = end + 1;
            to = strtoul(at, &end, 10);
            good = end != at && isdigit((unsigned char)*at);
        }
        if (!good || (*end != ',' && *end != '\0') || from < 2 || to < from || to >= c->stages) {
            return sim_fail(err, err_size,
                            "--truncated %s: must be stages from 2 to %zu with commas between "
                            "them, like 2-10,12",
                            text, c->stages - 1);
        }
        for (unsigned long s = from; s <= to; s++) {
            if (s == c->feed_stage) {
                return sim_fail(err, err_size, "--truncated %s: must leave out the feed stage, %lu",
                                text, s);
            }
            word[(s - 1) / COLUMN_TABLE_WORD_STAGES] |= 1u << (s - 1) % COLUMN_TABLE_WORD_STAGES;
        }
        at = end + (*end == ',');
    }
    bits[0] = (float)word[0];
    bits[1] = (float)word[1];
    return true;
}

/* ---- the values ---- */

static void put_config(const struct column_config *c, const struct subset *subset, float *v)
{
    v[COLUMN_TABLE_N_STAGES] = (float)c->stages;
    v[COLUMN_TABLE_N_COMPONENTS] = (float)subset->n;
    v[COLUMN_TABLE_FEED_STAGE] = (float)c->feed_stage;
    v[COLUMN_TABLE_EFFICIENCY] = (float)c->efficiency;
    v[COLUMN_TABLE_PRESSURE_DROP] = (float)c->pressure_drop;
    v[COLUMN_TABLE_HOLDUP] = (float)c->holdup;
    v[COLUMN_TABLE_HOLDUP_REBOILER] = (float)c->holdup_reboiler;
    v[COLUMN_TABLE_HOLDUP_TRAY] = (float)c->holdup_tray;
    v[COLUMN_TABLE_HOLDUP_CONDENSER] = (float)c->holdup_condenser;
    v[COLUMN_TABLE_HOLDUP_BOTTOM_K] = (float)c->holdup_temperature_bottom;
    v[COLUMN_TABLE_HOLDUP_TOP_K] = (float)c->holdup_temperature_top;
    v[COLUMN_TABLE_LOWEST_K] = (float)c->temperature_min;
    v[COLUMN_TABLE_HIGHEST_K] = (float)c->temperature_max;
    v[COLUMN_TABLE_SOFTNESS] = (float)c->limit_softness;
}

static void put_inputs(const struct column_inputs *u, double heat_loss, float *v)
{
    bool quality = u->feed_state == COLUMN_FEED_QUALITY;
    v[COLUMN_TABLE_FEED_BASIS] = (float)u->feed_basis;
    v[COLUMN_TABLE_FEED] = (float)u->feed_flow;
    v[COLUMN_TABLE_FEED_BY] = quality ? 1.0f : 0.0f;
    v[COLUMN_TABLE_FEED_STATE] = (float)(quality ? u->feed_quality : u->feed_temperature);
    v[COLUMN_TABLE_REFLUX_BASIS] = (float)u->reflux_basis;
    v[COLUMN_TABLE_REFLUX] = (float)u->reflux_flow;
    v[COLUMN_TABLE_SUBCOOLING] = (float)u->reflux_subcooling;
    v[COLUMN_TABLE_BOILUP_GIVEN] = u->boilup_given ? 1.0f : 0.0f;
    v[COLUMN_TABLE_HEAT] = (float)(u->boilup_given ? u->boilup : u->heat);
    v[COLUMN_TABLE_HEAT_LOSS] = (float)(u->boilup_given ? 0.0 : heat_loss);
    v[COLUMN_TABLE_PRESSURE] = (float)u->pressure_top;
}

/* Vapour pressures by the three constants of Antoine's equation. */
static bool simplify(const struct column_config *c, const struct subset *subset, const char *text,
                     float *v, char *err, size_t err_size)
{
    double range[2], constants[3];
    if (!antoine_range(text, c, range, err, err_size)) {
        return false;
    }
    for (size_t k = 0; k < subset->n; k++, v += COLUMN_TABLE_C_VALUES) {
        const struct component *p = &c->component[subset->index[k]];
        if (!antoine_fit(p, range, constants)) {
            return sim_fail(err, err_size, "--antoine %s: no three constants fit %s there", text,
                            p->name);
        }
        for (size_t i = 0; i < 7; i++) {
            v[COLUMN_TABLE_C_ANTOINE + i] = i < 3 ? (float)constants[i] : 0.0f;
        }
    }
    return true;
}

static void put_component(const struct component *p, float feed, float *v)
{
    put_name(p->name, v + COLUMN_TABLE_C_NAME);
    for (size_t k = 0; k < 7; k++) {
        v[COLUMN_TABLE_C_ANTOINE + k] = (float)p->antoine[k];
    }
    v[COLUMN_TABLE_C_MASS] = (float)p->molar_mass;
    v[COLUMN_TABLE_C_DENSITY] = (float)p->density[0];
    v[COLUMN_TABLE_C_DENSITY + 1] = (float)p->density[1];
    v[COLUMN_TABLE_C_HEAT] = (float)p->vaporisation_heat;
    v[COLUMN_TABLE_C_BOILING] = (float)p->boiling_point;
    v[COLUMN_TABLE_C_CRITICAL] = (float)p->critical_temperature;
    v[COLUMN_TABLE_C_CAPACITY] = (float)p->heat_capacity;
    v[COLUMN_TABLE_C_FEED] = feed;
}

/* Number of the model in the table: 0 none. */
static unsigned activity_of(const struct column_config *c)
{
    const struct activity *a = c->activity_context;
    return c->activity == NULL ? 0 : a->model == ACTIVITY_WILSON ? 1 : 2;
}

static void put_matrix(const double *from, size_t components, const struct subset *subset, float *v)
{
    for (size_t i = 0; i < subset->n; i++) {
        for (size_t j = 0; j < subset->n; j++) {
            double x = from == NULL ? 0.0 : from[subset->index[i] * components + subset->index[j]];
            v[i * subset->n + j] = i == j ? 0.0f : (float)x;
        }
    }
}

static void put_activity(const struct column_config *c, const struct subset *subset, float *v)
{
    const struct activity *a = c->activity_context;
    unsigned model = activity_of(c);
    const double *const table[] = {model ? a->a : NULL, model ? a->b : NULL,
                                   model == 2 ? a->alpha : NULL};
    for (unsigned k = 0; model != 0 && k < model + 1; k++) {
        put_matrix(table[k], c->components, subset, v + k * subset->n * subset->n);
    }
}

static bool fits(const struct column_config *c, char *err, size_t err_size)
{
    if (c->stages > COLUMN_TABLE_STAGES) {
        return sim_fail(err, err_size, "--table: the column has %zu stages, a table %d at most",
                        c->stages, COLUMN_TABLE_STAGES);
    }
    return c->activity == NULL || c->activity == activity_coefficients ||
           sim_fail(err, err_size, "--table: its activity coefficients are no table");
}

bool column_table_make(const struct column *column, const double *x, const char *title,
                       double heat_loss, const struct table_wish *wish, struct table_lines *lines,
                       char *err, size_t err_size)
{
    const struct column_config *c = column->config;
    struct subset subset;
    float share[COLUMN_TABLE_COMPONENTS], *v = lines->value;
    double full[COLUMN_COMPONENTS_MAX];
    memset(lines, 0, sizeof(*lines));
    if (!fits(c, err, err_size) || !choose(&subset, c, wish, err, err_size) ||
        !truncate(wish->truncated, c, v + COLUMN_TABLE_TRUNCATED, err, err_size)) {
        return false;
    }
    unsigned model = activity_of(c);
    put_name(title, v + COLUMN_TABLE_TITLE);
    put_config(c, &subset, v);
    put_inputs(&column->inputs, heat_loss, v);
    v[COLUMN_TABLE_ACTIVITY] = (float)model;
    float *at = v + COLUMN_TABLE_FIXED;
    lump(&subset, column->inputs.feed_fraction, c->components, share);
    for (size_t k = 0; k < subset.n; k++, at += COLUMN_TABLE_C_VALUES) {
        put_component(&c->component[subset.index[k]], share[k], at);
    }
    if (wish->antoine != NULL &&
        !simplify(c, &subset, wish->antoine, v + COLUMN_TABLE_FIXED, err, err_size)) {
        return false;
    }
    put_activity(c, &subset, at);
    at += COLUMN_TABLE_ACTIVITY_VALUES(model, subset.n);
    for (size_t s = 0; s < c->stages; s++) {
        for (size_t j = 0; j < c->components; j++) {
            full[j] = column_fraction(column, x, s, j);
        }
        lump(&subset, full, c->components, share);
        memcpy(at, share, (subset.n - 1) * sizeof(float));
        at += subset.n - 1;
    }
    for (unsigned i = 0; i < COLUMN_TABLE_MOST; i++) {
        v[i] = v[i] == 0.0f ? 0.0f : v[i]; /* the console knows no negative zero */
    }
    table_close(lines, (unsigned)COLUMN_TABLE_VALUES(c->stages, subset.n, model));
    return true;
}
