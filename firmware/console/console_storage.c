/* Console commands on stored settings: save, load, defaults, dump. */
#include <string.h>

#include "console/console.h"
#include "storage/storage_record.h"

bool console_storage_poll(struct console *c)
{
    struct answer a;
    enum err err = operate_result(&c->session, &a);
    if (!operate_waits(&c->session))
        console_answer(c, err, &a);
    return true;
}

/* Begun, it is answered when it is over. */
static void begun(struct console *c, enum err err, const struct answer *a)
{
    if (err)
        console_answer(c, err, a);
}

void command_save(struct console *c, unsigned n, char **word)
{
    struct answer a;
    bool replace = n && strcmp(word[0], "replace") == 0;
    enum err err = operate_admit(&c->session, "save", &a);
    if (!err && n && !replace)
        console_err_about(c, ERR_PARSE, word[0], "only `save` or `save replace`");
    else
        begun(c, err ? err : operate_save(&c->session, replace, &a), &a);
}

void command_load(struct console *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    (void)word;
    begun(c, operate_load(&c->session, &a), &a);
}

void command_defaults(struct console *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    (void)word;
    console_answer(c, operate_defaults(&c->session, &a), &a);
}

static bool dump_line(struct console *c, unsigned n, struct text *line)
{
    const struct config *config = operate_view(&c->session);
    struct parameter p;
    if (n < 2) {
        text_str(line, n == 0 ? "begin" : "defaults");
        return true;
    }
    n -= 2;
    if (parameter_of(config, n, &p)) {
        if (!record_wanted(&p, config))
            return true;
        console_set_line(&p, config, line);
        return true;
    }
    if (!parameter_of(config, n - 1, &p))
        return false;
    text_str(line, "apply");
    return true;
}

void command_dump(struct console *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    console_list(c, dump_line, "");
}
