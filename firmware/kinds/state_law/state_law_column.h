/* The law of a column's table, found in pieces, in the workspace. For this folder alone. */
#ifndef REFLUX_STATE_LAW_STATE_LAW_COLUMN_H
#define REFLUX_STATE_LAW_STATE_LAW_COLUMN_H

#include "kinds/column/column.h"
#include "law/state_law_found.h"

#if CONFIG_BLOCKS

struct state_law_column;

/* input: signals of the block. The record must stay. */
void state_law_column_begin(struct state_law_column *c, const struct state_law_settings *s,
                            const struct block_signal *input, unsigned inputs,
                            const struct column_record *record);
/* Does a piece; false: it is over. */
bool state_law_column_piece(struct state_law_column *c);
bool state_law_column_is_over(const struct state_law_column *c);
const struct state_law_found *state_law_column_found(const struct state_law_column *c);

/* Returns how many of the inputs are MVs. */
unsigned state_law_loops(const struct block_signal *input, unsigned inputs);

#endif
#endif
