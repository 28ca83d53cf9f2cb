/* Log of the commands to the plant's outputs, CSV: one row for each command that the plant takes, and for each time that it goes safe by itself.
 * The time is that of the port: a virtual board's own, else the clock of this computer. Flushed row by row.
 */
#ifndef REFLUX_HOST_SIM_OUTPUT_LOG_H
#define REFLUX_HOST_SIM_OUTPUT_LOG_H

#include <stdio.h>

#include "link/messages.h"
#include "plants/plant.h"

struct output_log {
    FILE *file; /* NULL: none wanted */
};

bool output_log_open(struct output_log *log, const char *path, const struct plant_class *class,
                     char *err, size_t err_size);
/* An output that is not driven is an empty cell: it keeps its value. */
void output_log_command(struct output_log *log, uint64_t ms, const struct link_command *command);
/* why: one word. safe: n values. */
void output_log_safe(struct output_log *log, uint64_t ms, const char *why,
                     const struct link_page *safe, size_t n);
/* False when the disk did not take everything. */
bool output_log_close(struct output_log *log);

#endif
