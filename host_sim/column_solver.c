#include "column_solver.h"

#include <cvode/cvode.h>
#include <kinsol/kinsol.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_band.h>
#include <sunmatrix/sunmatrix_dense.h>

#define DENSE_MAX         240  /* states up to which the steady state uses a full, exact Jacobian */
#define OVERSHOOT_ALLOWED 1e-4 /* mole fraction outside [0, 1] that is set back silently */
#define HOUR              3600.0

_Static_assert(sizeof(realtype) == sizeof(double), "SUNDIALS in double precision");

struct column_solver {
    struct column column;
    struct column_solver_options options;
    size_t n;
    double t;
    bool restart; /* the state or the inputs jumped: CVODE's history is void */
    enum err model_error;
    char message[160]; /* what SUNDIALS said last */
    struct column_solver_work work;

    SUNContext context;
    N_Vector y, rates, saved, absolute, scale, constraints;
    void *cvode, *kinsol;
    SUNMatrix band, kin_matrix;
    SUNLinearSolver band_solver, kin_solver;
};

static bool fail(char *err, size_t size, const char *what, const char *why)
{
    snprintf(err, size, "%s: %s", what, why);
    return false;
}

/* SUNDIALS names its return codes; the names are malloc'ed by it. */
static bool checked(struct column_solver *s, int flag, char *(*name_of)(long), const char *call,
                    char *err, size_t size)
{
    if (flag >= 0)
        return true;
    char *name = name_of(flag);
    if (s->model_error)
        snprintf(err, size, "column: %s returned %s; the model said: %s", call, name,
                 err_text(s->model_error));
    else
        snprintf(err, size, "column: %s returned %s. %s", call, name, s->message);
    free(name);
    return false;
}

static void keep_message(int code, const char *module, const char *function, char *text, void *user)
{
    struct column_solver *s = user;
    (void)code;
    (void)module;
    snprintf(s->message, sizeof s->message, "%s: %s", function, text);
    for (char *c = s->message; *c; c++)
        if (*c == '\n')
            *c = ' ';
}

static int cvode_rates(realtype t, N_Vector y, N_Vector ydot, void *user)
{
    struct column_solver *s = user;
    (void)t;
    s->work.rates++;
    s->model_error = column_rates(&s->column, NV_DATA_S(y), NV_DATA_S(ydot));
    return s->model_error ? 1 : 0; /* recoverable: a shorter step may do */
}

static void write_band(struct column_solver *s, N_Vector y, SUNMatrix matrix)
{
    s->work.jacobians++;
    column_jacobian(&s->column, NV_DATA_S(y), SM_DATA_B(matrix), (size_t)SM_LDIM_B(matrix),
                    (size_t)SM_SUBAND_B(matrix));
}

static int cvode_jacobian(realtype t, N_Vector y, N_Vector fy, SUNMatrix matrix, void *user,
                          N_Vector a, N_Vector b, N_Vector c)
{
    struct column_solver *s = user;
    (void)t, (void)fy, (void)a, (void)b, (void)c;
    s->model_error = column_evaluate(&s->column, NV_DATA_S(y));
    if (s->model_error)
        return 1;
    write_band(s, y, matrix);
    return 0;
}

/* Steady state: change per hour of every mole fraction is zero. */
static int kinsol_residual(N_Vector y, N_Vector f, void *user)
{
    int failed = cvode_rates(0.0, y, f, user);
    if (!failed)
        N_VScale(HOUR, f, f);
    return failed;
}

static int kinsol_jacobian(N_Vector y, N_Vector fy, SUNMatrix matrix, void *user, N_Vector a,
                           N_Vector b)
{
    struct column_solver *s = user;
    (void)fy, (void)a, (void)b;
    s->model_error = column_evaluate(&s->column, NV_DATA_S(y));
    if (s->model_error)
        return 1;
    write_band(s, y, matrix);
    SUNMatrix m = matrix;
    for (sunindextype i = 0; i < SM_LDATA_B(m); i++)
        SM_DATA_B(m)[i] *= HOUR;
    return 0;
}

static bool make_vectors(struct column_solver *s)
{
    sunindextype n = (sunindextype)s->n;
    s->y = N_VNew_Serial(n, s->context);
    s->rates = N_VNew_Serial(n, s->context);
    s->saved = N_VNew_Serial(n, s->context);
    s->absolute = N_VNew_Serial(n, s->context);
    s->scale = N_VNew_Serial(n, s->context);
    s->constraints = N_VNew_Serial(n, s->context);
    if (!s->y || !s->rates || !s->saved || !s->absolute || !s->scale || !s->constraints)
        return false;
    N_VConst(s->options.absolute, s->absolute);
    N_VConst(1.0, s->scale);
    N_VConst(1.0, s->constraints); /* KINSOL: y >= 0 */
    return true;
}

