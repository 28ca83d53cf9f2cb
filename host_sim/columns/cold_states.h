/* The states of a cold_column.h as people read them, for --linearise and for deciding whether a column is at rest.
 *
 * x[cold_states()]: per stage from the reboiler mole fraction of component 0, holdup (mol), temperature (100 K); then
 * heater and cooling water (100 K): numbers of one size, so that one difference is small for all. */
#ifndef REFLUX_HOST_SIM_COLD_STATES_H
#define REFLUX_HOST_SIM_COLD_STATES_H

#include "columns/cold_column.h"

#define COLD_STATES_UNIT                                                                           \
    "per stage, reboiler first: mole fraction, holdup in mol, temperature in 100 K; then heater "  \
    "and cooling water in 100 K"
#define COLD_STATES_MAX_VALUE 100.0
#define COLD_STATES_STEP      1e-3

/* From and to the states y of cold_rates(). The second: false, with the line, outside fractions of 0 to 1, holdups of 0
 * to 100 mol and temperatures of 200 to 800 K. */
void cold_states_get(const struct cold_config *c, const double *y, double *x);
bool cold_states_set(const struct cold_config *c, const double *x, double *y, char *err,
                     size_t err_size);

/* dx/dt, 1/s. */
void cold_states_rates(const struct cold_config *c, const struct cold_inputs *u, const double *y,
                       double *dx);

/* Largest change per hour of any state, holdups taken relative to themselves. */
double cold_states_unrest(const struct cold_config *c, const struct cold_inputs *u,
                          const double *y);

#endif
