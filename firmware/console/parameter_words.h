/* Parameters as lines of text. */
#ifndef REFLUX_CONSOLE_PARAMETER_WORDS_H
#define REFLUX_CONSOLE_PARAMETER_WORDS_H

#include "settings/parameters.h"

/* "loop1.gain = 2.5 kW/degC" */
void parameter_value_line(const struct parameter *p, const struct config *config,
                          struct text *line);
/* The command that sets a parameter to its value. A remark where this build lacks the kind of the block. */
void parameter_set_line(const struct parameter *p, const struct config *config, struct text *line);
/* "0 .. 100 degC", the values that the parameter takes. */
void parameter_range_words(const struct parameter *p, struct text *t);
/* A line of `help` on a parameter: value, meaning, range, default and id. False past the end. */
bool parameter_help_line(const struct parameter *p, const struct config *config, unsigned n,
                         struct text *line);

#endif