static bool make_cvode(struct column_solver *s, char *err, size_t size)
{
    size_t lower, upper;
    sunindextype n = (sunindextype)s->n;

    column_jacobian_shape(s->column.config, &lower, &upper);
    s->cvode = CVodeCreate(CV_BDF, s->context);
    s->band = SUNBandMatrix(n, (sunindextype)upper, (sunindextype)lower, s->context);
    if (!s->cvode || !s->band)
        return fail(err, size, "column", "no memory for the integrator");
    s->band_solver = SUNLinSol_Band(s->y, s->band, s->context);
    if (!s->band_solver)
        return fail(err, size, "column", "no memory for the integrator");

    char *(*name)(long) = CVodeGetReturnFlagName;
    return checked(s, CVodeSetErrHandlerFn(s->cvode, keep_message, s), name, "CVodeSetErrHandlerFn",
                   err, size) &&
           checked(s, CVodeInit(s->cvode, cvode_rates, 0.0, s->y), name, "CVodeInit", err, size) &&
           checked(s, CVodeSetUserData(s->cvode, s), name, "CVodeSetUserData", err, size) &&
           checked(s, CVodeSVtolerances(s->cvode, s->options.relative, s->absolute), name,
                   "CVodeSVtolerances", err, size) &&
           checked(s, CVodeSetLinearSolver(s->cvode, s->band_solver, s->band),
                   CVodeGetLinReturnFlagName, "CVodeSetLinearSolver", err, size) &&
           checked(s, CVodeSetJacFn(s->cvode, cvode_jacobian), CVodeGetLinReturnFlagName,
                   "CVodeSetJacFn", err, size) &&
           checked(s, CVodeSetMaxNumSteps(s->cvode, 200000), name, "CVodeSetMaxNumSteps", err,
                   size) &&
           checked(s, CVodeSetMaxErrTestFails(s->cvode, 20), name, "CVodeSetMaxErrTestFails", err,
                   size) &&
           checked(s, CVodeSetMaxConvFails(s->cvode, 20), name, "CVodeSetMaxConvFails", err, size);
}

static bool make_kinsol(struct column_solver *s, char *err, size_t size)
{
    sunindextype n = (sunindextype)s->n;
    size_t lower, upper;
    bool dense = s->n <= DENSE_MAX;

    column_jacobian_shape(s->column.config, &lower, &upper);
    s->kinsol = KINCreate(s->context);
    s->kin_matrix = dense ? SUNDenseMatrix(n, n, s->context)
                          : SUNBandMatrix(n, (sunindextype)upper, (sunindextype)lower, s->context);
    if (!s->kinsol || !s->kin_matrix)
        return fail(err, size, "column", "no memory for the steady-state solver");
    s->kin_solver = dense ? SUNLinSol_Dense(s->y, s->kin_matrix, s->context)
                          : SUNLinSol_Band(s->y, s->kin_matrix, s->context);
    if (!s->kin_solver)
        return fail(err, size, "column", "no memory for the steady-state solver");

    char *(*name)(long) = KINGetReturnFlagName;
    return checked(s, KINSetErrHandlerFn(s->kinsol, keep_message, s), name, "KINSetErrHandlerFn",
                   err, size) &&
           checked(s, KINSetUserData(s->kinsol, s), name, "KINSetUserData", err, size) &&
           checked(s, KINInit(s->kinsol, kinsol_residual, s->y), name, "KINInit", err, size) &&
           checked(s, KINSetLinearSolver(s->kinsol, s->kin_solver, s->kin_matrix),
                   KINGetLinReturnFlagName, "KINSetLinearSolver", err, size) &&
           (dense || checked(s, KINSetJacFn(s->kinsol, kinsol_jacobian), KINGetLinReturnFlagName,
                             "KINSetJacFn", err, size)) &&
           checked(s, KINSetConstraints(s->kinsol, s->constraints), name, "KINSetConstraints", err,
                   size) &&
           checked(s, KINSetFuncNormTol(s->kinsol, s->options.residual), name, "KINSetFuncNormTol",
                   err, size) &&
           checked(s, KINSetScaledStepTol(s->kinsol, 1e-15), name, "KINSetScaledStepTol", err,
                   size) &&
           checked(s, KINSetMaxSetupCalls(s->kinsol, dense ? 1 : 0), name, "KINSetMaxSetupCalls",
                   err, size) &&
           checked(s, KINSetNumMaxIters(s->kinsol, 200), name, "KINSetNumMaxIters", err, size);
}

