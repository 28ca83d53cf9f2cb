/* Console commands on parameters: list, get, set, diff, begin, apply, abandon. */
#include <string.h>

#include "console/block_words.h"
#include "console/command_table.h"
#include "console/diff_saved.h"
#include "console/parameter_words.h"
#include "console/phrases.h"

/* Channels, loops and elements without a name are not in use. */
static bool in_use(const struct parameter *p, const struct config *config)
{
    struct parameter first = *p;
    char name[CHANNEL_NAME_SIZE];
    struct text t = text_on(name, sizeof name);
    first.field = &p->group->fields[0];
    if (!p->group->indexed)
        return true;
    if (is_in_block(p))
        return block_has_kind(p, config);
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

static bool list_line(struct client *c, unsigned n, struct text *line)
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
        parameter_value_line(&p, config, line);
    return true;
}

void command_list(struct client *c, unsigned n, char **word)
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
        text_str(&t, "no such parameters; groups are");
        for (unsigned g = 0; g < parameter_group_count; g++) {
            put_word(&t, parameter_groups[g].name);
        }
        block_group_name(&t);
        reply_err_about(c, ERR_UNKNOWN, prefix, reason);
        return;
    }
    reply_list(c, list_line, prefix);
}

void command_get(struct client *c, unsigned n, char **word)
{
    struct answer a;
    struct parameter p;
    char line[CONSOLE_OUTPUT_MAX];
    struct text t = text_on(line, sizeof line);
    (void)n;
    enum err err = operate_find_parameter(&c->session, word[0], &p, &a);
    if (err) {
        reply_answer(c, err, &a);
        return;
    }
    parameter_value_line(&p, operate_view(&c->session), &t);
    reply_print(c, line);
    reply_ok(c);
}

void command_set(struct client *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    reply_answer(c, operate_set(&c->session, word[0], word[1], &a), &a);
}

/* The transaction changes the parameter, or would change it when the lines are pasted because its default follows one that changes. */
static bool staged_line(const struct client *c, const struct parameter *p)
{
    const float *source = parameter_follows(p, operate_view(&c->session));
    return operate_changes(&c->session, p) ||
           (source && *source != *parameter_follows(p, operate_settings(&c->session)));
}

static bool diff_line(struct client *c, unsigned n, struct text *line)
{
    struct parameter p;
    const struct config *config = operate_view(&c->session);
    if (!parameter_of(config, n, &p))
        return false;
    bool unchanged;
    if (c->argument[0] == 's') { /* staged against the plan */
        unchanged = !staged_line(c, &p);
    } else if (p.field->type >= PARAMETER_KIND) { /* longer texts */
        unchanged = parameter_is_default(&p, config);
    } else {
        char a[40], b[40];
        struct text ta = text_on(a, sizeof a), tb = text_on(b, sizeof b);
        parameter_value(&p, config, &ta);
        parameter_default(&p, config, &tb);
        unchanged = strcmp(a, b) == 0;
    }
    if (unchanged)
        return true;
    parameter_set_line(&p, config, line);
    return true;
}

void command_diff(struct client *c, unsigned n, char **word)
{
    if (CONFIG_PEOPLE && n && strcmp(word[0], "saved") == 0) {
        diff_saved(c);
        return;
    }
    if (n && strcmp(word[0], "defaults") != 0) {
        reply_usage(c, word[0], "diff");
        return;
    }
    /* In a transaction: what it changes. Else: what differs from the defaults. As commands to paste. */
    reply_list(c, diff_line, operate_is_open(&c->session) && !n ? "staged" : "defaults");
}

void command_begin(struct client *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    (void)word;
    reply_answer(c, operate_begin(&c->session, &a), &a);
}

/* Prints what blocks have switched off while the transaction was open. */
static void print_switched_off(struct client *c)
{
    char line[CONSOLE_OUTPUT_MAX];
    struct text t = text_on(line, sizeof line);
    if (switched_off_words(&c->session, &t))
        reply_print(c, line);
}

void command_apply(struct client *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    (void)word;
    enum err err = operate_apply(&c->session, &a);
    if (!err)
        print_switched_off(c);
    reply_answer(c, err, &a);
}

void command_abandon(struct client *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    (void)word;
    reply_answer(c, operate_abandon(&c->session, &a), &a);
}
