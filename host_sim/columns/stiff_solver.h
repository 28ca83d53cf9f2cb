/* Integration of a stiff set of ordinary differential equations with CVODE: BDF, Newton, full Jacobian by
 * differences: for some tens of states.
 *
 * Rules
 *  1. The right-hand side depends on the state and on what stiff_solver_restart() was told has changed: call it
 *     whenever inputs change.
 *  2. A function that can fail returns false (or NULL) and writes one line to err.
 *  3. Same calls, same bits.
 *  4. After a failed advance the state is what it was before. */
#ifndef REFLUX_HOST_SIM_STIFF_SOLVER_H
#define REFLUX_HOST_SIM_STIFF_SOLVER_H

#include <stdbool.h>
#include <stddef.h>

struct stiff_solver; /* opaque */

struct stiff_problem {
    const char *name; /* heads every error line */
    size_t n;
    double relative;        /* tolerance */
    const double *absolute; /* [n], copied */
    /* dy/dt at y. False: not there; a shorter step is then tried. */
    bool (*rates)(void *context, const double *y, double *dy);
    void *context;
};

struct stiff_solver *stiff_solver_create(const struct stiff_problem *problem, const double *y,
                                         char *err, size_t err_size);
void stiff_solver_destroy(struct stiff_solver *s);

/* The right-hand side has changed: integration starts afresh from the present state. */
void stiff_solver_restart(struct stiff_solver *s);

/* Another state and time. */
void stiff_solver_set(struct stiff_solver *s, double t, const double *y);

/* Integrates to time t (s), not before the present time. */
bool stiff_solver_advance(struct stiff_solver *s, double t, char *err, size_t err_size);

const double *stiff_solver_state(const struct stiff_solver *s);
double stiff_solver_time(const struct stiff_solver *s);
long stiff_solver_steps(const struct stiff_solver *s); /* taken since creation */

#endif
