#include "linear/linear_plant.h"

#include "bench/text.h"
#include "linear/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NANO       1e9
#define TIME_MAX_S 9e9 /* what fits 64-bit nanoseconds */
#define STEPS_KEPT                                                                                 \
    4 /* exact steps remembered a variant: a fixed tick needs three lengths at most */
#define SPANS_MAX   1e3 /* a steady state further away than this is an integrator's */
#define LONG_BEFORE INT64_MIN

/* An input's past: value[k] holds from time[k] on; the first one holds since ever. */
struct history {
    int64_t *time;
    double *value;
    size_t n, room;
    int64_t longest_ns; /* dead time of the slowest block that listens */
};

struct step {
    int64_t h; /* 0 = unused */
    double *ad, *bd;
};

struct block_state {
    double *x, *next;
    struct step *step; /* STEPS_KEPT a variant */
    size_t newest;
};

struct plant {
    const struct linear_model *model;
    int64_t time_ns;
    double *input; /* inputs and parameters, engineering units */
    double *output;
    struct history *history;
    struct block_state *state;
    double *u; /* delayed inputs of one block */
};

const struct linear_variant *linear_variant_of(const struct plant *p, const struct linear_block *b)
{
    if (b->n_variants == 1) {
        return &b->variant[0];
    }
    double chosen = p->input[p->model->n_inputs + b->parameter];
    return &b->variant[(size_t)chosen - 1];
}

static double nominal_output(const struct linear_model *m, size_t i)
{
    return m->channels[m->n_inputs + m->n_parameters + i].nominal;
}

/* Index of the value that an input, delayed, has at a time. */
static size_t entry_at(const struct history *h, int64_t t, int64_t dead)
{
    size_t k = h->n - 1;
    while (k > 0 && h->time[k] > t - dead) {
        k--;
    }
    return k;
}

/* Delayed inputs of a block from time t on, and until when they hold, at most to `end`. */
static int64_t delayed_inputs(struct plant *p, const struct linear_block *b, int64_t dead,
                              int64_t t, int64_t end)
{
    for (size_t j = 0; j < b->m; j++) {
        const struct history *h = &p->history[b->input + j];
        size_t k = entry_at(h, t, dead);
        p->u[j] = h->value[k] - p->model->channels[b->input + j].nominal;
        if (k + 1 < h->n && h->time[k + 1] + dead < end) {
            end = h->time[k + 1] + dead;
        }
    }
    return end;
}

static void add_outputs(struct plant *p, const struct linear_block *b, const double *x)
{
    const struct linear_variant *v = linear_variant_of(p, b);
    (void)delayed_inputs(p, b, v->dead_ns, p->time_ns, p->time_ns);
    for (size_t i = 0; i < b->p; i++) {
        double sum = 0.0;
        for (size_t j = 0; j < b->n; j++) {
            sum += v->c[i * b->n + j] * x[j];
        }
        for (size_t j = 0; j < b->m; j++) {
            sum += v->d[i * b->m + j] * p->u[j];
        }
        p->output[b->output + i] += sum;
    }
}

static void find_outputs(struct plant *p)
{
    const struct linear_model *m = p->model;
    for (size_t i = 0; i < m->n_outputs; i++) {
        p->output[i] = nominal_output(m, i);
    }
    for (size_t k = 0; k < m->n_blocks; k++) {
        add_outputs(p, &m->block[k], p->state[k].x);
    }
}

void linear_destroy(struct plant *p)
{
    if (p == NULL) {
        return;
    }
    const struct linear_model *m = p->model;
    for (size_t j = 0; p->history != NULL && j < m->n_inputs; j++) {
        free(p->history[j].time);
        free(p->history[j].value);
    }
    for (size_t k = 0; p->state != NULL && k < m->n_blocks; k++) {
        struct block_state *s = &p->state[k];
        for (size_t i = 0; s->step != NULL && i < m->block[k].n_variants * STEPS_KEPT; i++) {
            free(s->step[i].ad);
            free(s->step[i].bd);
        }
        free(s->step);
        free(s->x);
        free(s->next);
    }
    free(p->history);
    free(p->state);
    free(p->input);
    free(p->output);
    free(p->u);
    free(p);
}

