/* Declarations that the files of the column solver share: column_solver.c (state, inputs, who integrates), column_bdf.c (CVODE),
 * column_steady.c (KINSOL), column_nominal.c (where it starts), column_boiling.c (what it lacks when it fails). */
#ifndef REFLUX_HOST_SIM_COLUMN_SOLVER_INSIDE_H
#define REFLUX_HOST_SIM_COLUMN_SOLVER_INSIDE_H

#include "columns/column_newton.h"
#include "columns/column_solver.h"
#include "columns/rosenbrock.h"

#include <nvector/nvector_serial.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>

#define HOUR 3600.0

_Static_assert(sizeof(realtype) == sizeof(double), "SUNDIALS in double precision");

struct column_solver {
    struct column column;
    struct column_solver_options options;
    size_t n;
    double t;
    enum err model_error; /* of the last rates that failed */
    char message[160];    /* what SUNDIALS said last */
    struct column_solver_work work;
    long rates_max; /* up to which work.rates may go in a search for the steady state */
    bool held;      /* in such a search: levels that nothing holds stay where they are */

    bool jumped;    /* the state or the inputs: CVODE's history is void */
    int since_jump; /* one-step steps since then */
    bool multistep; /* CVODE has taken over */
    struct rosenbrock one_step;
    struct column_newton *newton; /* of one_step, and of the steady state */

    SUNContext context;
    N_Vector y, rates, saved, absolute, scale, weight;
    void *cvode, *kinsol;
    struct rosenbrock rough; /* transients towards the steady state */
    SUNMatrix matrix;
    SUNLinearSolver linear, krylov;
};

/* "what: why" to err; false. */
bool column_solver_fail(char *err, size_t size, const char *what, const char *reason);

/* True when flag is no error; else the name of the flag, the call and what the model or SUNDIALS said go to err. */
bool column_solver_checked(struct column_solver *s, int flag, char *(*name_of)(long),
                           const char *call, char *err, size_t size);

/* An error handler for SUNDIALS: keeps the text in message. */
void column_solver_keep_message(int code, const char *module, const char *function, char *text,
                                void *user);

/* Rates in 1/s as a right-hand side of SUNDIALS; 1 (recoverable) where there are none. */
int column_solver_rates(realtype t, N_Vector y, N_Vector f, void *user);

/* Sets overshoots of an integrator back into [0, 1]; *moved is set when there were any, and otherwise left alone.
 * False when one is no mere overshoot. */
bool column_solver_confine(struct column_solver *s, bool *moved);

/* Sets the rates of levels that nothing holds to 0 while s->held. */
void column_solver_hold(const struct column_solver *s, double *rates);

/* Finds the initial state. With holdups that move: the steady state of the inputs with perfect levels and nominal holdups, which
 * also is the reference of level controllers and hydraulics. Otherwise a straight line between pure components. */
bool column_nominal_start(struct column_solver *s, const struct column_inputs *inputs, char *err,
                          size_t size);

/* CVODE from s->t to t; the state ends in s->y. afresh: its history is void. */
bool column_bdf_create(struct column_solver *s, char *err, size_t size);
bool column_bdf_run(struct column_solver *s, double t, bool afresh, char *err, size_t size);
void column_bdf_free(struct column_solver *s);

/* KINSOL, for column_solver_settle (column_solver.h). */
bool column_steady_create(struct column_solver *s, char *err, size_t size);
void column_steady_free(struct column_solver *s);

/* Rates and outputs at the present state and inputs; again: only inputs have changed since the last time. */
bool column_solver_refresh(struct column_solver *s, bool again, char *err, size_t size);

/* True if a stage has no boiling point at the state in s->y, or is about to lose it; then err says which, and what the
 * range is. */
bool column_boiling_lost(const struct column_solver *s, char *err, size_t size);

#endif
