/* Console commands on stored settings: save, load, defaults, dump. */
#include <string.h>

#include "console/command_table.h"
#include "console/parameter_words.h"
#include "hal/self_check.h"
#include "storage/storage_record.h"

/* Answers a refusal at once; the console answers what has begun when it is over. */
static void answer_refusal(struct client *c, enum err err, const struct answer *a)
{
    if (err)
        reply_answer(c, err, a);
}

static unsigned save_word(const char *word)
{
    if (strcmp(word, "replace") == 0)
        return SAVE_REPLACE;
    return BOARD_CHECKS && strcmp(word, "unsafe") == 0 ? SAVE_UNSAFE : 0;
}

void command_save(struct client *c, unsigned n, char **word)
{
    struct answer a;
    unsigned how = 0;
    enum err err = operate_admit(&c->session, "save", &a);
    for (unsigned i = 0; !err && i < n; i++) {
        unsigned word_means = save_word(word[i]);
        if (!word_means) {
            reply_usage(c, word[i], "save");
            return;
        }
        how |= word_means;
    }
    answer_refusal(c, err ? err : operate_save(&c->session, how, &a), &a);
}

void command_load(struct client *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    (void)word;
    answer_refusal(c, operate_load(&c->session, &a), &a);
}

void command_defaults(struct client *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    (void)word;
    reply_answer(c, operate_defaults(&c->session, &a), &a);
}

static bool dump_line(struct client *c, unsigned n, struct text *line)
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
        parameter_set_line(&p, config, line);
        return true;
    }
    if (!parameter_of(config, n - 1, &p))
        return false;
    text_str(line, "apply");
    return true;
}

void command_dump(struct client *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    reply_list(c, dump_line, "");
}
