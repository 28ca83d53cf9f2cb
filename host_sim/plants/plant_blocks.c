#include "plants/plant_blocks.h"

#include <math.h>
#include <string.h>

#define STATES_MAX   200
#define ORDER_MAX    50 /* of polynomials */
#define TIME_MAX     1e6
#define TIME_MIN     1e-9
#define DEAD_MAX_S   1e8
#define PERIOD_MIN_S 0.001
#define PERIOD_MAX_S 86400.0
#define STAGES_MAX   3

static double *block_numbers(struct json_walk *w, size_t n)
{
    return walk_memory(w, n + 1, sizeof(double));
}

/* A chain of lags and integrators from the input to the element's output: each stage is
 * x_i' = a_ii x_i + b_i * (what stands before), so that the last state is the unfiltered output. */
struct chain {
    size_t n;
    double a[STAGES_MAX][STAGES_MAX], b[STAGES_MAX];
};

static void feed_stage(struct chain *k, double gain)
{
    if (k->n == 0) {
        k->b[0] = gain;
    } else {
        k->a[k->n][k->n - 1] = gain;
    }
}

static void add_lag(struct chain *k, double lag_s)
{
    feed_stage(k, 1.0 / lag_s);
    k->a[k->n][k->n] = -1.0 / lag_s;
    k->n++;
}

static void add_integrator(struct chain *k, double unit_s)
{
    feed_stage(k, 1.0 / unit_s);
    k->n++;
}

/* 1 / (a2 s^2 + a1 s + 1): the first state is the rate of the second. */
static void add_quadratic(struct chain *k, double a2, double a1)
{
    k->b[0] = 1.0 / a2;
    k->a[0][0] = -a1 / a2;
    k->a[0][1] = -1.0 / a2;
    k->a[1][0] = 1.0;
    k->n = 2;
}

static void read_lags(struct json_walk *w, const json_t *element, double unit_s, struct chain *k)
{
    const json_t *lags = walk_get(w, element, "lags", false);
    if (lags == NULL) {
        return;
    }
    size_t mark = walk_key(w, "lags");
    if (json_is_number(lags)) {
        add_lag(k, unit_s * fmax(walk_value(w, lags, TIME_MIN, TIME_MAX), TIME_MIN));
    }
    size_t n = json_is_number(lags) ? 0 : walk_array(w, lags, 1, 2, "time constants");
    for (size_t i = 0; i < n; i++) {
        size_t inner = walk_index(w, i);
        double lag = walk_value(w, json_array_get(lags, i), TIME_MIN, TIME_MAX);
        add_lag(k, unit_s * fmax(lag, TIME_MIN)); /* a refused one reads as 0 */
        walk_up(w, inner);
    }
    walk_up(w, mark);
}

static void read_quadratic(struct json_walk *w, const json_t *element, double unit_s,
                           struct chain *k)
{
    const json_t *value = walk_get(w, element, "quadratic", false);
    if (value == NULL) {
        return;
    }
    if (json_object_get(element, "lags") != NULL) {
        (void)walk_fail(w, "has lags and quadratic; one of them describes the denominator");
    }
    size_t mark = walk_key(w, "quadratic");
    double a[2] = {1.0, 1.0};
    size_t n = walk_array(w, value, 2, 2, "numbers, a2 and a1 of a2 s^2 + a1 s + 1");
    for (size_t i = 0; i < n; i++) {
        size_t inner = walk_index(w, i);
        double lo = i == 0 ? TIME_MIN * TIME_MIN : -TIME_MAX;
        a[i] = walk_value(w, json_array_get(value, i), lo, TIME_MAX * TIME_MAX);
        walk_up(w, inner);
    }
    walk_up(w, mark);
    if (!w->failed) {
        add_quadratic(k, a[0] * unit_s * unit_s, a[1] * unit_s);
    }
}

static bool read_flag(struct json_walk *w, const json_t *object, const char *key)
{
    const json_t *value = walk_get(w, object, key, false);
    if (value != NULL && !json_is_boolean(value)) {
        size_t mark = walk_key(w, key);
        (void)walk_fail(w, "must be true or false");
        walk_up(w, mark);
    }
    return json_is_true(value);
}

static double dead_time(struct json_walk *w, const json_t *object, double unit_s)
{
    return round(1e9 * unit_s * walk_number(w, object, "dead_time", 0.0, DEAD_MAX_S / unit_s, 0.0));
}

