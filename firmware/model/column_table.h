/* The compact table of a column: what an estimator on a board needs to know of it, in float values one behind the other
 * (docs/methods/column-table.md; column_table_form.h has the places). One code for board and host, in float. */
#ifndef REFLUX_MODEL_COLUMN_TABLE_H
#define REFLUX_MODEL_COLUMN_TABLE_H

#include <stdint.h>

#include "model/activity.h"
#include "model/column.h"
#include "model/column_table_form.h"

/* As it was pasted. */
struct column_table_text {
    uint16_t version, size; /* values that count */
    uint32_t checksum;
    const float *value; /* [COLUMN_TABLE_MOST], 0 behind the size */
};

/* The table as it was read. It holds pointers into itself and into the values: these must stay, and after it has been moved
 * column_table_moved() is called. */
struct column_table {
    struct column_config config;
    struct column_inputs nominal;
    float heat_loss; /* W, taken off the heat before it is nominal.heat */
    struct component component[COLUMN_TABLE_COMPONENTS];
    char name[COLUMN_TABLE_COMPONENTS][COLUMN_TABLE_NAME_SIZE];
    char title[COLUMN_TABLE_NAME_SIZE];
    struct activity activity;
    /* Steady state at the nominal inputs of the column it was made from, mole fractions as states of a struct column. */
    const float *profile;
    uint32_t truncated[2]; /* see column_table_is_truncated() */
};

/* CRC-32 of version and size, two bytes each, and of the values' bits, all little-endian. */
uint32_t column_table_checksum(uint16_t version, uint16_t size, const float *value);

/* Checks everything and fills *table. ERR_VERSION, ERR_CRC, ERR_RANGE, ERR_NOT_FINITE with *fault (never NULL) saying which
 * field is wrong and what it must be; *table is then of no use. */
MUST_CHECK enum err column_table_read(const struct column_table_text *text,
                                      struct column_table *table, struct column_fault *fault);
void column_table_moved(struct column_table *table);

/* True: an estimator does without the composition of this stage, 1 (the reboiler) and up, as a state. */
bool column_table_is_truncated(const struct column_table *table, size_t stage);
/* Returns the number of states: N (C - 1) less one for each of these stages. */
size_t column_table_states(const struct column_table *table);

/* Returns the number of stages in the two values COLUMN_TABLE_TRUNCATED. */
unsigned column_table_count(const float value[2]);

/* A name from its four values; false: that is none. */
bool column_table_name(const float *value, char name[COLUMN_TABLE_NAME_SIZE]);

#endif
