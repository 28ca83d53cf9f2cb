/* A plant as matrices around a point: x' = A x + B u, y = C x + D u, deviations in engineering units, per second
 * (discrete plants: per period). Linear plants give their own; others are found by central differences. */
#ifndef REFLUX_HOST_SIM_LINEARISE_H
#define REFLUX_HOST_SIM_LINEARISE_H

#include "plant.h"

struct linearised {
    size_t n, m, p;         /* states, inputs (manipulated, disturbances), outputs */
    size_t *input, *output; /* their channels */
    double *a, *b, *c, *d;  /* row by row */
    double *dead_s;         /* p x m: dead time of that path, s */
    double period_s;        /* 0 = continuous */
    const char *state_unit; /* "-" when states have none of their own */
};

/* At the present state and inputs; the plant is left as it was. False with the reason in err. */
bool linearise(const struct plant_class *class, struct plant *p, struct linearised *l, char *err,
               size_t err_size);
void linearised_free(struct linearised *l);

#endif
