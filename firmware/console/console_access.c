/* Console commands on the two levels: unlock, lock, key. */
#include "console/command_table.h"

void command_unlock(struct client *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    reply_answer(c, operate_unlock(&c->session, word[0], &a), &a);
}

void command_lock(struct client *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    (void)word;
    reply_answer(c, operate_lock(&c->session, &a), &a);
}

void command_key(struct client *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    reply_answer(c, operate_key(&c->session, word[0], &a), &a);
}
