/* The nominal state of a column that comes from a file: at rest with perfect levels at the nominal inputs, some of
 * which are sought so that the state meets what the file asks of it (docs/use/columns.md, "The nominal state"). */
#ifndef REFLUX_HOST_SIM_COLUMN_TRIM_H
#define REFLUX_HOST_SIM_COLUMN_TRIM_H

#include "columns/column_plant.h"

/* A value that the state must have, and the input that is moved until it has. */
struct column_trim {
    size_t seen;   /* index in terms->seen */
    double value;  /* wanted, in the channel's unit */
    size_t driven; /* index in terms->driven: a channel, or a constant */
    double lo, hi; /* of the input, in its unit */
};

/* Seeks the trims, from the nominal values in the table: Newton with differences, damped, between lo and hi. What is
 * found is rounded to seven significant digits and written into channels[] (the class's, inputs first) or into the
 * constant's value. *at and x[stages (components - 1)]: the column at rest there, with holdups that do not move. False with the reason in err: what could not be met, and what came nearest. */
bool column_trim_find(const struct column_config *config, struct column_terms *terms,
                      struct plant_channel *channels, const struct column_trim *trim, size_t n,
                      struct column *at, double *x, char *err, size_t err_size);

#endif
