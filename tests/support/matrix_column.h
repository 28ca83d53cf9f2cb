/* A small linear column for the fault matrix: three temperatures and a flow by reflux, heat and feed. */
#ifndef REFLUX_TESTS_MATRIX_COLUMN_H
#define REFLUX_TESTS_MATRIX_COLUMN_H

#include <math.h>

#include "plants/plant.h"

enum { REFLUX, HEAT, FEED, T1, T10, FLOW, T5, CHANNELS };

static const struct plant_channel channels[CHANNELS] = {
    [REFLUX] = {.kind = PLANT_MV,
                .name = "reflux",
                .unit = "l/h",
                .lo = 0,
                .hi = 10,
                .nominal = 5,
                .safe = 5},
    [HEAT] = {.kind = PLANT_MV,
              .name = "heat",
              .unit = "kW",
              .lo = 0,
              .hi = 2,
              .nominal = 1,
              .safe = 0.25},
    [FEED] =
        {.kind = PLANT_DISTURBANCE, .name = "F", .unit = "l/h", .lo = 0, .hi = 10, .nominal = 5},
    [T1] = {.kind = PLANT_MEASUREMENT,
            .name = "T1",
            .unit = "degC",
            .lo = 0,
            .hi = 200,
            .noise = 0.05},
    [T10] = {.kind = PLANT_MEASUREMENT,
             .name = "T10",
             .unit = "degC",
             .lo = 0,
             .hi = 200,
             .noise = 0.05},
    [FLOW] = {.kind = PLANT_MEASUREMENT,
              .name = "flow",
              .unit = "l/h",
              .lo = 0,
              .hi = 12,
              .noise = 0.02},
    [T5] = {.kind = PLANT_MEASUREMENT,
            .name = "T5",
            .unit = "degC",
            .lo = 0,
            .hi = 200,
            .noise = 0.05},
};

struct plant {
    double value[CHANNELS];
    double time_s;
};
static struct plant column;

static bool set_input(struct plant *p, size_t channel, double value, char *err, size_t err_size)
{
    (void)err;
    (void)err_size;
    p->value[channel] = value;
    return true;
}

static bool advance(struct plant *p, double t_s, char *err, size_t err_size)
{
    (void)err;
    (void)err_size;
    double dt = t_s - p->time_s;
    double heat = p->value[HEAT] - 1, reflux = p->value[REFLUX] - 5, feed = p->value[FEED] - 5;
    const double steady[] = {[T1] = 85 + 15 * heat - 3 * reflux - feed,
                             [T10] = 115 + 40 * heat - 2 * reflux - 2 * feed,
                             [T5] = 100 + 25 * heat - 2 * reflux - feed};
    const double tau[] = {[T1] = 60, [T10] = 50, [T5] = 40};
    const int slow[] = {T1, T10, T5};
    for (unsigned k = 0; k < 3; k++) {
        int i = slow[k];
        p->value[i] += (steady[i] - p->value[i]) * (1 - exp(-dt / tau[i]));
    }
    p->value[FLOW] = p->value[REFLUX];
    p->time_s = t_s;
    return true;
}

static double value(const struct plant *p, size_t channel)
{
    return p->value[channel];
}

static const struct plant_class class = {.name = "matrix",
                                         .channels = channels,
                                         .n_channels = CHANNELS,
                                         .set_input = set_input,
                                         .advance = advance,
                                         .value = value};

#endif
