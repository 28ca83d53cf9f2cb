#include "two_by_two.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { U1, U2, D, Y1, Y2, LOAD };

static const struct plant_channel channels[] = {
    {.kind = PLANT_MV, .name = "u1", .unit = "%", .lo = 0, .hi = 100, .nominal = 20, .safe = 0},
    {.kind = PLANT_MV, .name = "u2", .unit = "%", .lo = 0, .hi = 100, .nominal = 30, .safe = 5},
    {.kind = PLANT_DISTURBANCE, .name = "d", .unit = "degC", .lo = -10, .hi = 10, .nominal = 0},
    {.kind = PLANT_MEASUREMENT, .name = "y1", .unit = "degC", .lo = 0, .hi = 200, .noise = 0.1},
    {.kind = PLANT_MEASUREMENT, .name = "y2", .unit = "degC", .lo = 0, .hi = 200, .noise = 0.1},
    {.kind = PLANT_INTERNAL, .name = "load", .unit = "%", .lo = 0, .hi = 200},
};

static const double gain[2][2] = {{0.8, 0.3}, {0.2, 0.9}};
static const double tau_s[2] = {120.0, 180.0};

struct plant {
    double time_s, u[2], d, y[2];
};

static double target(const struct plant *p, size_t i)
{
    return 20.0 + gain[i][0] * p->u[0] + gain[i][1] * p->u[1] + p->d;
}

static bool settle(struct plant *p, char *err, size_t err_size)
{
    (void)err;
    (void)err_size;
    p->y[0] = target(p, 0);
    p->y[1] = target(p, 1);
    return true;
}

static struct plant *create(char *err, size_t err_size)
{
    struct plant *p = calloc(1, sizeof(*p));
    if (p == NULL) {
        (void)snprintf(err, err_size, "two_by_two: out of memory");
        return NULL;
    }
    p->u[0] = channels[U1].nominal;
    p->u[1] = channels[U2].nominal;
    (void)settle(p, err, err_size);
    return p;
}

static void destroy(struct plant *p)
{
    free(p);
}

static bool set_input(struct plant *p, size_t channel, double value, char *err, size_t err_size)
{
    if (channel > D || !(value >= channels[channel].lo && value <= channels[channel].hi)) {
        (void)snprintf(err, err_size, "two_by_two: channel %zu does not take %g", channel, value);
        return false;
    }
    if (channel == D) {
        p->d = value;
    } else {
        p->u[channel] = value;
    }
    return true;
}

static bool advance(struct plant *p, double t_s, char *err, size_t err_size)
{
    if (!(t_s >= p->time_s)) {
        (void)snprintf(err, err_size, "two_by_two: time %g s lies before %g s", t_s, p->time_s);
        return false;
    }
    for (size_t i = 0; i < 2; i++) {
        double y = target(p, i);
        p->y[i] = y + (p->y[i] - y) * exp(-(t_s - p->time_s) / tau_s[i]);
    }
    p->time_s = t_s;
    return true;
}

static double value(const struct plant *p, size_t channel)
{
    switch (channel) {
    case U1:
    case U2:
        return p->u[channel];
    case D:
        return p->d;
    case Y1:
    case Y2:
        return p->y[channel - Y1];
    default:
        return p->u[0] + p->u[1];
    }
}

const struct plant_class two_by_two = {
    .name = "two_by_two",
    .title = "two first-order outputs, each fed by both inputs",
    .source = "ours, for tests",
    .tick_s = 10.0,
    .channels = channels,
    .n_channels = sizeof(channels) / sizeof(channels[0]),
    .create = create,
    .destroy = destroy,
    .set_input = set_input,
    .advance = advance,
    .value = value,
    .settle = settle,
};

const struct plant_class *const plant_classes[] = {&two_by_two, NULL};
