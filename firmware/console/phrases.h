/* Pieces that many lines of text are made of. */
#ifndef REFLUX_CONSOLE_PHRASES_H
#define REFLUX_CONSOLE_PHRASES_H

#include "base/text.h"

/* "manual", "auto", "cascade": enum loop_mode in words. */
#define MODE_NAMES 3u
extern const char *const mode_names[MODE_NAMES];

/* " word" */
void put_word(struct text *t, const char *word);
/* ": reason" */
void put_reason(struct text *t, const char *reason);
/* "78.5 degC" */
void put_amount(struct text *t, float x, const char *unit);
/* "block2"; blocks count from 0. */
void put_block(struct text *t, unsigned block);

#endif
