/* Inner loops and feedforwards of a proposal. */
#ifndef REFLUX_CONSOLE_COMMISSION_STRUCTURAL_H
#define REFLUX_CONSOLE_COMMISSION_STRUCTURAL_H

#include "console/reply.h"

/* The last lines of `commission proposal`; false past the end. */
bool commission_structural_line(struct client *c, unsigned n, struct text *line);

#endif
