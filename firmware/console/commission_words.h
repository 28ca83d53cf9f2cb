/* Texts that the listings of `commission` share: names of channels, flags, and lines in place of missing results. */
#ifndef REFLUX_CONSOLE_COMMISSION_WORDS_H
#define REFLUX_CONSOLE_COMMISSION_WORDS_H

#include "console/reply.h"

#define RESULTS_DISCARDED "results discarded: the workspace was leased for something else"

/* Channels of the tests by their place there, as the settings in force have them. */
const struct measurement_config *commission_measurement(const struct client *c, unsigned j);
const struct mv_config *commission_output(const struct client *c, unsigned k);
/* The unit, or "-". */
void commission_unit(struct text *t, const char *unit);
/* " flags no_gain short", or " flags -" */
void commission_flags(struct text *t, unsigned bits);
/* True: there is nothing to list, and line 0 says why. */
bool commission_has_nothing(struct client *c, unsigned n, struct text *line);

#endif
