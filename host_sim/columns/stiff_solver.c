#include "columns/stiff_solver.h"

#include <cvode/cvode.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#define DIFFERENCE 1.5e-8 /* relative step of the Jacobian's differences */
#define TYPICAL    1e6    /* a state counts as at least so many times its absolute tolerance then */

_Static_assert(sizeof(realtype) == sizeof(double), "SUNDIALS in double precision");

struct stiff_solver {
    struct stiff_problem problem;
    double t;
    bool restart;
    long steps;
    char message[160]; /* what CVODE said last */

    SUNContext context;
    N_Vector y, saved, absolute;
    void *cvode;
    SUNMatrix matrix;
    SUNLinearSolver linear;
};

static void keep_message(int code, const char *module, const char *function, char *text, void *user)
{
    struct stiff_solver *s = user;
    (void)code;
    (void)module;
    snprintf(s->message, sizeof s->message, "%s: %s", function, text);
    for (char *c = s->message; *c; c++)
        if (*c == '\n')
            *c = ' ';
}

static bool checked(struct stiff_solver *s, int flag, const char *call, char *err, size_t size)
{
    if (flag >= 0)
        return true;
    snprintf(err, size, "%s: %s failed with %d. %s", s->problem.name, call, flag, s->message);
    return false;
}

static int rates(realtype t, N_Vector y, N_Vector ydot, void *user)
{
    struct stiff_solver *s = user;
    (void)t;
    return s->problem.rates(s->problem.context, NV_DATA_S(y), NV_DATA_S(ydot)) ? 0 : 1;
}

/* Forward differences. CVODE's own take their step from the state alone, which for a state near 0 beside a large one is
 * lost in rounding where the two are added. */
static int jacobian(realtype t, N_Vector y, N_Vector ydot, SUNMatrix matrix, void *user, N_Vector a,
                    N_Vector b, N_Vector c)
{
    struct stiff_solver *s = user;
    double *state = NV_DATA_S(y), *moved = NV_DATA_S(a);
    const double *here = NV_DATA_S(ydot), *absolute = NV_DATA_S(s->absolute);
    (void)t, (void)b, (void)c;

    for (size_t j = 0; j < s->problem.n; j++) {
        double keep = state[j], *column = SM_COLUMN_D(matrix, (sunindextype)j);
        state[j] += DIFFERENCE * fmax(fabs(keep), TYPICAL * absolute[j]);
        double step = state[j] - keep;
        bool there = s->problem.rates(s->problem.context, state, moved);
        state[j] = keep;
        if (!there)
            return 1;
        for (size_t i = 0; i < s->problem.n; i++)
            column[i] = (moved[i] - here[i]) / step;
    }
    return 0;
}

static bool make(struct stiff_solver *s, char *err, size_t size)
{
    const struct stiff_problem *p = &s->problem;
    sunindextype n = (sunindextype)p->n;

    if (SUNContext_Create(NULL, &s->context) < 0) {
        s->context = NULL;
        return false;
    }
    s->y = N_VNew_Serial(n, s->context);
    s->saved = N_VNew_Serial(n, s->context);
    s->absolute = N_VNew_Serial(n, s->context);
    s->matrix = SUNDenseMatrix(n, n, s->context);
    s->cvode = CVodeCreate(CV_BDF, s->context);
    if (!s->y || !s->saved || !s->absolute || !s->matrix || !s->cvode)
        return false;
    s->linear = SUNLinSol_Dense(s->y, s->matrix, s->context);
    if (!s->linear)
        return false;
    memcpy(NV_DATA_S(s->absolute), p->absolute, p->n * sizeof(double));
    return checked(s, CVodeSetErrHandlerFn(s->cvode, keep_message, s), "CVodeSetErrHandlerFn", err,
                   size) &&
           checked(s, CVodeInit(s->cvode, rates, 0.0, s->y), "CVodeInit", err, size) &&
           checked(s, CVodeSetUserData(s->cvode, s), "CVodeSetUserData", err, size) &&
           checked(s, CVodeSVtolerances(s->cvode, p->relative, s->absolute), "CVodeSVtolerances",
                   err, size) &&
           checked(s, CVodeSetLinearSolver(s->cvode, s->linear, s->matrix), "CVodeSetLinearSolver",
                   err, size) &&
           checked(s, CVodeSetJacFn(s->cvode, jacobian), "CVodeSetJacFn", err, size) &&
           checked(s, CVodeSetMaxNumSteps(s->cvode, 200000), "CVodeSetMaxNumSteps", err, size) &&
           checked(s, CVodeSetMaxErrTestFails(s->cvode, 20), "CVodeSetMaxErrTestFails", err,
                   size) &&
           checked(s, CVodeSetMaxConvFails(s->cvode, 50), "CVodeSetMaxConvFails", err, size);
}

