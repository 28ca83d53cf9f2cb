/* Tasks of reflux-sim with a plant alone, without a firmware: --list, --steady, --linearise, --step,
 * --table, --table-check. */
#ifndef REFLUX_HOST_SIM_PLANT_TASK_H
#define REFLUX_HOST_SIM_PLANT_TASK_H

#include <stdbool.h>
#include <stddef.h>

/* One of those options is on the command line. */
bool plant_task_wanted(int argc, char **argv);

/* Reads the command line and does it, onto stdout. Returns the exit status; the reason in err. */
int plant_task(int argc, char **argv, char *err, size_t err_size);

/* Lines for --help. */
extern const char plant_task_help[];

#endif
