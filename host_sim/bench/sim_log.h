/* The run as the simulator saw it, CSV: two comment lines, a header with units, one row a sample. Doubles with
 * 17 and floats with 9 significant digits, so that they read back bit for bit. Appended and flushed as it grows:
 * a killed run keeps what it had. */
#ifndef REFLUX_HOST_SIM_SIM_LOG_H
#define REFLUX_HOST_SIM_SIM_LOG_H

#include <stdio.h>

#include "instruments.h"

#define SIM_LOG_FORMAT 1

struct sim_log {
    FILE *file; /* NULL: no log wanted */
    unsigned rows;
};

bool sim_log_open(struct sim_log *log, const char *path, const struct instruments *in,
                  const char *comment, char *err, size_t err_size);
/* Begins a log in a file that is open, and owns the file from then on. */
void sim_log_begin(struct sim_log *log, FILE *file, const struct instruments *in,
                   const char *comment);

/* One row: the sample, the plant it was taken from, and the command that answered it. */
void sim_log_row(struct sim_log *log, const struct instruments *in, const struct plant *plant,
                 const struct link_sample *sample, const struct link_command *command);
/* False when the disk did not take everything. */
bool sim_log_close(struct sim_log *log);

#endif
