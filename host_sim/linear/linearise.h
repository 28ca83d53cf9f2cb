/* A plant as matrices around a point: x' = A x + B u, y = C x + D u, deviations in engineering units, per second
 * (discrete plants: per period). Linear plants give their own; those of others are found by differences, of the plant as
 * it is or of what it makes for that purpose (columns: the model in long double). derivative.h says how, and what a kink is. */
#ifndef REFLUX_HOST_SIM_LINEARISE_H
#define REFLUX_HOST_SIM_LINEARISE_H

#include "linear/derivative.h"
#include "plants/plant.h"

#define LINEARISED_NOTES 4096

struct linearised {
    size_t n, m, p;         /* states, inputs (manipulated, disturbances), outputs */
    size_t *input, *output; /* their channels */
    double *a, *b, *c, *d;  /* row by row */
    double *dead_s;         /* p x m: dead time of that path, s */
    double *x, *u,
        *y; /* the point: states, inputs, outputs there. NULL for plants that are linear everywhere */
    double period_s;              /* 0 = continuous */
    const char *state_unit;       /* "-" when states have none of their own */
    char notes[LINEARISED_NOTES]; /* where slopes are those of one side; lines, each with its end */
};

/* At the present state and inputs; the plant is left as it was. False with the reason in err. */
bool linearise(const struct plant_class *class, struct plant *p, struct linearised *l, char *err,
               size_t err_size);
void linearised_free(struct linearised *l);

/* For those who find matrices. */

/* A number of states or inputs along which slopes are taken, and what there is to say about how that went. */
void linearised_note(struct linearised *l, const struct plant_class *class, bool of_input,
                     size_t number, const struct derivative_found *found);

/* Writes slope[n + p] of the rates and the outputs along state or input `number` into its columns. */
void linearised_column(struct linearised *l, bool of_input, size_t number, const double *slope);

#endif
