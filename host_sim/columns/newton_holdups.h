/* The part of a column's Newton matrices that belongs to holdups that move (column_newton.h has the rest).
 *
 * Flows depend on holdups, and composition on flows; that flows depend on compositions is left out as everywhere in these
 * matrices. So the holdups are solved for first, and what they do to the compositions goes to the right-hand side. A
 * holdup acts on the liquid leaving its stage, hence on the stage below, and the reboiler's on the vapour of all stages:
 * elimination from the drum down with the reboiler's as a parameter, linear in the stages. */
#ifndef REFLUX_HOST_SIM_NEWTON_HOLDUPS_H
#define REFLUX_HOST_SIM_NEWTON_HOLDUPS_H

#include "model/column.h"

#include <stdbool.h>

struct newton_holdups; /* opaque */

/* NULL when there is no memory. For a column whose holdups move. */
struct newton_holdups *newton_holdups_create(const struct column_config *config);
void newton_holdups_destroy(struct newton_holdups *h);

/* As column_newton_read and column_newton_copy. */
void newton_holdups_read(struct newton_holdups *h, const struct column *column, const double *x);
void newton_holdups_copy(const struct newton_holdups *from, struct newton_holdups *to);

/* Levels that nothing holds are constant from the next factors on, or no longer. */
void newton_holdups_hold(struct newton_holdups *h, bool held);

/* Factors the holdups' block of a I + c J. False where it is singular. */
bool newton_holdups_factor(struct newton_holdups *h, double a, double c);

/* Holdups of (a I + c J) x = b, from b[n_states] into x[n_states]. Returns the right-hand side that is left for the mole
 * fractions, [stages (C - 1)], good until the next call. b and x may be the same. */
const double *newton_holdups_solve(const struct newton_holdups *h, const double *b, double *x);

#endif
