#include "columns/column_precise.h"

#include "columns/column_carry.h"
#include "columns/column_terms.h"

#include <stdio.h>
#include <stdlib.h>

struct column_precise {
    struct column_carried made;
    const struct column_terms *given;
    struct column_terms terms; /* the same, but for: */
    struct column_seen *seen;  /* the terms' with fractions in the place of their logarithms */
    struct column column;
    real_t *x;
    real_t u[COLUMN_DRIVES_MAX];
};

void column_precise_destroy(struct column_precise *p)
{
    if (p) {
        free(p->seen);
        free(p->x);
    }
    free(p);
}

static bool fail(char *err, size_t err_size, const char *reason)
{
    snprintf(err, err_size, "column in long double: %s", reason);
    return false;
}

struct column_precise *column_precise_create(const double *number, const struct column_terms *terms,
                                             char *err, size_t err_size)
{
    struct column_precise *p = calloc(1, sizeof *p);
    struct column_fault fault;

    if (!p) {
        (void)fail(err, err_size, "no memory");
        return NULL;
    }
    column_carry_in(number, &p->made);
    if (column_init(&p->column, &p->made.config, &fault)) {
        (void)fail(err, err_size, fault.field);
        column_precise_destroy(p);
        return NULL;
    }
    column_take_reference(&p->column, &p->made.reference);
    p->given = terms;
    p->terms = *terms;
    p->seen = calloc(terms->n_seen + 1, sizeof *p->seen);
    p->x = calloc(p->column.n_states, sizeof *p->x);
    if (!p->seen || !p->x) {
        (void)fail(err, err_size, "no memory");
        column_precise_destroy(p);
        return NULL;
    }
    for (size_t k = 0; k < terms->n_seen; k++) {
        p->seen[k] = terms->seen[k];
        if (p->seen[k].sight == SIGHT_LOG_FRACTION)
            p->seen[k].sight = SIGHT_FRACTION;
    }
    p->terms.seen = p->seen;
    return p;
}

static bool take_inputs(struct column_precise *p, char *err, size_t err_size)
{
    struct column_inputs in;
    struct column_fault fault;
    const char *wrong = column_terms_inputs(&p->terms, &p->made.config, p->u, &in);

    if (wrong)
        return fail(err, err_size, wrong);
    return !column_set_inputs(&p->column, &in, &fault) || fail(err, err_size, fault.field);
}

bool column_precise_set(struct column_precise *p, const double *x, const double *u, char *err,
                        size_t err_size)
{
    for (size_t i = 0; i < p->column.n_states; i++)
        p->x[i] = (real_t)x[i];
    for (size_t j = 0; j < p->terms.n_inputs; j++)
        p->u[j] = (real_t)u[j];
    return take_inputs(p, err, err_size);
}

bool column_precise_at(struct column_precise *p, bool of_input, size_t along, long double distance,
                       long double *rates_and_values, char *err, size_t err_size)
{
    real_t *moved = of_input ? &p->u[along] : &p->x[along], was = *moved;
    bool good = true;

    *moved += distance;
    if (of_input)
        good = take_inputs(p, err, err_size);
    if (good) {
        enum err e = column_rates(&p->column, p->x, rates_and_values);
        good = !e || fail(err, err_size, err_text(e));
    }
    for (size_t k = 0; k < p->terms.n_seen && good; k++)
        rates_and_values[p->column.n_states + k] =
            column_terms_value(&p->terms, &p->column, p->x, k);
    *moved = was;
    if (of_input)
        good = take_inputs(p, err, err_size) && good;
    return good;
}

double column_precise_scale(const struct column_precise *p, size_t k)
{
    const real_t one = REAL_C(1.0), margin = (real_t)COLUMN_LOG_MARGIN;

    if (p->given->seen[k].sight != SIGHT_LOG_FRACTION)
        return 1.0;
    real_t x = column_terms_value(&p->terms, &p->column, p->x, k);
    return x < margin || x > one - margin ? 0.0 : (double)(one / (x * (one - x)));
}
