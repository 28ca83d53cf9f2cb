#include "linear/linearise.h"

#include "bench/text.h"
#include "linear/linear_plant.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define INPUT_STEP 1e-3 /* of the span: the first distance, see derivative.h */

static double *numbers(size_t n)
{
    return calloc(n + 1, sizeof(double));
}

static bool reserve(struct linearised *l)
{
    l->a = numbers(l->n * l->n);
    l->b = numbers(l->n * l->m);
    l->c = numbers(l->p * l->n);
    l->d = numbers(l->p * l->m);
    l->dead_s = numbers(l->p * l->m);
    return l->a != NULL && l->b != NULL && l->c != NULL && l->d != NULL && l->dead_s != NULL;
}

/* Inputs and outputs among the channels; parameters of linear plants are neither. */
static bool sort_channels(const struct plant_class *class, struct linearised *l)
{
    l->input = calloc(class->n_channels + 1, sizeof(*l->input));
    l->output = calloc(class->n_channels + 1, sizeof(*l->output));
    if (l->input == NULL || l->output == NULL) {
        return false;
    }
    for (size_t i = 0; i < class->n_channels; i++) {
        enum plant_kind kind = class->channels[i].kind;
        if (kind == PLANT_MEASUREMENT || kind == PLANT_INTERNAL) {
            l->output[l->p++] = i;
        } else if (class->model == NULL || i < class->model->n_inputs) {
            l->input[l->m++] = i;
        }
    }
    return true;
}

static void copy_block(struct linearised *l, const struct linear_block *b,
                       const struct linear_variant *v, size_t at)
{
    for (size_t i = 0; i < b->n; i++) {
        memcpy(l->a + (at + i) * l->n + at, v->a + i * b->n, b->n * sizeof(double));
        memcpy(l->b + (at + i) * l->m + b->input, v->b + i * b->m, b->m * sizeof(double));
    }
    for (size_t i = 0; i < b->p; i++) {
        memcpy(l->c + (b->output + i) * l->n + at, v->c + i * b->n, b->n * sizeof(double));
        for (size_t j = 0; j < b->m; j++) {
            l->d[(b->output + i) * l->m + b->input + j] = v->d[i * b->m + j];
            l->dead_s[(b->output + i) * l->m + b->input + j] = (double)v->dead_ns / 1e9;
        }
    }
}

static bool copy_model(const struct plant_class *class, const struct plant *p, struct linearised *l)
{
    const struct linear_model *m = class->model;
    for (size_t k = 0; k < m->n_blocks; k++) {
        l->n += m->block[k].n;
    }
    l->period_s = class->period_s;
    l->state_unit = "-";
    if (!reserve(l)) {
        return false;
    }
    size_t at = 0;
    for (size_t k = 0; k < m->n_blocks; k++) {
        copy_block(l, &m->block[k], linear_variant_of(p, &m->block[k]), at);
        at += m->block[k].n;
    }
    return true;
}

struct differences {
    const struct plant_class *class;
    struct plant *plant;
    struct linearised *l;
    size_t channel; /* of the input that moves */
    bool of_input;
    size_t number; /* of the state or input that moves */
    double *moved, *rates;
};

/* Rates and outputs at a distance along one state or input. */
static bool look(void *context, long double distance, long double *f, char *err, size_t err_size)
{
    struct differences *k = context;
    const struct linearised *l = k->l;
    double to = (double)((k->of_input ? l->u : l->x)[k->number] + distance);

    if (k->of_input) {
        if (!k->class->set_input(k->plant, k->channel, to, err, err_size)) {
            return false;
        }
    } else {
        memcpy(k->moved, l->x, l->n * sizeof(double));
        k->moved[k->number] = to;
        if (!k->class->states->set(k->plant, k->moved, err, err_size)) {
            return false;
        }
    }
    if (!k->class->states->rates(k->plant, k->rates, err, err_size)) {
        return false;
    }
    for (size_t i = 0; i < l->n; i++) {
        f[i] = k->rates[i];
    }
    for (size_t i = 0; i < l->p; i++) {
        f[l->n + i] = k->class->value(k->plant, l->output[i]);
    }
    return true;
}