static double *numbers(size_t n)
{
    return calloc(n + 1, sizeof(double)); /* never of size zero */
}

static bool reserve(struct history *h)
{
    if (h->n < h->room) {
        return true;
    }
    size_t room = h->room == 0 ? 16 : 2 * h->room;
    int64_t *time = realloc(h->time, room * sizeof(*time));
    if (time != NULL) {
        h->time = time;
    }
    double *value = realloc(h->value, room * sizeof(*value));
    if (value != NULL) {
        h->value = value;
    }
    if (time == NULL || value == NULL) {
        return false;
    }
    h->room = room;
    return true;
}

static bool create_block(struct plant *p, size_t k)
{
    const struct linear_block *b = &p->model->block[k];
    struct block_state *s = &p->state[k];
    s->x = numbers(b->n);
    s->next = numbers(b->n);
    s->step = calloc(b->n_variants * STEPS_KEPT, sizeof(*s->step));
    if (s->x == NULL || s->next == NULL || s->step == NULL) {
        return false;
    }
    for (size_t i = 0; i < b->n_variants * STEPS_KEPT; i++) {
        s->step[i].ad = numbers(b->n * b->n);
        s->step[i].bd = numbers(b->n * b->m);
        if (s->step[i].ad == NULL || s->step[i].bd == NULL) {
            return false;
        }
    }
    for (size_t v = 0; v < b->n_variants; v++) {
        for (size_t j = 0; j < b->m; j++) {
            struct history *h = &p->history[b->input + j];
            if (b->variant[v].dead_ns > h->longest_ns) {
                h->longest_ns = b->variant[v].dead_ns;
            }
        }
    }
    return true;
}

static bool create_parts(struct plant *p)
{
    const struct linear_model *m = p->model;
    p->input = numbers(m->n_inputs + m->n_parameters);
    p->output = numbers(m->n_outputs);
    p->u = numbers(m->n_inputs);
    p->history = calloc(m->n_inputs + 1, sizeof(*p->history));
    p->state = calloc(m->n_blocks + 1, sizeof(*p->state));
    if (p->input == NULL || p->output == NULL || p->u == NULL || p->history == NULL ||
        p->state == NULL) {
        return false;
    }
    for (size_t i = 0; i < m->n_inputs + m->n_parameters; i++) {
        p->input[i] = m->channels[i].nominal;
    }
    for (size_t j = 0; j < m->n_inputs; j++) {
        struct history *h = &p->history[j];
        if (!reserve(h)) {
            return false;
        }
        h->time[0] = LONG_BEFORE;
        h->value[0] = p->input[j];
        h->n = 1;
    }
    for (size_t k = 0; k < m->n_blocks; k++) {
        if (!create_block(p, k)) {
            return false;
        }
    }
    return true;
}

struct plant *linear_create(const struct linear_model *model, char *err, size_t err_size)
{
    struct plant *p = calloc(1, sizeof(*p));
    if (p != NULL) {
        p->model = model;
    }
    if (p == NULL || !create_parts(p)) {
        linear_destroy(p);
        (void)sim_fail(err, err_size, "%s: out of memory", model->name);
        return NULL;
    }
    find_outputs(p);
    return p;
}

/* Forgets what no block can still feel, so that the past of a long run stays short. */
static void prune(struct history *h, int64_t now)
{
    size_t old = entry_at(h, now, h->longest_ns);
    if (old < 16) {
        return; /* moving a few entries every now and then is cheaper than one at every change */
    }
    memmove(h->time, h->time + old, (h->n - old) * sizeof(*h->time));
    memmove(h->value, h->value + old, (h->n - old) * sizeof(*h->value));
    h->n -= old;
}

static bool remember(struct plant *p, size_t j, double value, char *err, size_t err_size)
{
    struct history *h = &p->history[j];
    prune(h, p->time_ns);
    if (h->time[h->n - 1] < p->time_ns) {
        if (!reserve(h)) {
            return sim_fail(err, err_size, "%s: out of memory", p->model->name);
        }
        h->n++;
    }
    h->time[h->n - 1] = p->time_ns;
    h->value[h->n - 1] = value;
    return true;
}

