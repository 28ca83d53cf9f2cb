/* Console commands on the two levels: unlock, lock, key. */
#include "console/console.h"

void console_access_text(const struct console *c, struct text *line)
{
    if (!operate_has_key(&c->session)) {
        text_str(line, "engineer level open: no key is set (`key NEW` sets one)");
    } else if (!operate_is_engineer(&c->session)) {
        text_str(line, "engineer level locked (`unlock KEY` opens it)");
    } else {
        uint32_t left_s;
        text_str(line, "engineer level unlocked");
        if (operate_closes_in_s(&c->session, &left_s)) {
            text_str(line, ", locks itself in s ");
            text_u32(line, left_s);
        }
    }
}

void command_unlock(struct console *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    console_answer(c, operate_unlock(&c->session, word[0], &a), &a);
}

void command_lock(struct console *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    (void)word;
    console_answer(c, operate_lock(&c->session, &a), &a);
}

void command_key(struct console *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    console_answer(c, operate_key(&c->session, word[0], &a), &a);
}
