/* Console command `block`. */
#include <string.h>

#include "base/assertion.h"
#include "console/command_table.h"
#include "console/phrases.h"

static void put_names(const char *title, const char *names, struct text *line)
{
    if (!names[0])
        return;
    text_str(line, title);
    block_list_put(names, line);
}

static void block_summary(const struct client *c, uint8_t block, struct text *line)
{
    static const char *const works[] = {"", "  job running", "  job late"};
    const struct block_config *b = &client_settings(c)->block[block];
    struct block_reading r;
    if (!operate_block(&c->session, block, &r))
        return;
    REFLUX_ASSERT((unsigned)r.work < sizeof works / sizeof works[0]);
    put_block(line, block);
    put_word(line, r.name);
    text_str(line, !r.kind ? " unknown" : r.gave_up ? " off: " : " on");
    if (r.gave_up)
        text_str(line, r.gave_up);
    put_names("  loops ", b->loops, line);
    put_names("  inputs ", b->inputs, line);
    put_names("  points ", b->points, line);
    text_str(line, works[r.work]);
    text_str(line, r.excites ? "  excites the plant" : "");
}

static void verb_line(const struct block_verb *verb, struct text *line)
{
    text_str(line, "  verb ");
    text_str(line, verb->name);
    if (verb->number) {
        text_str(line, verb->may_lack_number ? " [" : " ");
        text_float(line, verb->lo);
        text_str(line, "..");
        put_amount(line, verb->hi, verb->number);
        if (verb->may_lack_number)
            text_char(line, ']');
    }
    put_reason(line, verb->help);
    if (verb->access == ACCESS_ENGINEER)
        text_str(line, " (engineer)");
}

static void block_event_line(const struct block_reading *r, unsigned k, struct text *line)
{
    const struct block_event *event = &r->kind->event[k];
    text_str(line, event->level == BLOCK_ALARM ? "  alarm " : "  event ");
    text_str(line, event->code);
    put_reason(line, event->words);
    if (r->raised & (1u << k))
        text_str(line, ", now");
}

/* Summary, inner values, verbs, events. */
static bool block_line_n(const struct client *c, uint8_t block, unsigned n, struct text *line)
{
    struct block_reading r;
    float value;
    unsigned values = 0;
    if (!operate_block(&c->session, block, &r))
        return false;
    if (n == 0) {
        block_summary(c, block, line);
        return true;
    }
    const char *name = operate_block_value(&c->session, block, n - 1u, &value);
    if (name) {
        text_str(line, "  ");
        text_str(line, name);
        text_str(line, " = ");
        reply_value(c, line, value);
        return true;
    }
    while (operate_block_value(&c->session, block, values, &value))
        values++;
    n -= 1u + values;
    if (!r.kind || n >= r.kind->verbs + (unsigned)r.kind->events)
        return false;
    if (n < r.kind->verbs)
        verb_line(&r.kind->verb[n], line);
    else
        block_event_line(&r, n - r.kind->verbs, line);
    return true;
}

static bool blocks_line(struct client *c, unsigned n, struct text *line)
{
    struct answer a;
    uint8_t block;
    if (!c->argument[0]) { /* all of them, a line each */
        if (n >= CONFIG_BLOCKS)
            return false;
        block_summary(c, (uint8_t)n, line);
        return true;
    }
    return operate_find_block(&c->session, c->argument, &block, &a) == ERR_OK &&
           block_line_n(c, block, n, line);
}

static void ask_block(struct client *c, uint8_t block, unsigned n, char **word)
{
    struct answer a;
    uint8_t verb;
    float number;
    bool on = strcmp(word[0], "on") == 0;
    if (on || strcmp(word[0], "off") == 0) {
        if (n > 1)
            reply_err_about(c, ERR_PARSE, word[1], "expected: block BLOCK on|off");
        else
            reply_answer(c, operate_block_switch(&c->session, block, on, &a), &a);
        return;
    }
    enum err err = operate_find_verb(&c->session, block, word[0], &verb, &a);
    if (err)
        reply_answer(c, err, &a);
    else if (n == 1 || reply_number(c, word[1], "what the verb takes", &number))
        reply_answer(c, operate_verb(&c->session, block, verb, n == 1 ? NULL : &number, &a), &a);
}

void command_block(struct client *c, unsigned n, char **word)
{
    struct answer a;
    uint8_t block;
    enum err err = n ? operate_find_block(&c->session, word[0], &block, &a) : ERR_OK;
    if (err)
        reply_answer(c, err, &a);
    else if (n > 1)
        ask_block(c, block, n - 1u, word + 1);
    else
        reply_list(c, blocks_line, n ? word[0] : "");
}