/* gain (zero s + 1) e^(-dead_time s) over lags, quadratic and integrator, into one variant; sets the order. */
static void read_element(struct json_walk *w, const json_t *element, double unit_s, size_t *order,
                         struct linear_variant *v)
{
    struct chain k = {0};
    if (!walk_object(w, element, element_keys)) {
        return;
    }
    double gain = walk_field(w, element, element_keys, "gain");
    double zero = unit_s * walk_field(w, element, element_keys, "zero");
    v->dead_ns = (int64_t)dead_time(w, element, unit_s);
    read_lags(w, element, unit_s, &k);
    read_quadratic(w, element, unit_s, &k);
    if (read_flag(w, element, "integrator")) {
        add_integrator(&k, unit_s);
    }
    if (zero != 0.0 && k.n == 0) {
        (void)walk_fail(w, "has a zero but no lag: as many lags as zeros are needed");
    }
    v->a = block_numbers(w, k.n * k.n);
    v->b = block_numbers(w, k.n);
    v->c = block_numbers(w, k.n);
    v->d = block_numbers(w, 1);
    if (w->failed) {
        return;
    }
    *order = k.n;
    v->d[0] = k.n == 0 ? gain : gain * zero * (k.n == 1 ? k.b[0] : 0.0);
    for (size_t i = 0; i < k.n; i++) {
        memcpy(v->a + i * k.n, k.a[i], k.n * sizeof(double));
        v->b[i] = k.b[i];
        v->c[i] = gain * ((i + 1 == k.n ? 1.0 : 0.0) + zero * k.a[k.n - 1][i]);
    }
}

static size_t parameter_named(struct json_walk *w, const struct linear_model *m, const char *name)
{
    for (size_t i = 0; i < m->n_parameters; i++) {
        if (strcmp(m->channels[m->n_inputs + i].name, name) == 0) {
            return i;
        }
    }
    (void)walk_fail(w, "\"%.20s\" is not the name of a parameter", name);
    return 0;
}

/* {"parameter": NAME, "cases": [element, ...]}: as many as the parameter has values. */
static void read_cases(struct json_walk *w, const json_t *value, double unit_s,
                       const struct linear_model *m, struct linear_block *b)
{
    if (!walk_object(w, value, case_keys)) {
        return;
    }
    b->parameter = parameter_named(w, m, walk_text(w, value, "parameter", 15, NULL));
    const json_t *cases = walk_get(w, value, "cases", true);
    if (w->failed) {
        return;
    }
    size_t mark = walk_key(w, "cases");
    size_t wanted = (size_t)m->channels[m->n_inputs + b->parameter].hi;
    b->n_variants = walk_array(w, cases, wanted, wanted, "elements, one a value of the parameter");
    b->variant = walk_memory(w, b->n_variants + 1, sizeof(*b->variant));
    for (size_t i = 0; i < b->n_variants && b->variant != NULL; i++) {
        size_t order = 0, inner = walk_index(w, i);
        read_element(w, json_array_get(cases, i), unit_s, &order, &b->variant[i]);
        if (i > 0 && order != b->n && !w->failed) {
            (void)walk_fail(w, "is of order %zu, the first of order %zu: states must carry over",
                            order, b->n);
        }
        b->n = order;
        walk_up(w, inner);
    }
    walk_up(w, mark);
}

static void read_block(struct json_walk *w, const json_t *element, double unit_s,
                       const struct linear_model *m, struct linear_block *b)
{
    b->m = 1;
    b->p = 1;
    if (json_object_get(element, "cases") != NULL) {
        read_cases(w, element, unit_s, m, b);
        return;
    }
    b->n_variants = 1;
    b->variant = walk_memory(w, 1, sizeof(*b->variant));
    if (b->variant != NULL) {
        read_element(w, element, unit_s, &b->n, b->variant);
    }
}

