/* A plant that is a distillation column on column_solver.h: everything between a plant's table and the solver.
 *
 * A plant file gives its channels, a column_config, what its inputs are in the column's terms and what its
 * channels are in its own, and takes the hooks of plant_class from here (plants/pilot.c). Inputs come first
 * among the channels. */
#ifndef REFLUX_HOST_SIM_COLUMN_PLANT_H
#define REFLUX_HOST_SIM_COLUMN_PLANT_H

#include "column_solver.h"
#include "plant.h"

#define COLUMN_PLANT_INPUTS_MAX 16

struct column_plant {
    const struct plant_class *class;
    const struct column_config *config;
    size_t n_inputs; /* the first so many channels, at most COLUMN_PLANT_INPUTS_MAX */
    /* Inputs in the column's terms. NULL, or what is wrong, which follows "PLANT: INPUT = VALUE ". */
    const char *(*inputs_of)(const double *u, struct column_inputs *in);
    /* Present value of a channel that is no input. */
    double (*value)(const struct column *c, const double *x, const double *u, size_t channel);
};

/* The plant at the steady state of its nominal inputs; for plant_class.create. */
struct plant *column_plant_create(const struct column_plant *about, char *err, size_t err_size);

/* Hooks of plant_class and plant_states as plant.h describes them. */
void column_plant_destroy(struct plant *p);
bool column_plant_set_input(struct plant *p, size_t channel, double value, char *err,
                            size_t err_size);
bool column_plant_advance(struct plant *p, double t, char *err, size_t err_size);
double column_plant_value(const struct plant *p, size_t channel);
bool column_plant_settle(struct plant *p, char *err, size_t err_size);
size_t column_plant_state_count(const struct plant *p);
void column_plant_get_state(const struct plant *p, double *x);
bool column_plant_set_state(struct plant *p, const double *x, char *err, size_t err_size);
bool column_plant_rates(struct plant *p, double *rates, char *err, size_t err_size);

#define COLUMN_PLANT_HOOKS                                                                         \
    .destroy = column_plant_destroy, .set_input = column_plant_set_input,                          \
    .advance = column_plant_advance, .value = column_plant_value, .settle = column_plant_settle

/* Step: between the bubble points' rounding and curvature. */
#define COLUMN_PLANT_STATES(text)                                                                  \
    {                                                                                              \
        .count = column_plant_state_count, .unit = (text), .lo = 0.0, .hi = 1.0, .step = 1e-5,     \
        .get = column_plant_get_state, .set = column_plant_set_state, .rates = column_plant_rates  \
    }

#endif
