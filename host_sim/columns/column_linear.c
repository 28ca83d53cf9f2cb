#include "columns/column_linear.h"

#include <nvector/nvector_serial.h>
#include <stdlib.h>

#include "columns/column_newton.h"

/* The matrix a I + c J. */
struct content {
    const struct column_config *config;
    struct column_newton *newton;
    double a, c;
};

static struct content *of(SUNMatrix matrix)
{
    return matrix->content;
}

static SUNMatrix_ID get_id(SUNMatrix matrix)
{
    (void)matrix;
    return SUNMATRIX_CUSTOM;
}

static SUNMatrix clone(SUNMatrix matrix)
{
    return column_matrix(of(matrix)->config, matrix->sunctx);
}

static void destroy(SUNMatrix matrix)
{
    column_newton_destroy(of(matrix)->newton);
    free(matrix->content);
    SUNMatFreeEmpty(matrix);
}

static int zero(SUNMatrix matrix)
{
    of(matrix)->a = of(matrix)->c = 0.0;
    return 0;
}

static int copy(SUNMatrix from, SUNMatrix to)
{
    column_newton_copy(of(from)->newton, of(to)->newton);
    of(to)->a = of(from)->a;
    of(to)->c = of(from)->c;
    return 0;
}

static int scale_add_identity(realtype factor, SUNMatrix matrix)
{
    of(matrix)->a = factor * of(matrix)->a + 1.0;
    of(matrix)->c *= factor;
    return 0;
}

SUNMatrix column_matrix(const struct column_config *config, SUNContext context)
{
    SUNMatrix matrix = SUNMatNewEmpty(context);
    struct content *content = calloc(1, sizeof *content);
    struct column_newton *newton = column_newton_create(config);

    if (!matrix || !content || !newton) {
        column_newton_destroy(newton);
        free(content);
        if (matrix)
            SUNMatFreeEmpty(matrix);
        return NULL;
    }
    content->config = config;
    content->newton = newton;
    matrix->content = content;
    matrix->ops->getid = get_id;
    matrix->ops->clone = clone;
    matrix->ops->destroy = destroy;
    matrix->ops->zero = zero;
    matrix->ops->copy = copy;
    matrix->ops->scaleaddi = scale_add_identity;
    return matrix;
}

void column_matrix_read(SUNMatrix matrix, const struct column *column, const double *x,
                        double scale)
{
    column_newton_read(of(matrix)->newton, column, x);
    of(matrix)->a = 0.0;
    of(matrix)->c = scale;
}

static SUNLinearSolver_Type get_type(SUNLinearSolver solver)
{
    (void)solver;
    return SUNLINEARSOLVER_DIRECT;
}

static int setup(SUNLinearSolver solver, SUNMatrix matrix)
{
    (void)solver;
    const struct content *m = of(matrix);
    bool good = m->c != 0.0 && column_newton_factor(m->newton, m->a, m->c);
    return good ? SUNLS_SUCCESS : SUNLS_LUFACT_FAIL; /* recoverable */
}

static int solve(SUNLinearSolver solver, SUNMatrix matrix, N_Vector x, N_Vector b, realtype within)
{
    (void)solver, (void)within;
    column_newton_solve(of(matrix)->newton, NV_DATA_S(b), NV_DATA_S(x));
    return SUNLS_SUCCESS;
}

static int free_solver(SUNLinearSolver solver)
{
    SUNLinSolFreeEmpty(solver);
    return SUNLS_SUCCESS;
}

SUNLinearSolver column_linear_solver(SUNContext context)
{
    SUNLinearSolver solver = SUNLinSolNewEmpty(context);
    if (solver) {
        solver->ops->gettype = get_type;
        solver->ops->setup = setup;
        solver->ops->solve = solve;
        solver->ops->free = free_solver;
    }
    return solver;
}