static void read_transfer(struct json_walk *w, const json_t *root, double unit_s,
                          struct linear_model *m)
{
    const json_t *elements = walk_get(w, root, "elements", true);
    size_t mark = walk_key(w, "elements");
    m->block = walk_memory(w, m->n_outputs * m->n_inputs + 1, sizeof(*m->block));
    size_t rows =
        w->failed ? 0 : walk_array(w, elements, m->n_outputs, m->n_outputs, "rows, one an output");
    for (size_t i = 0; i < rows; i++) {
        const json_t *row = json_array_get(elements, i);
        size_t in_row = walk_index(w, i);
        size_t n =
            walk_array(w, row, m->n_inputs, m->n_inputs, "elements, one an input and disturbance");
        for (size_t j = 0; j < n; j++) {
            const json_t *element = json_array_get(row, j);
            size_t inner = walk_index(w, j);
            if (!json_is_null(element)) { /* null: no connection */
                m->block[m->n_blocks].input = j;
                m->block[m->n_blocks].output = i;
                read_block(w, element, unit_s, m, &m->block[m->n_blocks]);
                m->n_blocks++;
            }
            walk_up(w, inner);
        }
        walk_up(w, in_row);
    }
    walk_up(w, mark);
}

/* The one block of a plant of matrices or polynomials. */
static struct linear_block *whole_block(struct json_walk *w, struct linear_model *m, size_t n)
{
    struct linear_block *b = walk_memory(w, 1, sizeof(*b));
    struct linear_variant *v = walk_memory(w, 1, sizeof(*v));
    if (b == NULL || v == NULL) {
        return NULL;
    }
    *b = (struct linear_block){.n = n, .m = m->n_inputs, .p = m->n_outputs, .n_variants = 1};
    b->variant = v;
    v->a = block_numbers(w, n * n);
    v->b = block_numbers(w, n * b->m);
    v->c = block_numbers(w, b->p * n);
    v->d = block_numbers(w, b->p * b->m);
    m->block = b;
    m->n_blocks = 1;
    return b;
}

/* Puts a rows x columns matrix into a wider one, beginning at a column. */
static void place(double *to, size_t width, size_t column, const double *from, size_t rows,
                  size_t columns)
{
    for (size_t i = 0; i < rows && from != NULL; i++) {
        memcpy(to + i * width + column, from + i * columns, columns * sizeof(double));
    }
}

/* scale: 1 / seconds of the time unit for rates, 1 for discrete plants. */
static void read_state_space(struct json_walk *w, const json_t *root, double scale,
                             struct linear_model *m)
{
    const json_t *a = walk_get(w, root, "A", true);
    size_t mark = walk_key(w, "A");
    size_t n = w->failed ? 0 : walk_array(w, a, 1, STATES_MAX, "rows");
    walk_up(w, mark);
    size_t d = m->n_inputs - m->n_mvs;
    struct linear_block *b = w->failed ? NULL : whole_block(w, m, n);
    const double *A = walk_matrix(w, root, "A", n, n, scale, true);
    const double *B = walk_matrix(w, root, "B", n, m->n_mvs, scale, true);
    const double *C = walk_matrix(w, root, "C", m->n_outputs, n, 1.0, true);
    const double *D = walk_matrix(w, root, "D", m->n_outputs, m->n_mvs, 1.0, false);
    const double *E = walk_matrix(w, root, "E", n, d, scale, false);
    const double *F = walk_matrix(w, root, "F", m->n_outputs, d, 1.0, false);
    if (d > 0 && json_object_get(root, "E") == NULL && json_object_get(root, "F") == NULL) {
        (void)walk_fail(w, "there are disturbances, but neither E nor F says what they do");
    }
    if (w->failed || b == NULL) {
        return;
    }
    struct linear_variant *v = b->variant;
    place(v->a, n, 0, A, n, n);
    place(v->b, b->m, 0, B, n, m->n_mvs);
    place(v->b, b->m, m->n_mvs, E, n, d);
    place(v->c, n, 0, C, m->n_outputs, n);
    place(v->d, b->m, 0, D, m->n_outputs, m->n_mvs);
    place(v->d, b->m, m->n_mvs, F, m->n_outputs, d);
}

/* An array of matrices under a key; *count of them, from an array that must hold at least `min`. */
static double *read_polynomial(struct json_walk *w, const json_t *root, const char *key,
                               size_t rows, size_t columns, size_t min, size_t *count)
{
    const json_t *value = walk_get(w, root, key, true);
    size_t mark = walk_key(w, key);
    *count = w->failed ? 0 : walk_array(w, value, min, ORDER_MAX, "matrices, one a power of 1/z");
    double *all = block_numbers(w, *count * rows * columns);
    for (size_t k = 0; k < *count && all != NULL; k++) {
        size_t inner = walk_index(w, k);
        (void)walk_rows(w, json_array_get(value, k), rows, columns, 1.0, all + k * rows * columns);
        walk_up(w, inner);
    }
    walk_up(w, mark);
    return all;
}

