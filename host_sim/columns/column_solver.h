/* Integration and steady state of a column (model/column.h, in double). After a jump of the inputs or the state a
 * one-step method (rosenbrock.h) integrates; smooth stretches are CVODE's. See docs/inside/column-solver.md.
 *
 * Rules
 *  1. Inputs are piecewise constant: those set last hold over the next advance.
 *  2. A function that can fail returns false (or NULL) and writes one line to err.
 *  3. Same calls, same bits: nothing depends on a clock; warm starts depend on earlier calls only.
 *  4. After a failed advance or settle the state is what it was before the call. */
#ifndef REFLUX_HOST_SIM_COLUMN_SOLVER_H
#define REFLUX_HOST_SIM_COLUMN_SOLVER_H

#include "model/column.h"

#include <stdbool.h>
#include <stddef.h>

struct column_solver; /* opaque */

struct column_solver_options {
    /* integration tolerances on mole fractions; 0: 3e-6, a third of it where holdups move */
    double relative;
    double absolute; /* 0: 3e-8, likewise */
    double residual; /* largest dx/dt * 1 h left at a settled state, of any state; 0: 1e-9 */
};

/* Work done since creation, for tests and benches. */
struct column_solver_work {
    long steps;
    long rates;     /* evaluations of the right-hand side */
    long jacobians; /* analytic ones taken */
    long restarts;  /* of CVODE */
};

/* config and its components must outlive the solver. options may be NULL. The state starts, at time 0, as a straight
 * line between the pure components of lowest and highest boiling point; column_solver_settle or
 * column_solver_set_state gives a better one.
 *
 * Where holdups move, these inputs are the nominal ones: the state starts at their steady state with perfect levels, and the
 * flows there are the reference (column.reference) of level controllers and hydraulics. Products that are inputs do not
 * matter to it. NULL where there is no such state. */
struct column_solver *column_solver_create(const struct column_config *config,
                                           const struct column_inputs *inputs,
                                           const struct column_solver_options *options, char *err,
                                           size_t err_size);
void column_solver_destroy(struct column_solver *s);

/* New inputs from the present time on. Refused as column_validate_inputs says. */
bool column_solver_set_inputs(struct column_solver *s, const struct column_inputs *inputs,
                              char *err, size_t err_size);

/* State x[n_states], each mole fraction (the closing one too) in [0, 1], each relative holdup 0 or more. */
bool column_solver_set_state(struct column_solver *s, const double *x, char *err, size_t err_size);
const double *column_solver_state(const struct column_solver *s);

/* Integrates to t (s), not before the present time. */
bool column_solver_advance(struct column_solver *s, double t, char *err, size_t err_size);
double column_solver_time(const struct column_solver *s);

/* Moves the state to the steady state of the present inputs: KINSOL's Newton from where it is, and when that fails from
 * the end of ever longer transients. Levels that nothing holds stay where they are. Time is left alone. When there is none
 * err says so, and which product dried up or which level runs away, and by how much. */
bool column_solver_settle(struct column_solver *s, char *err, size_t err_size);

/* The column at the present state and inputs: temperatures, vapour compositions, flows. */
const struct column *column_solver_column(const struct column_solver *s);

struct column_solver_work column_solver_work(const struct column_solver *s);

#endif
