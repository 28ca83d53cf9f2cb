#include "plants/plant.h"

#include <stdio.h>

bool plant_input_allowed(const struct plant_class *class, size_t n_inputs, size_t channel,
                         double value, char *err, size_t err_size)
{
    if (channel >= n_inputs) {
        snprintf(err, err_size, "%s: channel %zu is not an input; inputs are 0 to %zu", class->name,
                 channel, n_inputs - 1);
        return false;
    }
    const struct plant_channel *c = &class->channels[channel];
    if (value >= c->lo && value <= c->hi)
        return true;
    snprintf(err, err_size, "%s: %s = %g %s is outside %g to %g", class->name, c->name, value,
             c->unit, c->lo, c->hi);
    return false;
}