bool linear_set_input(struct plant *p, size_t channel, double value, char *err, size_t err_size)
{
    const struct linear_model *m = p->model;
    size_t n = m->n_inputs + m->n_parameters;
    if (channel >= n) {
        return sim_fail(err, err_size, "%s: channel %zu is not an input; inputs are 0 to %zu",
                        m->name, channel, n - 1);
    }
    const struct plant_channel *c = &m->channels[channel];
    if (!(value >= c->lo && value <= c->hi)) {
        return sim_fail(err, err_size, "%s: %s = %g %s is outside %g to %g", m->name, c->name,
                        value, c->unit, c->lo, c->hi);
    }
    if (channel >= m->n_inputs && value != floor(value)) {
        return sim_fail(err, err_size, "%s: %s = %g must be a whole number, %g to %g", m->name,
                        c->name, value, c->lo, c->hi);
    }
    if (value == p->input[channel]) {
        return true;
    }
    if (channel < m->n_inputs && !remember(p, channel, value, err, err_size)) {
        return false;
    }
    p->input[channel] = value;
    find_outputs(p);
    return true;
}

/* The exact step of length h of a variant, from those remembered or found anew. */
static const struct step *step_of(struct plant *p, size_t k, const struct linear_variant *v,
                                  int64_t h)
{
    const struct linear_block *b = &p->model->block[k];
    struct block_state *s = &p->state[k];
    struct step *of_variant = s->step + (size_t)(v - b->variant) * STEPS_KEPT;
    for (size_t i = 0; i < STEPS_KEPT; i++) {
        if (of_variant[i].h == h) {
            return &of_variant[i];
        }
    }
    struct step *step = &of_variant[s->newest++ % STEPS_KEPT];
    step->h = h;
    if (!dense_hold(b->n, b->m, v->a, v->b, (double)h / NANO, step->ad, step->bd)) {
        step->h = 0;
        return NULL;
    }
    return step;
}

static void apply(struct plant *p, size_t k, const double *ad, const double *bd)
{
    const struct linear_block *b = &p->model->block[k];
    struct block_state *s = &p->state[k];
    for (size_t i = 0; i < b->n; i++) {
        double sum = 0.0;
        for (size_t j = 0; j < b->n; j++) {
            sum += ad[i * b->n + j] * s->x[j];
        }
        for (size_t j = 0; j < b->m; j++) {
            sum += bd[i * b->m + j] * p->u[j];
        }
        s->next[i] = sum;
    }
    double *keep = s->x;
    s->x = s->next;
    s->next = keep;
}

static bool advance_continuous(struct plant *p, size_t k, int64_t end)
{
    const struct linear_block *b = &p->model->block[k];
    const struct linear_variant *v = linear_variant_of(p, b);
    int64_t t = p->time_ns;
    while (b->n > 0 && t < end) {
        int64_t until = delayed_inputs(p, b, v->dead_ns, t, end);
        const struct step *step = step_of(p, k, v, until - t);
        if (step == NULL) {
            return false;
        }
        apply(p, k, step->ad, step->bd);
        t = until;
    }
    return true;
}

static void advance_discrete(struct plant *p, size_t k, int64_t end)
{
    const struct linear_block *b = &p->model->block[k];
    const struct linear_variant *v = linear_variant_of(p, b);
    for (int64_t t = p->time_ns; t < end; t += p->model->period_ns) {
        (void)delayed_inputs(p, b, v->dead_ns, t, end);
        apply(p, k, v->a, v->b);
    }
}

