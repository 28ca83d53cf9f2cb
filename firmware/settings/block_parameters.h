/* Parameters of blocks: what is fixed (kind, and the names of loops, inputs and points) and what the rows of the kind
 * declare. Their values are texts of several names, rows of tables, and a kind, which no other parameter is; single
 * numbers and words are handled as everywhere (parameters.c).
 */
#ifndef REFLUX_SETTINGS_BLOCK_PARAMETERS_H
#define REFLUX_SETTINGS_BLOCK_PARAMETERS_H

#include "base/text.h"
#include "exchange/block_settings.h"

enum block_field { BLOCK_FIELD_KIND, BLOCK_FIELD_LOOPS, BLOCK_FIELD_INPUTS, BLOCK_FIELD_POINTS };
#define BLOCK_FIELDS 4u

/* One of a block: a fixed one where `own` is NULL. */
struct block_parameter_place {
    uint8_t block, field; /* enum block_field */
    uint16_t row;         /* of a table */
    const struct block_parameter *own;
};

/* The n-th of all parameters of all blocks; false past the end. A block that is not used, has kind only. */
bool block_parameter_at(const struct config *config, unsigned n, struct block_parameter_place *p);
/* A row of its kind, "lambda" or, with its row, "table.3"; false: there is none. */
bool block_parameter_find(const struct config *config, uint8_t block, const char *name,
                          struct block_parameter_place *p);
/* The same by its id in the kind and its row. */
bool block_parameter_find_id(const struct config *config, uint8_t block, uint8_t id, uint16_t row,
                             struct block_parameter_place *p);
/* Where it is. The block must have the kind that *own is of. */
const uint8_t *block_parameter_where(const struct config *config, uint8_t block, uint16_t row,
                                     const struct block_parameter *own);
static inline bool block_parameter_is_table(const struct block_parameter *own)
{
    return block_value_count(own) > 1;
}
static inline size_t block_row_size(const struct block_parameter *own)
{
    return own->cols * block_value_size(own->type);
}

/* It has a kind, but no record: this build lacks the kind, or there was no room. */
bool block_is_unknown(const struct config *config, uint8_t block);

/* "gmv|observer|-": the kinds it may be. */
void block_kinds_put(struct text *t);

/* A list of names, as it is kept: blanks between them; shown, and set, with commas. "-": none. */
void block_list_put(const char *list, struct text *t);
/* Also with blanks. ERR_PARSE, ERR_RANGE: *list, `size` bytes, is unchanged. */
MUST_CHECK enum err block_list_set(char *list, size_t size, const char *value);
/* Whether a name stands in the list more than once. */
bool block_list_repeats(const char *list);

/* A row of a table, commas between the values. */
void block_row_put(const struct block_parameter *own, const uint8_t *at, struct text *t);
void block_row_put_initial(const struct block_parameter *own, struct text *t);
/* At least `least` values; those behind them stay as they are. ERR_PARSE, ERR_RANGE: nothing has changed. Blanks serve as well. */
MUST_CHECK enum err block_row_set(const struct block_parameter *own, uint8_t *at, const char *value,
                                  unsigned least);
/* All its values are the initial one. */
bool block_row_is_initial(const struct block_parameter *own, const uint8_t *at);
/* As stored, little-endian; returns how many bytes. */
size_t block_row_encode(const struct block_parameter *own, const uint8_t *at, uint8_t *stored);
/* False: a value had to be changed to the nearest one allowed; *taken false: they are no numbers, nothing has changed. */
bool block_row_decode(const struct block_parameter *own, uint8_t *at, const uint8_t *stored,
                      bool *taken);

#endif
