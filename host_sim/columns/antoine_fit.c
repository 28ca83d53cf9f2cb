#include "columns/antoine_fit.h"

#include <math.h>
#include <stdio.h>

#include "bench/text.h"

bool antoine_range(const char *text, const struct column_config *c, double range[2], char *err,
                   size_t err_size)
{
    char rest;
    if (sscanf(text, "%lf-%lf%c", &range[0], &range[1], &rest) != 2 ||
        !(range[0] >= c->temperature_min && range[1] <= c->temperature_max) ||
        !(range[1] - range[0] >= 1.0)) {
        return sim_fail(
            err, err_size,
            "--antoine %s: must be two temperatures in K, as in 320-370, within %g to %g "
            "and a kelvin apart at least",
            text, (double)c->temperature_min, (double)c->temperature_max);
    }
    return true;
}

bool antoine_fit(const struct component *p, const double range[2], double constants[3])
{
    double t[3] = {range[0], (range[0] + range[1]) / 2.0, range[1]}, y[3], slope;
    for (size_t i = 0; i < 3; i++) {
        y[i] = log(component_vapour_pressure(p, t[i], &slope));
    }
    /* Steps of 1/(C + T) between equal steps of T are as 1/(C + t0) to 1/(C + t2). */
    double ratio = (y[2] - y[1]) / (y[1] - y[0]);
    double c = (ratio * t[2] - t[0]) / (1.0 - ratio);
    constants[2] = c;
    constants[1] = (y[1] - y[0]) * (c + t[0]) * (c + t[1]) / (t[1] - t[0]);
    constants[0] = y[0] + constants[1] / (c + t[0]);
    return isfinite(constants[0]) && isfinite(constants[1]) && c + t[0] > 0.0;
}
