#include "linearise.h"

#include "linear_plant.h"
#include "text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define INPUT_STEP 1e-4 /* of the span */

void linearised_free(struct linearised *l)
{
    free(l->input);
    free(l->output);
    free(l->a);
    free(l->b);
    free(l->c);
    free(l->d);
    free(l->dead_s);
    *l = (struct linearised){0};
}

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
    double *x, *moved, *rates; /* rates: below, above */
    double *y;                 /* outputs below, above */
};

static bool look(struct differences *k, size_t side, char *err, size_t err_size)
{
    for (size_t i = 0; i < k->l->p; i++) {
        k->y[side * k->l->p + i] = k->class->value(k->plant, k->l->output[i]);
    }
    return k->class->states->rates(k->plant, k->rates + side * k->l->n, err, err_size);
}

static void take_column(struct differences *k, double distance, double *of_rates,
                        double *of_outputs, size_t column, size_t width)
{
    const struct linearised *l = k->l;
    for (size_t i = 0; i < l->n; i++) {
        of_rates[i * width + column] = (k->rates[l->n + i] - k->rates[i]) / distance;
    }
    for (size_t i = 0; i < l->p; i++) {
        of_outputs[i * width + column] = (k->y[l->p + i] - k->y[i]) / distance;
    }
}

static bool along_state(struct differences *k, size_t j, char *err, size_t err_size)
{
    const struct plant_states *s = k->class->states;
    double room = fmin(k->x[j] - s->lo, s->hi - k->x[j]);
    double h = fmin(s->step, 0.5 * room);
    if (!(h > 0.0)) {
        return sim_fail(err, err_size, "%s: state %zu stands at its limit, %g", k->class->name, j,
                        k->x[j]);
    }
    memcpy(k->moved, k->x, k->l->n * sizeof(double));
    for (size_t side = 0; side < 2; side++) {
        k->moved[j] = k->x[j] + (side == 0 ? -h : h);
        if (!s->set(k->plant, k->moved, err, err_size) || !look(k, side, err, err_size)) {
            return false;
        }
    }
    take_column(k, 2.0 * h, k->l->a, k->l->c, j, k->l->n);
    return s->set(k->plant, k->x, err, err_size);
}

static bool along_input(struct differences *k, size_t j, char *err, size_t err_size)
{
    size_t channel = k->l->input[j];
    const struct plant_channel *c = &k->class->channels[channel];
    double u = k->class->value(k->plant, channel), h = INPUT_STEP * (c->hi - c->lo);
    double below = fmax(c->lo, u - h), above = fmin(c->hi, u + h); /* one-sided at a limit */
    for (size_t side = 0; side < 2; side++) {
        if (!k->class->set_input(k->plant, channel, side == 0 ? below : above, err, err_size) ||
            !look(k, side, err, err_size)) {
            return false;
        }
    }
    take_column(k, above - below, k->l->b, k->l->d, j, k->l->m);
    return k->class->set_input(k->plant, channel, u, err, err_size);
}

static bool differentiate(struct differences *k, char *err, size_t err_size)
{
    struct linearised *l = k->l;
    l->n = k->class->states->count(k->plant);
    l->state_unit = k->class->states->unit;
    k->x = numbers(l->n);
    k->moved = numbers(l->n);
    k->rates = numbers(2 * l->n);
    k->y = numbers(2 * l->p);
    bool good = reserve(l) && k->x != NULL && k->moved != NULL && k->rates != NULL && k->y != NULL;
    if (!good) {
        return sim_fail(err, err_size, "%s: out of memory", k->class->name);
    }
    k->class->states->get(k->plant, k->x);
    for (size_t j = 0; j < l->n && good; j++) {
        good = along_state(k, j, err, err_size);
    }
    for (size_t j = 0; j < l->m && good; j++) {
        good = along_input(k, j, err, err_size);
    }
    return good;
}

bool linearise(const struct plant_class *class, struct plant *p, struct linearised *l, char *err,
               size_t err_size)
{
    *l = (struct linearised){0};
    bool good = sort_channels(class, l);
    if (good && class->model != NULL) {
        good = copy_model(class, p, l) || sim_fail(err, err_size, "%s: out of memory", class->name);
    } else if (good && class->states != NULL) {
        struct differences k = {.class = class, .plant = p, .l = l};
        good = differentiate(&k, err, err_size);
        free(k.x);
        free(k.moved);
        free(k.rates);
        free(k.y);
    } else {
        good = sim_fail(err, err_size, "%s: this plant does not show its states", class->name);
    }
    if (!good) {
        linearised_free(l);
    }
    return good;
}
