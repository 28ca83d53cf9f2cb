/* "did you mean": the known word that is nearest to one that is unknown. */
#ifndef REFLUX_CONSOLE_SUGGESTION_H
#define REFLUX_CONSOLE_SUGGESTION_H

#include "console/command_table.h"

#if CONFIG_PEOPLE

/* Lets refusals of unknown words suggest one. */
void suggestion_init(struct client *c);
/* Names the command whose refusals come next; NULL: its name is unknown. */
static inline void suggestion_begin(struct client *c, const struct console_command *command)
{
    c->hint.command = command;
}

#else
static inline void suggestion_init(struct client *c)
{
    (void)c;
}
static inline void suggestion_begin(struct client *c, const struct console_command *command)
{
    (void)c;
    (void)command;
}
#endif

#endif
