/* Console command `help`. */
#include <string.h>

#include "console/command_table.h"
#include "console/parameter_words.h"
#include "console/phrases.h"

static void command_words(const struct console_command *command, struct text *line)
{
    text_str(line, command->name);
    put_word(line, command->arguments);
    while (line->n < 34)
        text_char(line, ' ');
    put_word(line, command->help);
}

static bool help_line(struct client *c, unsigned n, struct text *line)
{
    (void)c;
    if (n >= console_command_count)
        return false;
    command_words(&console_commands[n], line);
    return true;
}

static bool one_command_line(struct client *c, unsigned n, struct text *line)
{
    const struct console_command *command = find_command(c->argument);
    if (n > 0 || !command)
        return false;
    command_words(command, line);
    return true;
}

static bool parameter_help(struct client *c, unsigned n, struct text *line)
{
    struct parameter p;
    const struct config *config = operate_view(&c->session);
    return parameter_find_in(config, c->argument, &p) == ERR_OK &&
           parameter_help_line(&p, config, n, line);
}

void command_help(struct client *c, unsigned n, char **word)
{
    struct parameter p;
    if (n == 0)
        reply_list(c, help_line, "");
    else if (find_command(word[0]))
        reply_list(c, one_command_line, word[0]);
    else if (parameter_find_in(operate_view(&c->session), word[0], &p) == ERR_OK)
        reply_list(c, parameter_help, word[0]);
    else
        reply_err_about(c, ERR_UNKNOWN, word[0], "neither a command nor a parameter");
}
