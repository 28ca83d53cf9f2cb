/* The table of commands. */
#include "console/command_table.h"

#include "console/phrases.h"
#include "console/spelling.h"

#define ROW(name, arguments, help, words_min, words_max)                                           \
    {#name, arguments, help, words_min, words_max, command_##name},
const struct console_command console_commands[] = {CONSOLE_COMMANDS(ROW)};
#undef ROW
const unsigned console_command_count = sizeof console_commands / sizeof console_commands[0];

const struct console_command *find_command(const char *name)
{
    name = usual_name(name);
    for (unsigned i = 0; i < console_command_count; i++)
        if (same_letters(console_commands[i].name, name))
            return &console_commands[i];
    return NULL;
}

void reply_usage(struct client *c, const char *subject, const char *name)
{
    char usage[CONSOLE_OUTPUT_MAX];
    struct text t = text_on(usage, sizeof usage);
    text_str(&t, "usage:");
    put_word(&t, name);
    put_word(&t, find_command(name)->arguments);
    reply_err_about(c, ERR_PARSE, subject, usage);
}
