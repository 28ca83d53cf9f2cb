/* Timed console lines of a run, one a line of the file:
 *
 *     <time_s> <console line>      sent before the first sample at or after that plant time
 *     <time_s> ?<console line>     the same; an `err` reply is allowed, or a restart before the reply
 *     <time_s> ~until CODE[|CODE...] [LIMIT_S]
 *                                  what follows waits until the firmware has announced an event of one of these codes
 *                                  since the line before was sent; the run fails when that takes longer than LIMIT_S
 *     <time_s> ~end                the run ends here, whatever its duration
 *     # comment, and blank lines
 *
 * Times must not go backwards; after an `~until` a line whose time is past is sent at once.
 */
#ifndef REFLUX_HOST_SIM_SCRIPT_H
#define REFLUX_HOST_SIM_SCRIPT_H

#include <stdbool.h>
#include <stddef.h>

#define SCRIPT_LINE_SIZE 256

enum script_kind { SCRIPT_SEND, SCRIPT_UNTIL, SCRIPT_END };

struct script_line {
    enum script_kind kind;
    double time_s;
    double limit_s;   /* SCRIPT_UNTIL; negative: none */
    double waiting_s; /* since when it waits; negative: not yet */
    bool may_fail;
    bool may_be_cut; /* the controller may restart before it replies */
    unsigned line;   /* of the file, for messages */
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
