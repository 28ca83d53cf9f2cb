/* The engineer level as a line of text. */
#ifndef REFLUX_CONSOLE_ACCESS_WORDS_H
#define REFLUX_CONSOLE_ACCESS_WORDS_H

#include "operate/operate.h"

/* "engineer level locked (`unlock KEY` opens it)" */
void access_words(const struct session *session, struct text *line);

#endif
