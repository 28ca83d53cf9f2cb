/* Words with bars between them, "off|on": the values of a parameter that is a choice. */
#ifndef REFLUX_SETTINGS_WORDS_H
#define REFLUX_SETTINGS_WORDS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/text.h"

unsigned words_count(const char *words);
/* Writes the word at that place; nothing past the end. */
void words_put(const char *words, unsigned place, struct text *t);
/* Finds the place of a whole word. Returns false where it is none of them. */
bool words_find(const char *words, const char *word, uint8_t *place);

#endif