struct stiff_solver *stiff_solver_create(const struct stiff_problem *problem, const double *y,
                                         char *err, size_t err_size)
{
    struct stiff_solver *s = calloc(1, sizeof *s);

    snprintf(err, err_size, "%s: no memory", problem->name);
    if (!s)
        return NULL;
    s->problem = *problem;
    if (!make(s, err, err_size)) {
        stiff_solver_destroy(s);
        return NULL;
    }
    s->problem.absolute = NULL; /* it was the caller's */
    stiff_solver_set(s, 0.0, y);
    err[0] = '\0';
    return s;
}

void stiff_solver_destroy(struct stiff_solver *s)
{
    if (!s)
        return;
    if (s->cvode)
        CVodeFree(&s->cvode);
    if (s->linear)
        SUNLinSolFree(s->linear);
    if (s->matrix)
        SUNMatDestroy(s->matrix);
    N_Vector *vectors[] = {&s->y, &s->saved, &s->absolute};
    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
        if (*vectors[i])
            N_VDestroy(*vectors[i]);
    if (s->context)
        SUNContext_Free(&s->context);
    free(s);
}

void stiff_solver_restart(struct stiff_solver *s)
{
    s->restart = true;
}

void stiff_solver_set(struct stiff_solver *s, double t, const double *y)
{
    if (y != NV_DATA_S(s->y))
        memcpy(NV_DATA_S(s->y), y, s->problem.n * sizeof *y);
    s->t = t;
    s->restart = true;
}

static bool integrate(struct stiff_solver *s, double t, char *err, size_t size)
{
    long before = 0, after = 0;
    double reached;

    if (s->restart && !checked(s, CVodeReInit(s->cvode, s->t, s->y), "CVodeReInit", err, size))
        return false;
    s->restart = false;
    if (!checked(s, CVodeGetNumSteps(s->cvode, &before), "CVodeGetNumSteps", err, size) ||
        !checked(s, CVode(s->cvode, t, s->y, &reached, CV_NORMAL), "CVode", err, size) ||
        !checked(s, CVodeGetNumSteps(s->cvode, &after), "CVodeGetNumSteps", err, size))
        return false;
    s->steps += after - before;
    return true;
}

bool stiff_solver_advance(struct stiff_solver *s, double t, char *err, size_t err_size)
{
    if (!(t >= s->t && t < 1e300)) {
        snprintf(err, err_size, "%s: advance to %g s, which is before the present %g s",
                 s->problem.name, t, s->t);
        return false;
    }
    if (t == s->t)
        return true;
    N_VScale(1.0, s->y, s->saved);
    if (!integrate(s, t, err, err_size)) {
        N_VScale(1.0, s->saved, s->y);
        s->restart = true;
        return false;
    }
    s->t = t;
    return true;
}

const double *stiff_solver_state(const struct stiff_solver *s)
{
    return NV_DATA_S(s->y);
}

double stiff_solver_time(const struct stiff_solver *s)
{
    return s->t;
}

long stiff_solver_steps(const struct stiff_solver *s)
{
    return s->steps;
}
