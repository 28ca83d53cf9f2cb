/* Parameters that only blocks have: a kind, lists of names, rows of tables. What parameters.c does with all others is done here with
 * these; a board without blocks has none. */
#ifndef REFLUX_SETTINGS_BLOCK_TEXTS_H
#define REFLUX_SETTINGS_BLOCK_TEXTS_H

#include "settings/parameter_table.h"

#if CONFIG_BLOCKS
/* Bytes of the value; 0 of a row without its kind. */
size_t block_text_size(const struct parameter *p);
/* The value; what it is by default; what is allowed. False, and nothing put: the parameter is none of these. */
bool block_text_put(const struct parameter *p, const uint8_t *value, struct text *t);
bool block_text_put_initial(const struct parameter *p, struct text *t);
bool block_text_range(const struct parameter *p, struct text *t);
/* The value is the default one; of names, kinds and units: it is empty. */
bool block_text_is_initial(const struct parameter *p, const uint8_t *value);
/* Sets it, at the place where it stands, which a row of a table may need to have asked for (parameter_to_write); errors of
 * parameter_set(). */
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
