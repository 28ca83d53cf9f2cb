/* Reasons of refusals in words: the text behind `err CODE`. */
#ifndef REFLUX_CONSOLE_REFUSAL_WORDS_H
#define REFLUX_CONSOLE_REFUSAL_WORDS_H

#include "operate/operate.h"

/* The text of a configuration's fault behind its parameter: "'T10' must be 0 .. 1". */
void config_fault_words(const struct config_fault *fault, struct text *t);
void refusal_words(enum err code, const struct answer *answer, struct text *t);

#endif
