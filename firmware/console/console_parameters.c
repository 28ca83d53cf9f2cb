/* Console commands on parameters: list, get, set, diff, help NAME, begin, apply, abandon. */
#include <string.h>

#include "console/console.h"
#include "service/parameters.h"

/* What the operator is looking at: the transaction under way, or the plan everything will meet. */
static const struct config *view(const struct service *s)
{
    return s->staging ? &s->plan[s->newest ^ 1u].config : &service_plan(s)->config;
}

static void value_line(const struct parameter *p, const struct config *config, struct text *line)
{
    parameter_name(p, line);
    text_str(line, " = ");
    parameter_value(p, config, line);
    if (field_unit(p->field)[0]) {
        text_char(line, ' ');
        text_str(line, field_unit(p->field));
    }
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
    if (first.field->type == PARAMETER_NAME) {
        parameter_value(&first, config, &t);
        return strcmp(name, "-") != 0;
    }
    char range[CHANNEL_NAME_SIZE];
    struct text d = text_on(range, sizeof range);
    parameter_default(p, &d);
    parameter_value(p, config, &t);
    return strcmp(name, range) != 0;
}

static bool list_line(struct console *c, unsigned n, struct text *line)
{
    const struct config *config = view(c->service);
    struct parameter p;
    char name[40];
    struct text t = text_on(name, sizeof name);
    if (!parameter_at(n, &p))
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
    const char *prefix = n ? word[0] : "";
    struct parameter p;
    char name[40];
    bool found = !n || strcmp(prefix, "all") == 0;
    for (unsigned i = 0; !found && parameter_at(i, &p); i++) {
        struct text t = text_on(name, sizeof name);
        parameter_name(&p, &t);
        found = strncmp(name, prefix, strlen(prefix)) == 0;
    }
    if (!found) {
        char why[120];
        struct text t = text_on(why, sizeof why);
        text_str(&t, "no parameter begins so; groups are");
        for (unsigned g = 0; g < parameter_group_count; g++) {
            text_char(&t, ' ');
            text_str(&t, parameter_groups[g].name);
        }
        console_err_about(c, ERR_UNKNOWN, prefix, why);
        return;
    }
    console_list(c, list_line, prefix);
}

static bool find(struct console *c, const char *name, struct parameter *p)
{
    enum err err = parameter_find(name, p);
    if (err == ERR_OK)
        return true;
    if (err == ERR_UNSUPPORTED) {
        char line[CONSOLE_OUTPUT_MAX];
        struct text t = console_err_on(line, sizeof line, err);
        text_str(&t, name);
        text_str(&t, ": this board has ");
        text_u32(&t, p->group->count);
        text_str(&t, ", bytes needed for each more: ");
        text_u32(&t, (uint32_t)PLAN_BUFFERS * p->group->stride);
        console_err_line(c, line);
        return false;
    }
    console_err_about(c, ERR_UNKNOWN, name, "no such parameter; `list all` shows them");
    return false;
}

void command_get(struct console *c, unsigned n, char **word)
{
    struct parameter p;
    char line[CONSOLE_OUTPUT_MAX];
    struct text t = text_on(line, sizeof line);
    (void)n;
    if (!find(c, word[0], &p))
        return;
    value_line(&p, view(c->service), &t);
    console_print(c, line);
    console_ok(c);
}

void console_refuse_config(struct console *c, const struct config_fault *fault)
{
    if (!fault->group) {
        console_err(c, fault->code, "more requests waiting than the queue holds, try again");
        return;
    }
    char line[CONSOLE_OUTPUT_MAX];
    struct text t = console_err_on(line, sizeof line, fault->code);
    service_fault_name(fault, &t);
    text_str(&t, ": ");
    if (fault->subject[0]) {
        text_char(&t, '\'');
        text_str(&t, fault->subject);
        text_str(&t, "' ");
    }
    text_str(&t, fault->wanted);
    if (fault->bytes) {
        text_str(&t, ", bytes needed: ");
        text_u32(&t, fault->bytes);
        text_str(&t, ", there are: ");
        text_u32(&t, PLAN_ARENA_BYTES);
    }
    console_err_line(c, line);
}

