/* Completion. The row of each command says which words may follow: capital words of its arguments stand for names of a kind, the
 * others for themselves. */
#include "console/completion.h"

#include <string.h>

#include "console/block_words.h"
#include "console/command_table.h"
#include "exchange/alarm_names.h"
#include "settings/parameters.h"
#include "supervise/alarms.h"

#define WORD_SIZE          32
#define PARAMETER_NAME_MAX 39u /* characters: longer than any */

struct typed {
    unsigned position; /* of the word under way; 0 is the command */
    char command[WORD_SIZE], before[WORD_SIZE];
    const char *word; /* under way */
};

static void copy(char *to, const char *from, size_t n)
{
    if (n >= WORD_SIZE)
        n = WORD_SIZE - 1;
    memcpy(to, from, n);
    to[n] = '\0';
}

static struct typed look_at_line(const char *line)
{
    struct typed t = {.word = line};
    while (*line) {
        while (*line == ' ')
            line++;
        t.word = line;
        while (*line && *line != ' ')
            line++;
        if (!*line)
            break;
        copy(t.position ? t.before : t.command, t.word, (size_t)(line - t.word));
        t.word = line;
        t.position++;
    }
    while (*t.word == ' ')
        t.word++;
    return t;
}

static bool is(const char *kind, size_t n, const char *name)
{
    return strlen(name) == n && memcmp(kind, name, n) == 0;
}

/* Writes parameter p under the name typed before the dot: "bottom.gain" for "loop2.gain". Returns false where p is of nothing with that
 * name. */
static bool named_choice(const struct config *config, const struct parameter *p, const char *typed,
                         struct text *word)
{
    char group[PARAMETER_NAME_MAX + 1u], name[PARAMETER_NAME_MAX + 1u];
    for (unsigned k = 0; k < PARAMETER_OWNERS; k++) {
        struct text numbered = text_on(group, sizeof group), full = text_on(name, sizeof name);
        if (!parameter_numbered_name(config, typed, k, &numbered))
            continue;
        size_t n = strcspn(group, ".") + 1u;
        parameter_name(p, &full);
        if (strncmp(group, name, n) != 0)
            continue;
        for (const char *c = typed; *c != '.'; c++)
            text_char(word, *c);
        text_str(word, name + n - 1u);
        return true;
    }
    return false;
}

/* Without a dot so far: "loop1." for all its fields. */
static void parameter_choice(const struct config *config, unsigned n, const char *typed,
                             struct text *word)
{
    struct parameter p;
    if (!parameter_of(config, n, &p))
        return;
    if (strchr(typed, '.')) {
        if (is_further_row(&p)) /* the first stands for all of a table */
            return;
        if (!CONFIG_PEOPLE || !named_choice(config, &p, typed, word))
            parameter_name(&p, word);
        return;
    }
    if (p.field != p.group->fields)
        return;
    text_str(word, p.group->name);
    if (p.group->indexed)
        text_u32(word, p.index + 1u);
    text_char(word, '.');
}

/* Words between bars; true when there is an n-th one. */
static bool word_choice(const char *words, size_t size, unsigned n, struct text *word)
{
    for (size_t i = 0; i < size; i++) {
        if (words[i] == '|') {
            if (n == 0)
                return true;
            n--;
        } else if (n == 0) {
            text_char(word, words[i]);
        }
    }
    return n == 0;
}

enum names { NAMES_LOOP = 1, NAMES_MV = 2, NAMES_MEASUREMENT = 4 };

static unsigned name_choice(const struct config *config, unsigned kinds, unsigned n,
                            struct text *word)
{
    if (n < CONFIG_LOOPS && (kinds & NAMES_LOOP) != 0)
        text_str(word, config->loop[n].name);
    if (n >= CONFIG_LOOPS && n - CONFIG_LOOPS < CHANNEL_MAX && (kinds & NAMES_MV) != 0)
        text_str(word, config->mv[n - CONFIG_LOOPS].name);
    n -= CONFIG_LOOPS + CHANNEL_MAX;
    if (n < CHANNEL_MAX && (kinds & NAMES_MEASUREMENT) != 0)
        text_str(word, config->measurement[n].name);
    return CONFIG_LOOPS + 2u * CHANNEL_MAX;
}

