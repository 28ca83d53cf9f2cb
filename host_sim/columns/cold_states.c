#include "columns/cold_states.h"

#include <math.h>
#include <stdio.h>

#define HUNDRED_K 100.0
#define HOUR      3600.0

void cold_states_get(const struct cold_config *c, const double *y, double *x)
{
    size_t last = cold_states(c) - 1;

    for (size_t s = 0; s < c->stages; s++) {
        const double *n = &y[1 + 3 * s];
        x[3 * s + 1] = n[0] + n[1];
        x[3 * s] = n[0] / x[3 * s + 1];
        x[3 * s + 2] = cold_temperature(c, s, n, n[2]) / HUNDRED_K;
    }
    x[last - 1] = y[0] / HUNDRED_K;
    x[last] = y[last] / HUNDRED_K;
}

bool cold_states_set(const struct cold_config *c, const double *x, double *y, char *err,
                     size_t err_size)
{
    size_t last = cold_states(c) - 1;

    for (size_t i = 0; i <= last; i++) {
        bool temperature = i >= last - 1 || i % 3 == 2;
        double lo = temperature ? 2.0 : 0.0, hi = temperature ? 8.0 : i % 3 == 0 ? 1.0 : 100.0;
        if (!(x[i] >= lo && x[i] <= hi)) {
            snprintf(err, err_size, "state %zu = %g must be %g to %g", i, x[i], lo, hi);
            return false;
        }
    }
    for (size_t s = 0; s < c->stages; s++) {
        double *n = &y[1 + 3 * s];
        n[0] = x[3 * s + 1] * x[3 * s];
        n[1] = x[3 * s + 1] * (1.0 - x[3 * s]);
        n[2] = cold_energy(c, s, n, x[3 * s + 2] * HUNDRED_K);
    }
    y[0] = x[last - 1] * HUNDRED_K;
    y[last] = x[last] * HUNDRED_K;
    return true;
}

void cold_states_rates(const struct cold_config *c, const struct cold_inputs *u, const double *y,
                       double *dx)
{
    double dy[COLD_STATES_MAX];
    size_t last = cold_states(c) - 1;

    (void)cold_rates(c, u, y, dy, NULL);
    for (size_t s = 0; s < c->stages; s++) {
        const double *n = &y[1 + 3 * s], *dn = &dy[1 + 3 * s];
        double holdup = n[0] + n[1], rise = dn[0] + dn[1];
        dx[3 * s] = (dn[0] - n[0] / holdup * rise) / holdup;
        dx[3 * s + 1] = rise;
        dx[3 * s + 2] = cold_temperature_rate(c, s, n, n[2], dn) / HUNDRED_K;
    }
    dx[last - 1] = dy[0] / HUNDRED_K;
    dx[last] = dy[last] / HUNDRED_K;
}

double cold_states_unrest(const struct cold_config *c, const struct cold_inputs *u, const double *y)
{
    double dx[COLD_STATES_MAX], worst = 0.0;

    cold_states_rates(c, u, y, dx);
    for (size_t i = 0; i < cold_states(c); i++) {
        bool holdup = i < 3 * c->stages && i % 3 == 1;
        double size = holdup ? y[i] + y[i + 1] : 1.0; /* y leads x by one: see cold_rates() */
        worst = fmax(worst, fabs(dx[i]) / size);
    }
    return worst * HOUR;
}
