/* A column's composition states for plant_states: every plant on column_solver.h can be linearised with these. */
#ifndef REFLUX_HOST_SIM_COLUMN_STATES_H
#define REFLUX_HOST_SIM_COLUMN_STATES_H

#include "column_solver.h"

size_t column_states_count(const struct column_solver *s);
void column_states_get(const struct column_solver *s, double *x);
/* dx/dt in 1/s at the present state and inputs; the solver is left alone. */
bool column_states_rates(const struct column_solver *s, double *rates, char *err, size_t err_size);

#define COLUMN_STATES_STEP                                                                         \
    1e-5 /* mole fraction: between the bubble points' rounding and curvature */

#endif