/* A straight line from the highest-boiling pure component in the reboiler to the lowest-boiling one. */
static void straight_line(struct column_solver *s)
{
    const struct column_config *c = s->column.config;
    size_t light = 0, heavy = 0, m = c->components - 1;
    double *x = NV_DATA_S(s->y);

    for (size_t j = 1; j <= m; j++) {
        if (c->component[j].boiling_point < c->component[light].boiling_point)
            light = j;
        if (c->component[j].boiling_point >= c->component[heavy].boiling_point)
            heavy = j;
    }
    for (size_t i = 0; i < c->stages; i++) {
        double up = 0.02 + 0.96 * (double)i / (double)(c->stages - 1);
        for (size_t j = 0; j < m; j++)
            x[i * m + j] = j == light ? up : j == heavy ? 1.0 - up : 0.0;
    }
}

static bool refresh(struct column_solver *s, char *err, size_t size)
{
    enum err code = column_rates(&s->column, NV_DATA_S(s->y), NV_DATA_S(s->rates));
    return code ? fail(err, size, "column: outputs at the present state", err_text(code)) : true;
}

struct column_solver *column_solver_create(const struct column_config *config,
                                           const struct column_inputs *inputs,
                                           const struct column_solver_options *options, char *err,
                                           size_t err_size)
{
    struct column_fault fault;
    struct column_solver *s = calloc(1, sizeof *s);

    if (!s) {
        fail(err, err_size, "column", "no memory");
        return NULL;
    }
    if (column_init(&s->column, config, &fault)) {
        snprintf(err, err_size, "column: %s must be %s", fault.field, fault.wanted);
        free(s);
        return NULL;
    }
    if (options)
        s->options = *options;
    s->options.relative = s->options.relative > 0.0 ? s->options.relative : 3e-6;
    s->options.absolute = s->options.absolute > 0.0 ? s->options.absolute : 3e-8;
    s->options.residual = s->options.residual > 0.0 ? s->options.residual : 1e-9;
    s->n = s->column.n_states;
    s->restart = true;

    if (SUNContext_Create(NULL, &s->context) < 0 || !make_vectors(s)) {
        fail(err, err_size, "column", "no memory for SUNDIALS");
        column_solver_destroy(s);
        return NULL;
    }
    straight_line(s);
    if (!column_solver_set_inputs(s, inputs, err, err_size) || !make_cvode(s, err, err_size) ||
        !make_kinsol(s, err, err_size)) {
        column_solver_destroy(s);
        return NULL;
    }
    return s;
}

void column_solver_destroy(struct column_solver *s)
{
    if (!s)
        return;
    if (s->cvode)
        CVodeFree(&s->cvode);
    if (s->kinsol)
        KINFree(&s->kinsol);
    if (s->band_solver)
        SUNLinSolFree(s->band_solver);
    if (s->kin_solver)
        SUNLinSolFree(s->kin_solver);
    if (s->band)
        SUNMatDestroy(s->band);
    if (s->kin_matrix)
        SUNMatDestroy(s->kin_matrix);
    N_Vector *vectors[] = {&s->y, &s->rates, &s->saved, &s->absolute, &s->scale, &s->constraints};
    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
        if (*vectors[i])
            N_VDestroy(*vectors[i]);
    if (s->context)
        SUNContext_Free(&s->context);
    free(s);
}

bool column_solver_set_inputs(struct column_solver *s, const struct column_inputs *inputs,
                              char *err, size_t err_size)
{
    struct column_fault fault;

    if (column_set_inputs(&s->column, inputs, &fault)) {
        snprintf(err, err_size, "column input %s must be %s", fault.field, fault.wanted);
        return false;
    }
    s->restart = true;
    return refresh(s, err, err_size);
}

/* Sets overshoots of the integrator back into [0, 1]. False when one is no mere overshoot. */
static bool confine(struct column_solver *s)
{
    size_t m = s->column.config->components - 1;
    double *x = NV_DATA_S(s->y);

    for (size_t i = 0; i < s->column.config->stages; i++, x += m) {
        double sum = 0.0;
        for (size_t j = 0; j < m; j++) {
            if (!(x[j] > -OVERSHOOT_ALLOWED && x[j] < 1.0 + OVERSHOOT_ALLOWED))
                return false;
            if (x[j] < 0.0) {
                x[j] = 0.0;
                s->restart = true;
            }
            sum += x[j];
        }
        if (sum > 1.0 + OVERSHOOT_ALLOWED)
            return false;
        for (size_t j = 0; sum > 1.0 && j < m; j++) {
            x[j] = m == 1 ? 1.0 : x[j] / sum;
            s->restart = true;
        }
    }
    return true;
}

