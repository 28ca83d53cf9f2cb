/* Makes the compact table of a column (docs/methods/column-table.md) from a simulated one at a steady state. */
#ifndef REFLUX_HOST_SIM_COLUMN_TABLE_MAKE_H
#define REFLUX_HOST_SIM_COLUMN_TABLE_MAKE_H

#include "columns/table_lines.h"
#include "model/column.h"

/* Options of the user; NULL: none. */
struct table_wish {
    const char *components; /* "C3,iC4,nC4": those of the table, all of them if nothing is said */
    const char *closing;    /* the one that takes what is left: the last of them */
    const char *truncated;  /* "2-10,12": stages without a composition of their own */
    const char *antoine;    /* "320-370": vapour pressures by three constants, fitted there, K */
};

/* The column is evaluated at its state x. heat_loss in W. False: what is wrong in err. */
bool column_table_make(const struct column *column, const double *x, const char *title,
                       double heat_loss, const struct table_wish *wish, struct table_lines *lines,
                       char *err, size_t err_size);

#endif
