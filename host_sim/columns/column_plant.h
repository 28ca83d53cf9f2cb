/* A plant that is a distillation column on column_solver.h: everything between a plant's table and the solver. What its
 * channels are in the column's terms is in column_terms.h; column_json.h makes all of it from a file. */
#ifndef REFLUX_HOST_SIM_COLUMN_PLANT_H
#define REFLUX_HOST_SIM_COLUMN_PLANT_H

#include "columns/column_solver.h"
#include "columns/column_terms.h"
#include "plants/plant.h"

/* One column as a plant. The first channels of the class are the inputs of terms, the others what terms sees. */
struct column_plant {
    const struct plant_class *class;
    const struct column_config *config;
    const struct column_terms *terms;
};

/* The plant at the steady state of its nominal inputs. */
struct plant *column_plant_create(const struct column_plant *about, char *err, size_t err_size);

/* The column of a plant of such a class at its present state and inputs, and that state. */
const struct column *column_plant_column(const struct plant *p);
const double *column_plant_state(const struct plant *p);

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
bool column_plant_linearise(struct plant *p, struct linearised *l, char *err, size_t err_size);

/* Linearised by column_plant_linearise, so lo, hi and step are only what the struct asks for. */
#define COLUMN_PLANT_STATES(text)                                                                  \
    {                                                                                              \
        .count = column_plant_state_count, .unit = (text), .lo = 0.0, .hi = 1.0, .step = 1e-5,     \
        .get = column_plant_get_state, .set = column_plant_set_state, .rates = column_plant_rates  \
    }

#endif