bool linear_advance(struct plant *p, double t_s, char *err, size_t err_size)
{
    const struct linear_model *m = p->model;
    if (!(t_s >= 0.0 && t_s <= TIME_MAX_S) || llround(t_s * NANO) < p->time_ns) {
        return sim_fail(err, err_size, "%s: time %.9g s must be from %.9g s to %g s", m->name, t_s,
                        (double)p->time_ns / NANO, TIME_MAX_S);
    }
    int64_t end = llround(t_s * NANO);
    if (m->period_ns != 0 && (end - p->time_ns) % m->period_ns != 0) {
        return sim_fail(
            err, err_size,
            "%s: a discrete plant of period %g s cannot advance by %.9g s; the tick must "
            "be a multiple of the period",
            m->name, (double)m->period_ns / NANO, (double)(end - p->time_ns) / NANO);
    }
    for (size_t k = 0; k < m->n_blocks; k++) {
        if (m->period_ns != 0) {
            advance_discrete(p, k, end);
        } else if (!advance_continuous(p, k, end)) {
            return sim_fail(err, err_size, "%s: out of memory, or a step too long for its matrices",
                            m->name);
        }
    }
    p->time_ns = end;
    find_outputs(p);
    return true;
}

double linear_value(const struct plant *p, size_t channel)
{
    const struct linear_model *m = p->model;
    size_t n = m->n_inputs + m->n_parameters;
    if (channel < n) {
        return p->input[channel];
    }
    return channel < n + m->n_outputs ? p->output[channel - n] : NAN;
}

/* Steady state of one block at its present inputs into next; false when it has none. */
static bool settle_block(struct plant *p, size_t k)
{
    const struct linear_block *b = &p->model->block[k];
    const struct linear_variant *v = linear_variant_of(p, b);
    struct block_state *s = &p->state[k];
    double *a = numbers(b->n * b->n);
    bool driven = false;
    for (size_t j = 0; j < b->m; j++) {
        p->u[j] = p->input[b->input + j] - p->model->channels[b->input + j].nominal;
        driven = driven || p->u[j] != 0.0;
    }
    for (size_t i = 0; i < b->n; i++) {
        s->next[i] = 0.0;
        for (size_t j = 0; j < b->m; j++) {
            s->next[i] -= v->b[i * b->m + j] * p->u[j];
        }
        for (size_t j = 0; a != NULL && j < b->n; j++) {
            a[i * b->n + j] = v->a[i * b->n + j] - (p->model->period_ns != 0 && i == j ? 1.0 : 0.0);
        }
    }
    bool good = a != NULL && (!driven || b->n == 0 || dense_solve(b->n, 1, a, s->next));
    free(a);
    return good;
}

bool linear_settle(struct plant *p, char *err, size_t err_size)
{
    const struct linear_model *m = p->model;
    const struct plant_channel *outputs = m->channels + m->n_inputs + m->n_parameters;
    for (size_t k = 0; k < m->n_blocks; k++) {
        if (!settle_block(p, k)) {
            return sim_fail(err, err_size,
                            "%s: no steady state: %s integrates, and an input of it is not at its "
                            "nominal value",
                            m->name, outputs[m->block[k].output].name);
        }
    }
    for (size_t i = 0; i < m->n_outputs; i++) {
        p->output[i] = nominal_output(m, i);
    }
    for (size_t k = 0; k < m->n_blocks; k++) { /* with the states tried, before they are taken */
        const struct linear_block *b = &m->block[k];
        const struct linear_variant *v = linear_variant_of(p, b);
        for (size_t i = 0; i < b->p; i++) {
            for (size_t j = 0; j < b->n; j++) {
                p->output[b->output + i] += v->c[i * b->n + j] * p->state[k].next[j];
            }
        }
    }
    for (size_t i = 0; i < m->n_outputs; i++) {
        double spans = (p->output[i] - outputs[i].nominal) / (outputs[i].hi - outputs[i].lo);
        if (!(fabs(spans) <= SPANS_MAX)) {
            find_outputs(p);
            return sim_fail(err, err_size,
                            "%s: no steady state: %s would end %.3g spans away, it integrates",
                            m->name, outputs[i].name, spans);
        }
    }
    for (size_t k = 0; k < m->n_blocks; k++) {
        memcpy(p->state[k].x, p->state[k].next, m->block[k].n * sizeof(double));
    }
    for (size_t j = 0; j < m->n_inputs; j++) {
        p->history[j].n = 1;
        p->history[j].time[0] = LONG_BEFORE;
        p->history[j].value[0] = p->input[j];
    }
    find_outputs(p);
    return true;
}
