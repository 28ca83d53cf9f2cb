/* The console command on blocks with a record: block. */
#include <string.h>

#include "console/console.h"

static void list_of(const char *title, const char *names, struct text *line)
{
    if (!names[0])
        return;
    text_str(line, title);
    block_list_put(names, line);
}

static void block_summary(const struct console *c, uint8_t block, struct text *line)
{
    static const char *const works[] = {"", "  works between ticks", "  its work is late"};
    const struct block_config *b = &console_settings(c)->block[block];
    struct block_reading r;
    if (!operate_block(&c->session, block, &r))
        return;
    text_str(line, "block");
    text_u32(line, block + 1u);
    text_char(line, ' ');
    text_str(line, r.name);
    text_str(line, !r.kind ? " unknown" : r.gave_up ? " off: " : " on");
    if (r.gave_up)
        text_str(line, r.gave_up);
    list_of("  loops ", b->loops, line);
    list_of("  inputs ", b->inputs, line);
    list_of("  points ", b->points, line);
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
        text_float(line, verb->hi);
        text_char(line, ' ');
        text_str(line, verb->number);
        if (verb->may_lack_number)
            text_char(line, ']');
    }
    text_str(line, ": ");
    text_str(line, verb->help);
    if (verb->access == ACCESS_ENGINEER)
        text_str(line, " (engineer)");
}

void block_event_words(const struct event *e, struct text *line)
{
    const struct block_kind *kind = e->detail < block_kind_count ? block_kinds[e->detail] : NULL;
    const char *code = strchr(e->subject, '.');
    for (unsigned k = 0; kind && code && k < kind->events; k++) {
        if (strcmp(code + 1, kind->event[k].code) == 0) {
            text_str(line, ": ");
            text_str(line, kind->event[k].words);
        }
    }
}

void block_alarm_line(const struct console *c, uint8_t block, unsigned what, struct text *line)
{
    struct block_reading r;
    if (!operate_block(&c->session, block, &r) || !r.kind)
        return;
    if (what == 0 && r.gave_up && strcmp(r.gave_up, "asked") != 0) {
        text_str(line, "BLOCK_GAVE_UP block");
        text_u32(line, block + 1u);
        text_char(line, ' ');
        text_str(line, r.gave_up);
    }
    if (what == 0 || what > r.kind->events)
        return;
    const struct block_event *event = &r.kind->event[what - 1u];
    const struct plan *plan = service_in_force(c->service);
    for (unsigned i = 0; i < CONFIG_ALARMS; i++)
        if (plan->alarm[i] == ALARM_OF_EVENT(block, what - 1u))
            return; /* that entry tells, or is shelved */
    if (event->level != BLOCK_ALARM || !(r.raised & (1u << (what - 1u))))
        return;
    char name[CHANNEL_NAME_SIZE];
    block_word_name(block, event->code, name);
    text_str(line, "BLOCK_ALARM ");
    text_str(line, name);
    text_char(line, ' ');
    text_str(line, event->words);
}

static void line_of_event(const struct block_reading *r, unsigned k, struct text *line)
{
    const struct block_event *event = &r->kind->event[k];
    text_str(line, event->level == BLOCK_ALARM ? "  alarm " : "  event ");
    text_str(line, event->code);
    text_str(line, ": ");
    text_str(line, event->words);
    if (r->raised & (1u << k))
        text_str(line, ", now");
}

/* Summary, inner values, verbs, events. */
static bool lines_of_block(const struct console *c, uint8_t block, unsigned n, struct text *line)
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
        text_float(line, value);
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
        line_of_event(&r, n - r.kind->verbs, line);
    return true;
}

void block_verbs_words(const struct block_kind *kind, struct text *t)
{
    text_str(t, kind->verbs ? "its kind has no such verb, but:" : "its kind has no verbs");
    for (unsigned v = 0; v < kind->verbs; v++) {
        text_char(t, ' ');
        text_str(t, kind->verb[v].name);
    }
    if (kind->stage != STAGE_ESTIMATE) /* nothing could stand in for an estimator */
        text_str(t, "; `block N on|off` switches it");
}

static bool blocks_line(struct console *c, unsigned n, struct text *line)
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
           lines_of_block(c, block, n, line);
}

static void tell_block(struct console *c, uint8_t block, unsigned n, char **word)
{
    struct answer a;
    uint8_t verb;
    float number;
    bool on = strcmp(word[0], "on") == 0;
    if (on || strcmp(word[0], "off") == 0) {
        if (n > 1)
            console_err_about(c, ERR_PARSE, word[1], "wanted: block BLOCK on|off");
        else
            console_answer(c, operate_block_switch(&c->session, block, on, &a), &a);
        return;
    }
    enum err err = operate_find_verb(&c->session, block, word[0], &verb, &a);
    if (err)
        console_answer(c, err, &a);
    else if (n == 1 || console_number(c, word[1], "what the verb takes", &number))
        console_answer(c, operate_verb(&c->session, block, verb, n == 1 ? NULL : &number, &a), &a);
}

void command_block(struct console *c, unsigned n, char **word)
{
    struct answer a;
    uint8_t block;
    enum err err = n ? operate_find_block(&c->session, word[0], &block, &a) : ERR_OK;
    if (err)
        console_answer(c, err, &a);
    else if (n > 1)
        tell_block(c, block, n - 1u, word + 1);
    else
        console_list(c, blocks_line, n ? word[0] : "");
}