static void refuse_value(struct console *c, enum err err, const struct parameter *p, char **word)
{
    char line[CONSOLE_OUTPUT_MAX];
    struct text t = console_err_on(line, sizeof line, err);
    text_str(&t, word[0]);
    text_str(&t, ": '");
    text_str(&t, word[1]);
    text_str(&t, err == ERR_READ_ONLY ? "' refused, " : "' refused, allowed: ");
    parameter_range(p, &t);
    if (field_unit(p->field)[0]) {
        text_char(&t, ' ');
        text_str(&t, field_unit(p->field));
    }
    console_err_line(c, line);
}

void command_set(struct console *c, unsigned n, char **word)
{
    struct service *s = c->service;
    struct parameter p;
    (void)n;
    if (!find(c, word[0], &p))
        return;
    /* Outside a transaction the staging copy serves for this one change. */
    struct config *staged = s->staging ? service_staged(s) : service_stage(s);
    enum err err = parameter_set(&p, staged, word[1]);
    if (err) {
        refuse_value(c, err, &p, word);
        return;
    }
    if (!s->staging) {
        struct config_fault fault;
        if (service_apply(s, staged, &fault) != ERR_OK) {
            console_refuse_config(c, &fault);
            return;
        }
    }
    console_ok(c);
}

static bool diff_line(struct console *c, unsigned n, struct text *line)
{
    struct parameter p;
    const struct config *config = view(c->service);
    if (!parameter_at(n, &p))
        return false;
    bool same;
    if (c->argument[0] == 's') { /* staged against the plan */
        same = parameter_equal(&p, config, &service_plan(c->service)->config);
    } else {
        char a[40], b[40];
        struct text ta = text_on(a, sizeof a), tb = text_on(b, sizeof b);
        parameter_value(&p, config, &ta);
        parameter_default(&p, &tb);
        same = strcmp(a, b) == 0;
    }
    if (same)
        return true;
    text_str(line, "set ");
    parameter_name(&p, line);
    text_char(line, ' ');
    parameter_value(&p, config, line);
    return true;
}

void command_diff(struct console *c, unsigned n, char **word)
{
    if (n && strcmp(word[0], "defaults") != 0) {
        console_err_about(c, ERR_PARSE, word[0], "only `diff` or `diff defaults`");
        return;
    }
    /* In a transaction: what it changes. Else: what differs from the defaults. As commands to paste. */
    console_list(c, diff_line, c->service->staging && !n ? "staged" : "defaults");
}

bool parameter_help(struct console *c, unsigned n, struct text *line)
{
    struct parameter p;
    if (n > 3 || parameter_find(c->argument, &p) != ERR_OK)
        return false;
    if (n == 0) {
        value_line(&p, view(c->service), line);
    } else if (n == 1) {
        text_str(line, "  ");
        text_str(line, p.field->help);
    } else if (n == 2) {
        text_str(line, "  allowed: ");
        parameter_range(&p, line);
        if (field_unit(p.field)[0]) {
            text_char(line, ' ');
            text_str(line, field_unit(p.field));
        }
    } else {
        text_str(line, "  default: ");
        parameter_default(&p, line);
        text_str(line, "  id: 0x");
        text_hex(line, parameter_id(&p), 4);
    }
    return true;
}

void command_begin(struct console *c, unsigned n, char **word)
{
    struct service *s = c->service;
    (void)n;
    (void)word;
    if (s->staging) {
        console_err(c, ERR_STATE, "a transaction is open already: apply or abandon it");
        return;
    }
    (void)service_stage(s);
    s->staging = true;
    console_ok(c);
}

void command_apply(struct console *c, unsigned n, char **word)
{
    struct service *s = c->service;
    struct config_fault fault;
    struct parameter p;
    (void)n;
    (void)word;
    if (!s->staging) {
        console_err(c, ERR_STATE, "no transaction is open: begin one first");
        return;
    }
    c->changes = 0;
    for (unsigned i = 0; parameter_at(i, &p); i++)
        c->changes += !parameter_equal(&p, service_staged(s), &service_plan(s)->config);
    if (service_apply(s, service_staged(s), &fault) != ERR_OK) {
        console_refuse_config(c, &fault); /* the transaction stays open to be mended */
        return;
    }
    s->staging = false;
    console_ok(c);
}

void command_abandon(struct console *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    if (!c->service->staging) {
        console_err(c, ERR_STATE, "no transaction is open");
        return;
    }
    c->service->staging = false;
    console_ok(c);
}