bool column_solver_set_state(struct column_solver *s, const double *x, char *err, size_t err_size)
{
    memcpy(NV_DATA_S(s->saved), NV_DATA_S(s->y), s->n * sizeof *x);
    memcpy(NV_DATA_S(s->y), x, s->n * sizeof *x);
    s->restart = true;
    if (!confine(s)) {
        memcpy(NV_DATA_S(s->y), NV_DATA_S(s->saved), s->n * sizeof *x);
        return fail(err, err_size, "column state", "mole fractions must be in [0, 1]");
    }
    return refresh(s, err, err_size);
}

const double *column_solver_state(const struct column_solver *s)
{
    return NV_DATA_S(s->y);
}

double column_solver_time(const struct column_solver *s)
{
    return s->t;
}

static bool integrate(struct column_solver *s, double t, char *err, size_t size)
{
    char *(*name)(long) = CVodeGetReturnFlagName;
    long steps = 0;
    double reached;

    s->model_error = ERR_OK;
    if (s->restart) {
        s->work.restarts++;
        if (!checked(s, CVodeReInit(s->cvode, s->t, s->y), name, "CVodeReInit", err, size))
            return false;
        s->restart = false;
    }
    long before = 0;
    if (!checked(s, CVodeGetNumSteps(s->cvode, &before), name, "CVodeGetNumSteps", err, size) ||
        !checked(s, CVode(s->cvode, t, s->y, &reached, CV_NORMAL), name, "CVode", err, size) ||
        !checked(s, CVodeGetNumSteps(s->cvode, &steps), name, "CVodeGetNumSteps", err, size))
        return false;
    s->work.steps += steps - before;
    return confine(s) ? true
                      : fail(err, size, "column", "the integrator left mole fractions [0, 1]");
}

bool column_solver_advance(struct column_solver *s, double t, char *err, size_t err_size)
{
    if (!(t >= s->t && t < 1e300)) {
        snprintf(err, err_size, "column: advance to %g s, which is before the present %g s", t,
                 s->t);
        return false;
    }
    if (t == s->t)
        return true;
    N_VScale(1.0, s->y, s->saved);
    if (!integrate(s, t, err, err_size)) {
        N_VScale(1.0, s->saved, s->y);
        s->restart = true;
        char ignored[80];
        (void)refresh(s, ignored, sizeof ignored);
        return false;
    }
    s->t = t;
    return refresh(s, err, err_size);
}

/* Largest change per hour of any mole fraction at y, or a negative number where the model fails. */
static double unrest(struct column_solver *s)
{
    if (kinsol_residual(s->y, s->rates, s))
        return -1.0;
    return N_VMaxNorm(s->rates);
}

static bool newton(struct column_solver *s)
{
    s->model_error = ERR_OK;
    int flag = KINSol(s->kinsol, s->y, KIN_LINESEARCH, s->scale, s->scale);
    if (flag < 0 || !confine(s))
        return false;
    double left = unrest(s);
    return left >= 0.0 && left <= s->options.residual;
}

bool column_solver_settle(struct column_solver *s, char *err, size_t err_size)
{
    double start = s->t, span = 2.0 * HOUR;
    double *keep = malloc(s->n * sizeof *keep);
    double *guess = malloc(s->n * sizeof *guess);
    bool done = false, sound = keep && guess;

    if (!sound)
        fail(err, err_size, "column", "no memory");
    else
        memcpy(keep, NV_DATA_S(s->y), s->n * sizeof *keep);

    /* Each round: Newton, and if that fails a longer transient from where it started. A column without
     * vapour has no unique steady state; there the transient alone ends it. */
    for (int round = 0; sound && !done && round < 14; round++) {
        memcpy(guess, NV_DATA_S(s->y), s->n * sizeof *guess);
        done = newton(s);
        if (done)
            break;
        memcpy(NV_DATA_S(s->y), guess, s->n * sizeof *guess);
        s->restart = true;
        s->t = 0.0;
        sound = integrate(s, span, err, err_size);
        if (sound) {
            double left = unrest(s);
            done = left >= 0.0 && left <= s->options.residual;
            span *= 2.0;
        }
    }
    s->t = start;
    s->restart = true;
    if (sound && !done)
        sound = fail(err, err_size, "column", "no steady state found for these inputs");
    if (keep && !sound)
        memcpy(NV_DATA_S(s->y), keep, s->n * sizeof *keep);
    free(keep);
    free(guess);
    char ignored[80];
    return sound ? refresh(s, err, err_size) : (refresh(s, ignored, sizeof ignored), false);
}

const struct column *column_solver_column(const struct column_solver *s)
{
    return &s->column;
}

struct column_solver_work column_solver_work(const struct column_solver *s)
{
    return s->work;
}
