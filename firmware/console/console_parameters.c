/* Console commands on parameters: list, get, set, diff, help NAME, begin, apply, abandon. */
#include <string.h>

#include "console/console.h"
#include "settings/parameters.h"

static void value_line(const struct parameter *p, const struct config *config, struct text *line)
{
    parameter_name(p, line);
    text_str(line, " = ");
    parameter_value(p, config, line);
    if (parameter_unit(p)[0]) {
        text_char(line, ' ');
        text_str(line, parameter_unit(p));
    }
#if CONFIG_BLOCKS
    if (p->field->type == PARAMETER_KIND && block_is_unknown(config, p->index))
        text_str(line, " unknown");
#endif
}

/* Channels, loops and elements without a name are not in use. */
static bool in_use(const struct parameter *p, const struct config *config)
{
    struct parameter first = *p;
    char name[CHANNEL_NAME_SIZE];
    struct text t = text_on(name, sizeof name);
    first.field = &p->group->fields[0];
    if (!p->group->indexed)
        return true;
#if CONFIG_BLOCKS
    if (p->group == &parameter_blocks)
        return config->block[p->index].kind[0] != '\0';
#endif
    if (first.field->type == PARAMETER_NAME) {
        parameter_value(&first, config, &t);
        return strcmp(name, "-") != 0;
    }
    char range[CHANNEL_NAME_SIZE];
    struct text d = text_on(range, sizeof range);
    parameter_default(p, config, &d);
    parameter_value(p, config, &t);
    return strcmp(name, range) != 0;
}

static bool list_line(struct console *c, unsigned n, struct text *line)
{
    const struct config *config = operate_view(&c->session);
    struct parameter p;
    char name[40];
    struct text t = text_on(name, sizeof name);
    if (!parameter_of(config, n, &p))
        return false;
    parameter_name(&p, &t);
    bool all = strcmp(c->argument, "all") == 0;
    bool shown = c->argument[0] && !all ? strncmp(name, c->argument, strlen(c->argument)) == 0
                                        : all || in_use(&p, config);
    if (shown)
        value_line(&p, config, line);
    return true;
}

void command_list(struct console *c, unsigned n, char **word)
{
    const struct config *config = operate_view(&c->session);
    const char *prefix = n ? word[0] : "";
    struct parameter p;
    char name[40];
    bool found = !n || strcmp(prefix, "all") == 0;
    for (unsigned i = 0; !found && parameter_of(config, i, &p); i++) {
        struct text t = text_on(name, sizeof name);
        parameter_name(&p, &t);
        found = strncmp(name, prefix, strlen(prefix)) == 0;
    }
    if (!found) {
        char reason[140];
        struct text t = text_on(reason, sizeof reason);
        text_str(&t, "no parameter begins so; groups are");
        for (unsigned g = 0; g < parameter_group_count; g++) {
            text_char(&t, ' ');
            text_str(&t, parameter_groups[g].name);
        }
#if CONFIG_BLOCKS
        text_char(&t, ' ');
        text_str(&t, parameter_blocks.name);
#endif
        console_err_about(c, ERR_UNKNOWN, prefix, reason);
        return;
    }
    console_list(c, list_line, prefix);
}

void command_get(struct console *c, unsigned n, char **word)
{
    struct answer a;
    struct parameter p;
    char line[CONSOLE_OUTPUT_MAX];
    struct text t = text_on(line, sizeof line);
    (void)n;
    enum err err = operate_find_parameter(&c->session, word[0], &p, &a);
    if (err) {
        console_answer(c, err, &a);
        return;
    }
    value_line(&p, operate_view(&c->session), &t);
    console_print(c, line);
    console_ok(c);
}

void command_set(struct console *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    console_answer(c, operate_set(&c->session, word[0], word[1], &a), &a);
}

void console_set_line(const struct parameter *p, const struct config *config, struct text *line)
{
#if CONFIG_BLOCKS
    if (p->group == &parameter_blocks && block_is_unknown(config, p->index))
        text_str(line, "# ");
#endif
    text_str(line, "set ");
    parameter_name(p, line);
    text_char(line, ' ');
    parameter_value(p, config, line);
}

/* Beside what has changed, what would else move along with it when the lines are pasted. */
static bool staged_line(const struct console *c, const struct parameter *p)
{
    const float *source = parameter_follows(p, operate_view(&c->session));
    return operate_changes(&c->session, p) ||
           (source && *source != *parameter_follows(p, operate_settings(&c->session)));
}

static bool diff_line(struct console *c, unsigned n, struct text *line)
{
    struct parameter p;
    const struct config *config = operate_view(&c->session);
    if (!parameter_of(config, n, &p))
        return false;
    bool same;
    if (c->argument[0] == 's') { /* staged against the plan */
        same = !staged_line(c, &p);
    } else if (p.field->type >= PARAMETER_KIND) { /* longer texts */
        same = parameter_is_default(&p, config);
    } else {
        char a[40], b[40];
        struct text ta = text_on(a, sizeof a), tb = text_on(b, sizeof b);
        parameter_value(&p, config, &ta);
        parameter_default(&p, config, &tb);
        same = strcmp(a, b) == 0;
    }
    if (same)
        return true;
    console_set_line(&p, config, line);
    return true;
}

void command_diff(struct console *c, unsigned n, char **word)
{
    if (n && strcmp(word[0], "defaults") != 0) {
        console_err_about(c, ERR_PARSE, word[0], "only `diff` or `diff defaults`");
        return;
    }
    /* In a transaction: what it changes. Else: what differs from the defaults. As commands to paste. */
    console_list(c, diff_line, operate_is_open(&c->session) && !n ? "staged" : "defaults");
}

bool parameter_help(struct console *c, unsigned n, struct text *line)
{
    struct parameter p;
    if (n > 3 || parameter_find_in(operate_view(&c->session), c->argument, &p) != ERR_OK)
        return false;
    if (n == 0) {
        value_line(&p, operate_view(&c->session), line);
    } else if (n == 1) {
        text_str(line, "  ");
        text_str(line, parameter_about(&p));
    } else if (n == 2) {
        text_str(line, "  allowed: ");
        parameter_range(&p, line);
        if (parameter_unit(&p)[0]) {
            text_char(line, ' ');
            text_str(line, parameter_unit(&p));
        }
    } else {
        text_str(line, "  default: ");
        parameter_default(&p, operate_view(&c->session), line);
        text_str(line, "  id: 0x");
        text_hex(line, parameter_id(&p), parameter_id(&p) >> 16 ? 8 : 4);
    }
    return true;
}

void command_begin(struct console *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    (void)word;
    console_answer(c, operate_begin(&c->session, &a), &a);
}

#if CONFIG_BLOCKS
/* Prints what blocks have switched off while the transaction was open. */
static void say_switched_off(struct console *c)
{
    char line[CONSOLE_OUTPUT_MAX];
    struct text t = text_on(line, sizeof line);
    struct parameter p;
    uint8_t block;
    float value;
    text_str(&t, "# switched off meanwhile:");
    unsigned k = 0;
    for (; operate_switched_off(&c->session, true, k, &block, &p, &value); k++) {
        text_str(&t, k ? ", " : " ");
        parameter_name(&p, &t);
    }
    if (k)
        console_print(c, line);
}
#else
#define say_switched_off(c) ((void)(c))
#endif

void command_apply(struct console *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    (void)word;
    enum err err = operate_apply(&c->session, &a);
    if (!err)
        say_switched_off(c);
    console_answer(c, err, &a);
}

void command_abandon(struct console *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    (void)word;
    console_answer(c, operate_abandon(&c->session, &a), &a);
}
