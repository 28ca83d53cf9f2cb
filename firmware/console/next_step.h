/* What to do next with a board that has no settings yet. */
#ifndef REFLUX_CONSOLE_NEXT_STEP_H
#define REFLUX_CONSOLE_NEXT_STEP_H

#include "console/reply.h"

#if CONFIG_PEOPLE
/* Writes the n-th line, for people only; false past the last. */
bool next_step_line(const struct client *c, unsigned n, struct text *line);
#else
static inline bool next_step_line(const struct client *c, unsigned n, struct text *line)
{
    (void)c;
    (void)n;
    (void)line;
    return false;
}
#endif

#endif
