/* CVODE: BDF with Newton, for smooth stretches. */
#include "columns/column_solver_inside.h"

#include <cvode/cvode.h>

#include "columns/column_linear.h"

static int jacobian(realtype t, N_Vector y, N_Vector fy, SUNMatrix matrix, void *user, N_Vector a,
                    N_Vector b, N_Vector c)
{
    struct column_solver *s = user;
    (void)t, (void)a, (void)b, (void)c;
    if (column_solver_rates(t, y, fy, s)) /* once more: the flows inside must be those at y */
        return 1;
    s->work.jacobians++;
    column_matrix_read(matrix, &s->column, NV_DATA_S(y), 1.0);
    return 0;
}

bool column_bdf_create(struct column_solver *s, char *err, size_t size)
{
    s->cvode = CVodeCreate(CV_BDF, s->context);
    s->matrix = column_matrix(s->column.config, s->context);
    s->linear = column_linear_solver(s->context);
    if (!s->cvode || !s->matrix || !s->linear)
        return column_solver_fail(err, size, "column", "no memory for the integrator");

    const struct {
        int flag;
        char *(*name)(long);
        const char *call;
    } calls[] = {
        {CVodeSetErrHandlerFn(s->cvode, column_solver_keep_message, s), CVodeGetReturnFlagName,
         "CVodeSetErrHandlerFn"},
        {CVodeInit(s->cvode, column_solver_rates, 0.0, s->y), CVodeGetReturnFlagName, "CVodeInit"},
        {CVodeSetUserData(s->cvode, s), CVodeGetReturnFlagName, "CVodeSetUserData"},
        {CVodeSVtolerances(s->cvode, s->options.relative, s->absolute), CVodeGetReturnFlagName,
         "CVodeSVtolerances"},
        {CVodeSetLinearSolver(s->cvode, s->linear, s->matrix), CVodeGetLinReturnFlagName,
         "CVodeSetLinearSolver"},
        {CVodeSetJacFn(s->cvode, jacobian), CVodeGetLinReturnFlagName, "CVodeSetJacFn"},
        {CVodeSetMaxNumSteps(s->cvode, 200000), CVodeGetReturnFlagName, "CVodeSetMaxNumSteps"},
        {CVodeSetMaxErrTestFails(s->cvode, 20), CVodeGetReturnFlagName, "CVodeSetMaxErrTestFails"},
        {CVodeSetMaxConvFails(s->cvode, 20), CVodeGetReturnFlagName, "CVodeSetMaxConvFails"},
    };
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++)
        if (!column_solver_checked(s, calls[i].flag, calls[i].name, calls[i].call, err, size))
            return false;
    return true;
}

bool column_bdf_run(struct column_solver *s, double t, bool afresh, char *err, size_t size)
{
    char *(*name)(long) = CVodeGetReturnFlagName;
    long before = 0, after = 0;
    double reached;

    s->model_error = ERR_OK;
    if (afresh) {
        s->work.restarts++;
        if (!column_solver_checked(s, CVodeReInit(s->cvode, s->t, s->y), name, "CVodeReInit", err,
                                   size))
            return false;
    }
    if (!column_solver_checked(s, CVodeGetNumSteps(s->cvode, &before), name, "CVodeGetNumSteps",
                               err, size) ||
        !column_solver_checked(s, CVode(s->cvode, t, s->y, &reached, CV_NORMAL), name, "CVode", err,
                               size) ||
        !column_solver_checked(s, CVodeGetNumSteps(s->cvode, &after), name, "CVodeGetNumSteps", err,
                               size))
        return false;
    s->work.steps += after - before;
    return true;
}

void column_bdf_free(struct column_solver *s)
{
    if (s->cvode)
        CVodeFree(&s->cvode);
    if (s->linear)
        SUNLinSolFree(s->linear);
    if (s->matrix)
        SUNMatDestroy(s->matrix);
}
