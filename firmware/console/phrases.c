/* Pieces that many lines of text are made of. */
#include "console/phrases.h"

const char *const mode_names[MODE_NAMES] = {"manual", "auto", "cascade"};

void put_word(struct text *t, const char *word)
{
    text_char(t, ' ');
    text_str(t, word);
}

void put_reason(struct text *t, const char *reason)
{
    text_str(t, ": ");
    text_str(t, reason);
}

void put_amount(struct text *t, float x, const char *unit)
{
    text_float(t, x);
    put_word(t, unit);
}

void put_block(struct text *t, unsigned block)
{
    text_str(t, "block");
    text_u32(t, block + 1u);
}