/* Room and first distance: of a state by what the plant says, of an input by its span. A power of 2, so that x + h - x is h. */
static void set_out(const struct differences *k, struct derivative_task *task)
{
    const struct plant_states *s = k->class->states;
    const struct plant_channel *c = &k->class->channels[k->channel];
    double at = (k->of_input ? k->l->u : k->l->x)[k->number];
    double lo = k->of_input ? c->lo : s->lo, hi = k->of_input ? c->hi : s->hi;
    double step = k->of_input ? INPUT_STEP * (hi - lo) : s->step * fmax(1.0, fabs(at));

    task->step = exp2(floor(log2(step)));
    task->below = at - lo;
    task->above = hi - at;
}

static bool along_all(struct differences *k, bool of_input, struct derivative_task *task,
                      long double *work, double *slope, char *err, size_t err_size)
{
    struct linearised *l = k->l;

    k->of_input = of_input;
    for (k->number = 0; k->number < (of_input ? l->m : l->n); k->number++) {
        struct derivative_found found;
        k->channel = of_input ? l->input[k->number] : 0;
        set_out(k, task);
        bool good = derivative_take(task, work, slope, &found, err, err_size);
        good = (of_input ? k->class->set_input(k->plant, k->channel, l->u[k->number], err, err_size)
                         : k->class->states->set(k->plant, l->x, err, err_size)) &&
               good;
        if (!good) {
            return false;
        }
        linearised_column(l, of_input, k->number, slope);
        linearised_note(l, k->class, of_input, k->number, &found);
    }
    return true;
}

static bool differentiate(const struct plant_class *class, struct plant *p, struct linearised *l,
                          char *err, size_t err_size)
{
    size_t rows = l->n + l->p;
    struct differences k = {.class = class, .plant = p, .l = l};
    struct derivative_task task = {
        .n = rows, .first = l->n, .values = look, .context = &k, .rounding = DBL_EPSILON};
    long double *work = calloc(DERIVATIVE_WORK * rows + 1, sizeof(*work));
    double *slope = numbers(rows);

    k.moved = numbers(l->n);
    k.rates = numbers(l->n);
    bool good = work != NULL && slope != NULL && k.moved != NULL && k.rates != NULL;
    if (!good) {
        (void)sim_fail(err, err_size, "%s: out of memory", class->name);
    }
    good = good && along_all(&k, false, &task, work, slope, err, err_size) &&
           along_all(&k, true, &task, work, slope, err, err_size);
    free(work);
    free(slope);
    free(k.moved);
    free(k.rates);
    return good;
}

/* Sizes and point of a plant that shows its states. */
static bool look_around(const struct plant_class *class, struct plant *p, struct linearised *l)
{
    l->n = class->states->count(p);
    l->state_unit = class->states->unit;
    l->x = numbers(l->n);
    l->u = numbers(l->m);
    l->y = numbers(l->p);
    if (!reserve(l) || l->x == NULL || l->u == NULL || l->y == NULL) {
        return false;
    }
    class->states->get(p, l->x);
    for (size_t j = 0; j < l->m; j++) {
        l->u[j] = class->value(p, l->input[j]);
    }
    for (size_t i = 0; i < l->p; i++) {
        l->y[i] = class->value(p, l->output[i]);
    }
    return true;
}

bool linearise(const struct plant_class *class, struct plant *p, struct linearised *l, char *err,
               size_t err_size)
{
    *l = (struct linearised){0};
    bool good = sort_channels(class, l);
    if (good && class->model != NULL) {
        good = copy_model(class, p, l) || sim_fail(err, err_size, "%s: out of memory", class->name);
    } else if (good && class->states != NULL) {
        good =
            look_around(class, p, l) || sim_fail(err, err_size, "%s: out of memory", class->name);
        good = good && (class->linearise != NULL ? class->linearise(p, l, err, err_size)
                                                 : differentiate(class, p, l, err, err_size));
    } else {
        good = sim_fail(err, err_size, "%s: this plant does not show its states", class->name);
    }
    if (!good) {
        linearised_free(l);
    }
    return good;
}
