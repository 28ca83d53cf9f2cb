/* The row of a command says which words it takes (commands.h), and so which may have been meant. */
#include "console/suggestion.h"

#include <string.h>

#include "console/completion.h"
#include "console/spelling.h"

#define WORD_MAX 39u /* characters: longer than any name */

struct search {
    const char *typed;
    unsigned edits; /* of the best so far */
    char best[WORD_MAX + 1u];
};

/* Takes a known word where it is nearer than the best so far. */
static void weigh_word(struct search *s, const char *known)
{
    unsigned edits = known[0] ? spelling_edits(s->typed, known) : s->edits;
    if (edits >= s->edits || strcmp(s->typed, known) == 0)
        return;
    s->edits = edits;
    memcpy(s->best, known, strlen(known) + 1u);
}

/* Returns the number in the name of a group, 2 of "loop2.gain"; 0 without one. */
static unsigned number_in(const char *name)
{
    unsigned number = 0;
    for (; *name && *name != '.' && number < 1000u; name++)
        if (*name >= '0' && *name <= '9')
            number = number * 10u + (unsigned)(*name - '0');
    return number;
}

/* Weighs a parameter under the name of the loop or channel that it belongs to: "bottom.gain" for "loop2.gain". */
static void weigh_owned(struct search *s, const struct config *config, const struct parameter *p,
                        const char *field)
{
    char name[WORD_MAX + 1u];
    struct text t = text_on(name, sizeof name);
    struct parameter owner = {.group = p->group, .field = p->group->fields, .index = p->index};
    if (strcmp(owner.field->name, "name") != 0)
        return;
    parameter_value(&owner, config, &t);
    size_t letters = t.n;
    text_str(&t, field);
    /* Used, and not all of the name mistyped. */
    if (name[0] != '-' && spelling_edits(s->typed, name) < letters)
        weigh_word(s, name);
}

/* Weighs parameters by both of their names. Of those with a number only the ones that have the number typed, because another number
 * is another thing and no slip. */
static void weigh_parameters(struct search *s, const struct config *config)
{
    char name[WORD_MAX + 1u];
    struct parameter p;
    unsigned number = number_in(s->typed);
    for (unsigned n = 0; strchr(s->typed, '.') && parameter_of(config, n, &p); n++) {
        struct text t = text_on(name, sizeof name);
        parameter_name(&p, &t);
        weigh_owned(s, config, &p, strchr(name, '.'));
        if (!number || !p.group->indexed || p.index + 1u == number)
            weigh_word(s, name);
    }
}

/* Weighs the words that a word of the arguments of a command stands for. */
static void weigh_kind(struct search *s, const struct client *c, const char *kind, size_t size)
{
    char buffer[WORD_MAX + 1u];
    unsigned n = 0, choices;
    do {
        struct text word = text_on(buffer, sizeof buffer);
        choices = console_word(c, kind, size, n++, &word);
        weigh_word(s, buffer);
    } while (n < choices);
}

static void weigh_arguments(struct search *s, const struct client *c, const char *arguments)
{
    static const char parameter[] = "PARAMETER", ends[] = " |[]";
    while (*arguments) {
        size_t n = strcspn(arguments, ends);
        if (n == sizeof parameter - 1u && memcmp(arguments, parameter, n) == 0)
            weigh_parameters(s, operate_view(&c->session));
        else if (n)
            weigh_kind(s, c, arguments, n);
        arguments += n;
        arguments += strspn(arguments, ends);
    }
}

static void suggest_word(const struct client *c, const char *typed, bool channel, struct text *line)
{
    /* Fewer than so many edits: in a short word two make another word. */
    struct search s = {.typed = typed, .edits = strlen(typed) > 4 ? 3u : 2u};
    weigh_arguments(&s, c,
                    channel           ? "NAME"
                    : c->hint.command ? c->hint.command->arguments
                                      : "COMMAND");
    if (!s.best[0] || strlen(typed) < 2)
        return;
    text_str(line, "; did you mean `");
    text_str(line, s.best);
    text_str(line, "`?");
}

void suggestion_init(struct client *c)
{
    c->hint.write = suggest_word;
}
