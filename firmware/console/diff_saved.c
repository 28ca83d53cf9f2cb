#include "console/diff_saved.h"

#include "console/parameter_words.h"

/* Prints two lines of a parameter that differs: the present value as a `set` line, the stored one as a remark. Both come at once, because a
 * second call would search the stored set again. */
static bool diff_saved_line(struct client *c, unsigned n, struct text *line)
{
    char value[BLOCK_NAMES_SIZE];
    struct text stored = text_on(value, sizeof value);
    struct parameter p;
    const struct config *config = operate_view(&c->session);
    if (!parameter_of(config, n, &p))
        return false;
    if (!operate_differs(&c->session, &p, &stored))
        return true;
    parameter_set_line(&p, config, line);
    reply_print(c, line->start);
    *line = text_on(line->start, line->size);
    text_str(line, "# saved: ");
    text_str(line, value);
    return true;
}

void diff_saved(struct client *c)
{
    struct answer a;
    enum err err = operate_may_compare(&c->session, &a);
    if (err)
        reply_answer(c, err, &a);
    else
        reply_list(c, diff_saved_line, "");
}
