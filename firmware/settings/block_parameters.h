/* Parameters of blocks: the fixed ones (kind, and the names of loops, inputs and points) and those that the rows of the
 * kind declare. Their values are a kind, lists of names, and rows of tables, which no other parameter has. parameters.c
 * handles single numbers and words, as everywhere.
 */
#ifndef REFLUX_SETTINGS_BLOCK_PARAMETERS_H
#define REFLUX_SETTINGS_BLOCK_PARAMETERS_H

#include "base/text.h"
#include "exchange/block_settings.h"

enum block_field { BLOCK_FIELD_KIND, BLOCK_FIELD_LOOPS, BLOCK_FIELD_INPUTS, BLOCK_FIELD_POINTS };
#define BLOCK_FIELDS 4u

/* Place of a parameter of a block; a fixed one where `own` is NULL. */
struct block_parameter_place {
    uint8_t block, field; /* field: enum block_field */
    uint16_t row;         /* row of a table */
    const struct block_parameter *own;
};

/* Gets the n-th of all parameters of all blocks. Returns false past the end. A block that is not used has `kind` only. */
bool block_parameter_at(const struct config *config, unsigned n, struct block_parameter_place *p);
/* Finds a parameter of the block's kind by name: "lambda", or "table.3" with its row. Returns false where there is none. */
bool block_parameter_find(const struct config *config, uint8_t block, const char *name,
                          struct block_parameter_place *p);
/* Finds the same by its id in the kind and its row. */
bool block_parameter_find_id(const struct config *config, uint8_t block, uint8_t id, uint16_t row,
                             struct block_parameter_place *p);
/* Returns the address of the value. *own must be a row of the kind that the block has. */
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

/* Returns whether the block has a kind but no record: this build lacks the kind, or there was no room. */
bool block_is_unknown(const struct config *config, uint8_t block);

/* Writes the kinds that a block can have: "gmv|observer|-". */
void block_kinds_put(struct text *t);

/* Writes a list of names with commas between them; "-" for none. The configuration keeps it with blanks between them. */
void block_list_put(const char *list, struct text *t);
/* Sets a list of `size` bytes from names with commas or blanks between them; "-" for none. ERR_PARSE, ERR_RANGE: *list is
 * unchanged. */
MUST_CHECK enum err block_list_set(char *list, size_t size, const char *value);
/* Returns whether the list has a name more than once. */
bool block_list_repeats(const char *list);

/* Write a row of a table, and its initial values, with commas between the values. */
void block_row_put(const struct block_parameter *own, const uint8_t *at, struct text *t);
void block_row_put_initial(const struct block_parameter *own, struct text *t);
/* Sets at least the first `least` values of a row, from a text with commas or blanks between them. The values after them stay as they
 * are. ERR_PARSE, ERR_RANGE: nothing has changed. */
MUST_CHECK enum err block_row_set(const struct block_parameter *own, uint8_t *at, const char *value,
                                  unsigned least);
/* Returns whether all values of the row are the initial one. */
bool block_row_is_initial(const struct block_parameter *own, const uint8_t *at);
/* Writes a row as stored, little-endian. Returns the number of bytes. */
size_t block_row_encode(const struct block_parameter *own, const uint8_t *at, uint8_t *stored);
/* Reads a stored row. Returns false where it took the nearest allowed value of one, or none. *taken false: a value is no number, and
 * nothing has changed. */
bool block_row_decode(const struct block_parameter *own, uint8_t *at, const uint8_t *stored,
                      bool *taken);

#endif
