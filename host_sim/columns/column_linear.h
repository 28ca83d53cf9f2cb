/* The Newton matrices of a column (column_newton.h) as SUNDIALS' matrix and linear solver. */
#ifndef REFLUX_HOST_SIM_COLUMN_LINEAR_H
#define REFLUX_HOST_SIM_COLUMN_LINEAR_H

#include "model/column.h"

#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>

/* NULL when there is no memory. config must outlive them. Free with SUNMatDestroy and SUNLinSolFree. */
SUNMatrix column_matrix(const struct column_config *config, SUNContext context);
SUNLinearSolver column_linear_solver(SUNContext context);

/* Makes the matrix scale times the Jacobian at the point of the last column_rates with the same x. */
void column_matrix_read(SUNMatrix matrix, const struct column *column, const double *x,
                        double scale);

#endif
