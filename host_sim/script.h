/* Timed console lines of a run, one a line of the file:
 *
 *     <time_s> <console line>      sent before the first sample at or after that plant time
 *     <time_s> ?<console line>     the same; an `err` reply is allowed
 *     # comment, and blank lines
 *
 * Times must not go backwards. `~` at the beginning of a console line is reserved.
 */
#ifndef REFLUX_HOST_SIM_SCRIPT_H
#define REFLUX_HOST_SIM_SCRIPT_H

#include <stdbool.h>
#include <stddef.h>

#define SCRIPT_LINE_SIZE 256

struct script_line {
    double time_s;
    bool may_fail;
    unsigned at; /* line of the file, for messages */
    char text[SCRIPT_LINE_SIZE];
};

struct script {
    struct script_line *list;
    size_t n, next;
    char file[256];
};

/* Reads a file; on error one line with file, line number and what would be right. */
bool script_load(struct script *s, const char *path, char *err, size_t err_size);

/* Reads one line of a script, number `at` of its file. Comments and blank lines add nothing. */
bool script_add(struct script *s, const char *line, unsigned at, char *err, size_t err_size);
void script_free(struct script *s);

#endif
