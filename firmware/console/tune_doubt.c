#include "console/tune_doubt.h"

#include "console/refusal_words.h"

void print_tune_doubt(struct client *c, uint8_t loop, const struct tuning *tuning)
{
    char line[CONSOLE_OUTPUT_MAX];
    struct text t = text_on(line, sizeof line);
    struct answer a;
    enum err err = operate_check_tuning(&c->session, loop, tuning, &a);
    if (!err)
        return;
    text_str(&t, "# `set` would refuse this: ");
    refusal_words(err, &a, &t);
    reply_print(c, line);
}