/* "bottom." for all fields of what has that name. */
static unsigned owner_choice(const struct config *names, unsigned n, struct text *word)
{
    unsigned all = name_choice(names, NAMES_LOOP | NAMES_MV | NAMES_MEASUREMENT, n, word);
    if (word->n > 0)
        text_char(word, '.');
    return all;
}

/* Puts the n-th choice of a kind into *word; returns how many there are. */
static unsigned kind_choice(const struct client *c, const char *kind, size_t size,
                            const struct typed *t, unsigned n, struct text *word)
{
    const struct config *config = operate_settings(&c->session);
    const struct config *view = operate_view(&c->session);
    const struct config *names =
        CONFIG_PEOPLE ? view : config; /* also those of an open transaction */
    struct parameter p;
    if (is(kind, size, "LOOP"))
        return name_choice(config, NAMES_LOOP, n, word);
    if (is(kind, size, "MV"))
        return name_choice(config, NAMES_MV, n, word);
    if (is(kind, size, "NAME"))
        return name_choice(names, NAMES_LOOP | NAMES_MV | NAMES_MEASUREMENT, n, word);
    if (is(kind, size, "ALARM")) {
        char name[CHANNEL_NAME_SIZE] = "";
        if (n < CONFIG_ALARMS && config->alarm[n].on[0])
            alarm_name(config, (uint8_t)n, name);
        text_str(word, name);
        return CONFIG_ALARMS;
    }
    if (is(kind, size, "BLOCK") || is(kind, size, "VERB"))
        return block_choice(&c->session, kind, size, t->before, n, word);
    if (is(kind, size, "COMMAND")) {
        if (n < console_command_count)
            text_str(word, console_commands[n].name);
        return console_command_count;
    }
    if (is(kind, size, "PARAMETER") || is(kind, size, "PREFIX")) {
        unsigned parameters = parameter_count(view);
        if (CONFIG_PEOPLE && n >= parameters && is(kind, size, "PARAMETER") &&
            !strchr(t->word, '.'))
            return parameters + owner_choice(names, n - parameters, word);
        parameter_choice(view, n, t->word, word);
        return parameters;
    }
    if (is(kind, size, "VALUE") && parameter_find_in(view, t->before, &p) == ERR_OK) {
        if ((p.field->type == PARAMETER_NAME && !parameter_is_secret(&p)) ||
            p.field->type == PARAMETER_LIST)
            return name_choice(names, NAMES_LOOP | NAMES_MV | NAMES_MEASUREMENT, n, word);
        if (p.field->type != PARAMETER_WORD)
            return block_kind_choice(&p, n, word);
        const char *words = parameter_word_list(&p);
        return word_choice(words, strlen(words), n, word) ? n + 1u : n;
    }
    if (kind[0] < 'a' || kind[0] > 'z')
        return 0;
    if (n == 0)
        (void)word_choice(kind, size, 0, word);
    return 1;
}

unsigned console_word(const struct client *c, const char *kind, size_t size, unsigned n,
                      struct text *word)
{
    struct typed nothing = {.word = ""};
    return kind_choice(c, kind, size, &nothing, n, word);
}

/* The token of the arguments that belongs to the word under way, without its brackets. */
static const char *argument_at(const char *arguments, unsigned position, size_t *size)
{
    for (;; position--) {
        const char *end = strchr(arguments, ' ');
        *size = end ? (size_t)(end - arguments) : strlen(arguments);
        if (position == 1 || !end)
            break;
        arguments = end + 1;
    }
    if (position > 1)
        *size = 0;
    if (*size >= 2 && arguments[0] == '[') {
        arguments++;
        *size -= 2;
    }
    return arguments;
}

bool console_choice(void *client, const char *line, unsigned n, struct text *word)
{
    const struct client *c = client;
    struct typed t = look_at_line(line);
    if (t.position == 0)
        return kind_choice(c, "COMMAND", 7, &t, n, word) > n;
    const struct console_command *command = find_command(t.command);
    if (!command)
        return false;
    size_t size;
    const char *kinds = argument_at(command->arguments, t.position, &size);
    /* "LOOP|MV": the choices of one kind after those of the other. */
    while (size) {
        size_t width = 0;
        while (width < size && kinds[width] != '|')
            width++;
        unsigned choices = kind_choice(c, kinds, width, &t, n, word);
        if (n < choices)
            return true;
        n -= choices;
        width += width < size; /* past the bar */
        kinds += width;
        size -= width;
    }
    return false;
}
