#include "console/diff_saved.h"

#include "console/parameter_words.h"

/* Of each parameter that differs two lines: the present value as `set` line, the stored one as a remark. */
static bool diff_saved_line(struct client *c, unsigned n, struct text *line)
{
    char value[BLOCK_NAMES_SIZE];
    struct text stored = text_on(value, sizeof value);
    struct parameter p;
    const struct config *config = operate_view(&c->session);
    if (!parameter_of(config, n / 2u, &p))
        return false;
    if (!operate_differs(&c->session, &p, &stored))
        return true;
    if (n % 2u == 0) {
        parameter_set_line(&p, config, line);
        return true;
    }
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
