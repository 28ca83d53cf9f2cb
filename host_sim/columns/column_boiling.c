/* Why a column has no rates: a stage whose liquid does not boil within the temperature range. */
#include "columns/column_solver_inside.h"

#include <stdio.h>

#define NEAR 1e-3 /* of the temperature range: an integrator stops so far before its end */

/* Mole fractions of stage s into x and, as "A 0.2, B 0.8", into a text that is long enough. */
static void composition(const struct column *c, const double *y, size_t s, double *x, char *text,
                        size_t size)
{
    size_t used = 0;
    for (size_t j = 0; j < c->config->components && used < size; j++) {
        const char *name = c->config->component[j].name;
        x[j] = column_fraction(c, y, s, j);
        used += (size_t)snprintf(text + used, size - used, "%s%s %.4g", j > 0 ? ", " : "",
                                 name ? name : "?", x[j]);
    }
}

static bool boils(const struct column *c, size_t s, const double *x)
{
    double y[COLUMN_COMPONENTS_MAX], k[COLUMN_COMPONENTS_MAX], dk[COLUMN_COMPONENTS_MAX];
    double t = c->temperature[s];
    return vle_bubble_point(&c->vle, x, c->pressure[s], &t, y, k, dk, false) == ERR_OK;
}

bool column_boiling_lost(const struct column_solver *s, char *err, size_t size)
{
    const struct column *c = &s->column;
    double lo = c->vle.temperature_min, hi = c->vle.temperature_max, near = NEAR * (hi - lo);

    for (size_t i = 0; i < c->config->stages; i++) {
        double x[COLUMN_COMPONENTS_MAX];
        char liquid[300] = "";
        composition(c, NV_DATA_S(s->y), i, x, liquid, sizeof liquid);
        if (boils(c, i, x))
            continue;
        snprintf(err, size,
                 "column: stage %zu has no boiling point within the temperature_range, %g to %g K, "
                 "at %.4g Pa with mole fractions %s",
                 i + 1, lo, hi, c->pressure[i], liquid);
        return true;
    }
    for (size_t i = 0; i < c->config->stages; i++) {
        double t = c->temperature[i];
        if (t > lo + near && t < hi - near)
            continue;
        snprintf(
            err, size,
            "column: stage %zu comes to %.4f K and would leave the temperature_range, %g to %g "
            "K",
            i + 1, t, lo, hi);
        return true;
    }
    return false;
}
