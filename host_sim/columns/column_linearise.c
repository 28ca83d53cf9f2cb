#include "columns/column_linearise.h"

#include "columns/column_carry.h"
#include "columns/column_precise.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* First distances; a state, and a share of an input's span. Powers of 2: adding one is exact. */
#if LDBL_MANT_DIG > DBL_MANT_DIG
#define STEP 0x1p-17L
#else
#define STEP 0x1p-10L
#endif

struct along {
    struct column_precise *precise;
    bool of_input;
    size_t number;
};

static bool look(void *context, long double distance, long double *f, char *err, size_t err_size)
{
    const struct along *k = context;
    return column_precise_at(k->precise, k->of_input, k->number, distance, f, err, err_size);
}

/* Largest distance from the point. Mole fractions may be negative there: the equations do not mind. */
static void set_out(const struct plant_class *class, const struct column *column,
                    const struct linearised *l, const struct along *k, struct derivative_task *task)
{
    const struct plant_channel *c = &class->channels[k->number];

    task->step = STEP;
    task->below = task->above = 1.0L;
    if (k->of_input) {
        task->step *= exp2(floor(log2(c->hi - c->lo)));
        task->below = l->u[k->number] - c->lo;
        task->above = c->hi - l->u[k->number];
    } else if (k->number >= column->n_fractions) {
        task->below = l->x[k->number]; /* a holdup */
    }
}

static bool all_along(const struct plant_class *class, const struct column *column,
                      struct linearised *l, struct along *k, struct derivative_task *task,
                      long double *work, double *slope, char *err, size_t err_size)
{
    for (k->number = 0; k->number < (k->of_input ? l->m : l->n); k->number++) {
        struct derivative_found found;
        set_out(class, column, l, k, task);
        if (!derivative_take(task, work, slope, &found, err, err_size))
            return false;
        for (size_t i = 0; i < l->p; i++)
            slope[l->n + i] *= column_precise_scale(k->precise, i);
        linearised_column(l, k->of_input, k->number, slope);
        linearised_note(l, class, k->of_input, k->number, &found);
    }
    return true;
}

bool column_linearise(const struct plant_class *class, const struct column *column,
                      const struct column_terms *terms, struct linearised *l, char *err,
                      size_t err_size)
{
    double number[COLUMN_CARRY_MAX];
    size_t rows = l->n + l->p;
    long double *work = calloc(DERIVATIVE_WORK * rows, sizeof *work);
    double *slope = calloc(rows, sizeof *slope);
    struct along k = {.of_input = false};
    struct derivative_task task = {
        .n = rows, .first = l->n, .values = look, .context = &k, .rounding = LDBL_EPSILON};

    bool good = column_carry_out(column->config, &column->reference, number);
    if (!good)
        snprintf(err, err_size, "%s: activity coefficients that are no table", class->name);
    k.precise = good ? column_precise_create(number, terms, err, err_size) : NULL;
    good = k.precise && column_precise_set(k.precise, l->x, l->u, err, err_size);
    if (good && (!work || !slope)) {
        snprintf(err, err_size, "%s: no memory", class->name);
        good = false;
    }
    for (size_t side = 0; side < 2 && good; side++) {
        k.of_input = side == 1;
        good = all_along(class, column, l, &k, &task, work, slope, err, err_size);
    }
    column_precise_destroy(k.precise);
    free(work);
    free(slope);
    return good;
}
