/* Parameters that only blocks have: a kind, lists of names, rows of tables. These functions do for them what parameters.c does for all
 * others. A board without blocks has none. */
#ifndef REFLUX_SETTINGS_BLOCK_TEXTS_H
#define REFLUX_SETTINGS_BLOCK_TEXTS_H

#include "settings/parameter_table.h"

#if CONFIG_BLOCKS
/* Returns the bytes of the value; 0 for a row without its kind. */
size_t block_text_size(const struct parameter *p);
/* Write the value, the default value, and the allowed values. They return false, and write nothing, for other parameters. */
bool block_text_put(const struct parameter *p, const uint8_t *value, struct text *t);
bool block_text_put_initial(const struct parameter *p, struct text *t);
bool block_text_range(const struct parameter *p, struct text *t);
/* Returns whether the value is the default one. Names, kinds and units are empty by default. */
bool block_text_is_initial(const struct parameter *p, const uint8_t *value);
/* Sets the value at its place. For a row, parameter_to_write() must have returned ERR_OK before. Errors as parameter_set(). */
MUST_CHECK enum err block_text_set(const struct parameter *p, struct config *config, void *place,
                                   const char *value);
#else
#define block_text_size(p)                      ((void)(p), (size_t)1)
#define block_text_put(p, value, t)             false
#define block_text_put_initial(p, t)            false
#define block_text_range(p, t)                  false
#define block_text_is_initial(p, value)         (*(value) == 0)
#define block_text_set(p, config, place, value) ((void)(place), ERR_UNSUPPORTED)
#endif

#endif
