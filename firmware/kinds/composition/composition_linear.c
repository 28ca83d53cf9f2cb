/* The model of a linear Kalman filter: around the profile x0 and the inputs of the table, for which Phi = (I - h J)^-1 stays what it
 * is, a step of h is
 *
 *     x - x0 <- Phi (x - x0 + h (f(x0, u) + S e)),   T = T(x0) + dT/dx (x - x0)
 *
 * with the rates f at x0 for the inputs u of the step and their slopes S by what is found of the feed, e, at the table's inputs, so
 * that it is linear in what it estimates, and a tick costs no bubble points. Were e among the inputs, gains that belong to S would
 * drive it as far as the flows' limits. Folami 5.2 had such a model; the implicit step and f are ours. */
#include "kinds/composition/composition.h"

#define ZERO REAL_C(0.0)

static enum err linearise(struct composition *c)
{
    struct column_fault fault;
    enum err err = column_set_inputs(&c->column, &c->table.nominal, &fault);
    c->linear.transition.stages = c->table.config.stages;
    c->linear.transition.m = c->table.config.components - 1;
    if (!err)
        err = column_rates(&c->column, c->table.profile, c->rates);
    if (!err)
        err = column_transition_make(&c->column, c->table.profile, c->h, &c->linear.transition);
    if (!err)
        composition_push(&c->gains, &c->column, c->table.profile, c->linear.push, c->rates,
                         c->blocks.change);
    c->linear.h = err ? ZERO : c->h;
    return err;
}

enum err composition_linear_rates(struct composition *c)
{
    struct column_fault fault;
    const struct composition_gains *g = &c->gains;
    size_t n = c->column.n_fractions;
    enum err err = real_within(c->linear.h, c->h, c->h) ? ERR_OK : linearise(c);
    if (!err)
        err = column_set_inputs(&c->column, &c->inputs, &fault);
    if (!err)
        err = column_rates_again(&c->column, c->table.profile, c->rates);
    for (size_t k = 0; !err && k < g->feed; k++)
        for (size_t i = 0; i < n; i++)
            c->rates[i] = real_fma(g->extra[k], c->linear.push[k * n + i], c->rates[i]);
    return err;
}

void composition_linear_step(struct composition *c)
{
    real_t *change = c->blocks.change;
    for (size_t i = 0; i < c->column.n_fractions; i++)
        change[i] = c->x[i] - c->table.profile[i] + c->h * c->rates[i];
    column_transition_apply(&c->linear.transition, change);
    for (size_t i = 0; i < c->column.n_fractions; i++)
        change[i] -= c->x[i] - c->table.profile[i];
}

real_t composition_temperature_before(const struct composition *c, size_t stage)
{
    real_t dt[COLUMN_COMPONENTS_MAX], dy[COLUMN_COMPONENTS_MAX * COLUMN_COMPONENTS_MAX];
    real_t t = c->column.temperature[stage];
    size_t m = c->table.config.components - 1;
    if (c->method != METHOD_KALMAN || !(c->linear.h > ZERO)) /* there are no slopes yet */
        return t;
    composition_slopes(c, stage, dt, dy);
    for (size_t j = 0; j < m; j++)
        t += dt[j] * (c->x[stage * m + j] - c->table.profile[stage * m + j]);
    return t;
}
