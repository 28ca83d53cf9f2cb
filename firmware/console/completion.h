/* Completion of a command line. */
#ifndef REFLUX_CONSOLE_COMPLETION_H
#define REFLUX_CONSOLE_COMPLETION_H

#include "base/text.h"

/* For the line editor: the n-th word that may be typed next, by the arguments of the command's row. False past the end. */
bool console_choice(void *client, const char *line, unsigned n, struct text *word);

#endif
