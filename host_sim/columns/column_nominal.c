/* Initial state of a column, and the reference of its level controllers and hydraulics. */
#include "columns/column_solver_inside.h"

#include <string.h>

/* Vapour pressure tells light from heavy where boiling points are not given. */
static double boils_at(const struct column_config *c, size_t j, bool given)
{
    double slope;
    return given ? c->component[j].boiling_point
                 : -component_vapour_pressure(
                       &c->component[j], 0.5 * (c->temperature_min + c->temperature_max), &slope);
}

/* A straight line from the highest-boiling pure component in the reboiler to the lowest-boiling one. */
static void straight_line(struct column_solver *s)
{
    const struct column_config *c = s->column.config;
    size_t light = 0, heavy = 0, m = c->components - 1;
    double *x = NV_DATA_S(s->y);
    bool given = true;

    for (size_t j = 0; j <= m; j++)
        given = given && c->component[j].boiling_point > 0.0;
    for (size_t j = 1; j <= m; j++) {
        if (boils_at(c, j, given) < boils_at(c, light, given))
            light = j;
        if (boils_at(c, j, given) >= boils_at(c, heavy, given))
            heavy = j;
    }
    for (size_t i = 0; i < c->stages; i++) {
        double up = 0.02 + 0.96 * (double)i / (double)(c->stages - 1);
        for (size_t j = 0; j < m; j++)
            x[i * m + j] = j == light ? up : j == heavy ? 1.0 - up : 0.0;
    }
}

bool column_nominal_start(struct column_solver *s, const struct column_inputs *inputs, char *err,
                          size_t size)
{
    straight_line(s);
    if (s->n == s->column.n_fractions)
        return true;

    struct column_config perfect = *s->column.config;
    perfect.levels = COLUMN_LEVELS_PERFECT;
    perfect.hydraulic_time = 0.0;
    struct column_solver *nominal = column_solver_create(&perfect, inputs, &s->options, err, size);
    bool settled = nominal && column_solver_settle(nominal, err, size);
    if (settled) {
        double *y = NV_DATA_S(s->y);
        memcpy(y, column_solver_state(nominal), s->column.n_fractions * sizeof *y);
        for (size_t i = s->column.n_fractions; i < s->n; i++)
            y[i] = 1.0;
        column_take_reference(&s->column, &column_solver_column(nominal)->flows);
    }
    column_solver_destroy(nominal);
    return settled;
}

void column_solver_hold(const struct column_solver *s, double *rates)
{
    const struct column_config *c = s->column.config;

    if (c->levels != COLUMN_LEVELS_HOLDUPS)
        return;
    if (c->reboiler_level.by == COLUMN_LEVEL_FREE)
        rates[column_holdup_state(&s->column, 0)] = 0.0;
    if (c->condenser_level.by == COLUMN_LEVEL_FREE)
        rates[column_holdup_state(&s->column, c->stages - 1)] = 0.0;
}
