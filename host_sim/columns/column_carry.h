/* The numbers that make a column, as doubles, so that a build of the model (firmware/model) in another precision can have the
 * same column: one build writes them, the other reads them. Built with each of them, like the model itself. */
#ifndef REFLUX_HOST_SIM_COLUMN_CARRY_H
#define REFLUX_HOST_SIM_COLUMN_CARRY_H

#include "model/activity.h"
#include "model/column.h"

#ifdef MODEL_SYMBOL
#define column_carry_out MODEL_SYMBOL(column_carry_out)
#define column_carry_in  MODEL_SYMBOL(column_carry_in)
#endif

#define COLUMN_CARRY_TABLE (COLUMN_COMPONENTS_MAX * COLUMN_COMPONENTS_MAX)
#define COLUMN_CARRY_MAX   (48 + 16 * COLUMN_COMPONENTS_MAX + 3 * COLUMN_CARRY_TABLE)

/* A column's config with room for what it points to, and its reference flows. */
struct column_carried {
    struct column_config config;
    struct component component[COLUMN_COMPONENTS_MAX];
    struct activity activity;
    real_t a[COLUMN_CARRY_TABLE], b[COLUMN_CARRY_TABLE], alpha[COLUMN_CARRY_TABLE];
    struct column_flows reference;
};

/* Writes number[COLUMN_CARRY_MAX]: the config and reference of a column. False where its activity coefficients are not those
 * of model/activity.h: a function cannot be carried. */
bool column_carry_out(const struct column_config *config, const struct column_flows *reference,
                      double *number);

/* The same column from them. *to must stay where it is: its config points into it. */
void column_carry_in(const double *number, struct column_carried *to);

#endif
