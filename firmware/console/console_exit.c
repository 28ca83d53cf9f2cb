/* Console command `exit`, also as `quit`. A serial line has no session to end. */
#include "console/command_table.h"

void command_exit(struct client *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    (void)word;
    bool locks = operate_has_key(&c->session) && operate_is_engineer(&c->session);
    enum err err = locks ? operate_lock(&c->session, &a) : ERR_OK;
    if (err) {
        reply_answer(c, err, &a);
        return;
    }
    reply_print(c, locks ? "Engineer level locked." : "Nothing to close.");
    reply_print(c, "To leave the terminal program: tools/console ^], picocom ^A ^X");
    reply_ok(c);
}
