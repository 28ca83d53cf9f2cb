/* The table of commands, made of the rows of commands.h. */
#ifndef REFLUX_CONSOLE_COMMAND_TABLE_H
#define REFLUX_CONSOLE_COMMAND_TABLE_H

#include "console/commands.h"
#include "console/reply.h"

struct console_command {
    const char *name;
    const char *arguments;
    const char *help;
    unsigned words_min, words_max; /* words after the name */
    void (*run)(struct client *c, unsigned n, char **word);
};

/* One function for each row, in console_*.c by subject. */
#define RUNS(name, ...) void command_##name(struct client *c, unsigned n, char **word);
CONSOLE_COMMANDS(RUNS)
#undef RUNS

extern const struct console_command console_commands[];
extern const unsigned console_command_count;

/* NULL: there is no command of that name. */
const struct console_command *find_command(const char *name);
/* err PARSE subject: usage: name arguments; the subject may be NULL */
void reply_usage(struct client *c, const char *subject, const char *name);

#endif
