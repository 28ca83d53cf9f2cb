/* Completion of a command line. */
#ifndef REFLUX_CONSOLE_COMPLETION_H
#define REFLUX_CONSOLE_COMPLETION_H

#include "console/reply.h"

/* For the line editor: the n-th word that may be typed next, by the arguments of the command's row. False past the end. */
bool console_choice(void *client, const char *line, unsigned n, struct text *word);
/* Puts the n-th word that a word of the arguments of a command stands for into *word, which may stay empty. Returns how many there are.
 * Parameters, their values and verbs depend on other words of the line. */
unsigned console_word(const struct client *c, const char *kind, size_t size, unsigned n,
                      struct text *word);

#endif
