#include "columns/column_plant.h"

#include "columns/column_linearise.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct plant {
    const struct column_plant *about;
    struct column_solver *solver;
    double input[COLUMN_DRIVES_MAX];
};

void column_plant_destroy(struct plant *p)
{
    if (p)
        column_solver_destroy(p->solver);
    free(p);
}

struct plant *column_plant_create(const struct column_plant *about, char *err, size_t err_size)
{
    struct plant *p = calloc(1, sizeof *p);
    struct column_inputs in;
    char reason[400] = "no memory";

    if (p) {
        p->about = about;
        for (size_t i = 0; i < about->terms->n_inputs; i++)
            p->input[i] = about->class->channels[i].nominal;
        const char *wrong = column_terms_inputs(about->terms, about->config, p->input, &in);
        if (wrong)
            snprintf(reason, sizeof reason, "what is nominal %s", wrong);
        else
            p->solver = column_solver_create(about->config, &in, NULL, reason, sizeof reason);
    }
    if (p && p->solver && column_solver_settle(p->solver, reason, sizeof reason))
        return p;
    column_plant_destroy(p);
    snprintf(err, err_size, "%s: at the nominal inputs: %s", about->class->name, reason);
    return NULL;
}

bool column_plant_set_input(struct plant *p, size_t channel, double value, char *err,
                            size_t err_size)
{
    const struct plant_class *class = p->about->class;

    if (!plant_input_allowed(class, p->about->terms->n_inputs, channel, value, err, err_size))
        return false;
    if (value == p->input[channel])
        return true;

    double old = p->input[channel];
    struct column_inputs in;
    p->input[channel] = value;
    const char *wrong = column_terms_inputs(p->about->terms, p->about->config, p->input, &in);
    if (wrong)
        snprintf(err, err_size, "%s: %s = %g %s", class->name, class->channels[channel].name, value,
                 wrong);
    else if (column_solver_set_inputs(p->solver, &in, err, err_size))
        return true;
    p->input[channel] = old;
    return false;
}

bool column_plant_advance(struct plant *p, double t, char *err, size_t err_size)
{
    return column_solver_advance(p->solver, t, err, err_size);
}

bool column_plant_settle(struct plant *p, char *err, size_t err_size)
{
    return column_solver_settle(p->solver, err, err_size);
}

double column_plant_value(const struct plant *p, size_t channel)
{
    size_t n_inputs = p->about->terms->n_inputs;

    if (channel < n_inputs)
        return p->input[channel];
    return column_terms_value(p->about->terms, column_solver_column(p->solver),
                              column_solver_state(p->solver), channel - n_inputs);
}

const struct column *column_plant_column(const struct plant *p)
{
    return column_solver_column(p->solver);
}

const double *column_plant_state(const struct plant *p)
{
    return column_solver_state(p->solver);
}

size_t column_plant_state_count(const struct plant *p)
{
    return column_solver_column(p->solver)->n_states;
}

void column_plant_get_state(const struct plant *p, double *x)
{
    memcpy(x, column_solver_state(p->solver), column_plant_state_count(p) * sizeof *x);
}

bool column_plant_set_state(struct plant *p, const double *x, char *err, size_t err_size)
{
    return column_solver_set_state(p->solver, x, err, err_size);
}

bool column_plant_rates(struct plant *p, double *rates, char *err, size_t err_size)
{
    struct column *copy = malloc(sizeof *copy); /* rates leave traces in a column: it is large */

    if (!copy) {
        snprintf(err, err_size, "%s: no memory", p->about->class->name);
        return false;
    }
    *copy = *column_solver_column(p->solver);
    enum err e = column_rates(copy, column_solver_state(p->solver), rates);
    free(copy);
    if (e)
        snprintf(err, err_size, "column: no rates at this state: %s", err_text(e));
    return !e;
}

bool column_plant_linearise(struct plant *p, struct linearised *l, char *err, size_t err_size)
{
    return column_linearise(p->about->class, column_solver_column(p->solver), p->about->terms, l,
                            err, err_size);
}
