/* A column as matrices: differences of the model in long double (column_precise.h), through column_terms.h. */
#ifndef REFLUX_HOST_SIM_COLUMN_LINEARISE_H
#define REFLUX_HOST_SIM_COLUMN_LINEARISE_H

#include "columns/column_terms.h"
#include "linear/linearise.h"

/* Fills the matrices of l at its point, as plant_class.linearise says. class: for names and spans of the channels, of which
 * the first are the inputs and the rest are the terms' seen[]. */
bool column_linearise(const struct plant_class *class, const struct column *column,
                      const struct column_terms *terms, struct linearised *l, char *err,
                      size_t err_size);

#endif
