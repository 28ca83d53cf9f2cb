/* The engineer level as a line of text. */
#include "console/access_words.h"

void access_words(const struct session *session, struct text *line)
{
    if (!operate_has_key(session)) {
        text_str(line, "engineer level open: no key is set (`key NEW` sets one)");
    } else if (!operate_is_engineer(session)) {
        text_str(line, "engineer level locked (`unlock KEY` opens it)");
    } else {
        uint32_t left_s;
        text_str(line, "engineer level unlocked");
        if (operate_closes_in_s(session, &left_s)) {
            text_str(line, ", locks in ");
            text_u32(line, left_s);
            text_str(line, " s");
        }
    }
}
