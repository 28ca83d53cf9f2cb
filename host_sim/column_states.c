#include "column_states.h"

#include "base/error.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

size_t column_states_count(const struct column_solver *s)
{
    return column_solver_column(s)->n_states;
}

void column_states_get(const struct column_solver *s, double *x)
{
    memcpy(x, column_solver_state(s), column_states_count(s) * sizeof(*x));
}

bool column_states_rates(const struct column_solver *s, double *rates, char *err, size_t err_size)
{
    struct column *copy =
        malloc(sizeof(*copy)); /* rates leave traces in a column, and it is large */
    if (copy == NULL) {
        (void)snprintf(err, err_size, "column: out of memory");
        return false;
    }
    *copy = *column_solver_column(s);
    enum err e = column_rates(copy, column_solver_state(s), rates);
    free(copy);
    if (e != ERR_OK) {
        (void)snprintf(err, err_size, "column: no rates at this state: %s", err_text(e));
    }
    return e == ERR_OK;
}