/* y(k) = -A1 y(k-1) - ... + B0 u(k) + B1 u(k-1) + ...: the block observer form, x_i of p states each:
 * x_i(k+1) = -A_i y(k) + x_i+1(k) + B_i u(k), y = x_1 + B0 u. */
static void read_polynomials(struct json_walk *w, const json_t *root, struct linear_model *m)
{
    size_t p = m->n_outputs, q = m->n_inputs, count_a, count_b;
    const double *A = read_polynomial(w, root, "A", p, p, 1, &count_a);
    const double *B = read_polynomial(w, root, "B", p, q, 1, &count_b);
    size_t order = count_b > count_a + 1 ? count_b - 1 : count_a, n = order * p;
    struct linear_block *b = w->failed ? NULL : whole_block(w, m, n);
    if (w->failed || b == NULL) {
        return;
    }
    struct linear_variant *v = b->variant;
    memcpy(v->d, B, p * q * sizeof(double));
    for (size_t i = 0; i < p; i++) {
        v->c[i * n + i] = 1.0;
    }
    for (size_t k = 0; k < order; k++) {
        for (size_t i = 0; i < p; i++) {
            double *a_row = v->a + (k * p + i) * n, *b_row = v->b + (k * p + i) * q;
            if (k + 1 < order) {
                a_row[(k + 1) * p + i] = 1.0;
            }
            if (k + 1 < count_b) {
                memcpy(b_row, B + ((k + 1) * p + i) * q, q * sizeof(double));
            }
            for (size_t l = 0; l < p && k < count_a; l++) {
                double ail = A[(k * p + i) * p + l];
                a_row[l] -= ail;
                for (size_t j = 0; j < q; j++) { /* -A_i B0 u, the other part of -A_i y */
                    b_row[j] -= ail * B[l * q + j];
                }
            }
        }
    }
}

/* Returns whether a word stands among others with blanks between them. */
static bool has_word(const char *words, const char *word)
{
    size_t n = strlen(word);
    for (const char *at = strstr(words, word); at != NULL; at = strstr(at + 1, word)) {
        if ((at == words || at[-1] == ' ') && (at[n] == ' ' || at[n] == '\0')) {
            return true;
        }
    }
    return false;
}

/* Keys of another kind of model would be ignored without a word; they are refused. */
static void refuse_foreign_keys(struct json_walk *w, const json_t *root, const char *model)
{
    for (const struct file_key *key = linear_keys; key->name != NULL; key++) {
        bool foreign = key->models != NULL && !has_word(key->models, model);
        if (foreign && json_object_get(root, key->name) != NULL) {
            (void)walk_fail(w, "the key \"%s\" has no meaning in a model \"%s\"", key->name, model);
        }
    }
}

bool plant_blocks_read(struct json_walk *w, const json_t *root, double unit_s,
                       struct linear_model *model)
{
    const char *kind = walk_text(w, root, "model", 20, NULL);
    bool sampled = strcmp(kind, "discrete") == 0 || strcmp(kind, "polynomial") == 0;
    if (sampled) {
        double period =
            walk_number(w, root, "period", PERIOD_MIN_S / unit_s, PERIOD_MAX_S / unit_s, NAN);
        model->period_ns = llround(1e9 * unit_s * period);
        if (!w->failed && model->period_ns % 1000000 != 0) {
            (void)walk_fail(w, "period must be a whole number of milliseconds");
        }
    }
    if (strcmp(kind, "transfer") == 0) {
        refuse_foreign_keys(w, root, kind);
        read_transfer(w, root, unit_s, model);
    } else if (strcmp(kind, "state_space") == 0) {
        refuse_foreign_keys(w, root, kind);
        read_state_space(w, root, 1.0 / unit_s, model);
    } else if (strcmp(kind, "discrete") == 0) {
        refuse_foreign_keys(w, root, kind);
        read_state_space(w, root, 1.0, model);
    } else if (strcmp(kind, "polynomial") == 0) {
        refuse_foreign_keys(w, root, kind);
        read_polynomials(w, root, model);
    } else {
        size_t mark = walk_key(w, "model");
        (void)walk_fail(w, "must be transfer, state_space, discrete or polynomial, is \"%s\"",
                        kind);
        walk_up(w, mark);
    }
    return !w->failed;
}
