/* reflux-sim --table and --table-check: the compact table of a column for a board (docs/methods/column-table.md). */
#ifndef REFLUX_HOST_SIM_TABLE_TASK_H
#define REFLUX_HOST_SIM_TABLE_TASK_H

#include "columns/table_lines.h"
#include "plants/plant.h"

/* Options of the command line; NULL: none. */
struct table_task {
    const char *components, *closing, *truncated, *antoine;
    double block;
};

/* The table of this plant, a column at a steady state, and what it says to the board. */
bool table_task_make(const struct plant_class *class, const struct plant *p,
                     const struct table_task *task, struct table_lines *lines,
                     struct table_says *says, char *err, size_t err_size);
/* Console lines of the table of this plant, a column at a steady state. They have been read as the board does before. */
bool table_task_print(const struct plant_class *class, const struct plant *p,
                      const struct table_task *task, char *err, size_t err_size);
/* Prints the tables in a file of such lines. False, with the fault in err, if one is wrong. */
bool table_task_check(const char *file, char *err, size_t err_size);

#endif
