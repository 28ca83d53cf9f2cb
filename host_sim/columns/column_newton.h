/* Newton matrices of a column, a I + c J, factored and solved stage by stage.
 *
 * J is the Jacobian of column_rates with flows and holdups held, and nothing else left out: with the vapour
 * leaving the stages as unknowns of their own, the Murphree recursion ties each stage to its neighbours only,
 * where J itself is full below the diagonal. Elimination upwards then costs one inverse of C - 1 by C - 1 for
 * each stage: cost linear in the stages, cubic in the components. Pivots are sought within a stage alone.
 *
 * Where holdups move, J has what they do to flows, to each other and to the mole fractions (newton_holdups.h). */
#ifndef REFLUX_HOST_SIM_COLUMN_NEWTON_H
#define REFLUX_HOST_SIM_COLUMN_NEWTON_H

#include "model/column.h"

#include <stdbool.h>

struct column_newton; /* opaque */

/* NULL when there is no memory. */
struct column_newton *column_newton_create(const struct column_config *config);
void column_newton_destroy(struct column_newton *n);

/* Takes J at the point of the last column_rates with the same x. */
void column_newton_read(struct column_newton *n, const struct column *column, const double *x);
void column_newton_copy(const struct column_newton *from, struct column_newton *to);

/* Levels that nothing holds count as constant from the next factors on (true), or no longer. */
void column_newton_hold(struct column_newton *n, bool held);

/* Factors a I + c J; a 0 or more, c not 0. False where a stage's matrix is singular. */
bool column_newton_factor(struct column_newton *n, double a, double c);

/* (a I + c J) x = b with the factors made last; b and x may be the same. */
void column_newton_solve(const struct column_newton *n, const double *b, double *x);

#endif
